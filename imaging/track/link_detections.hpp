#pragma once
/// \file
/// From the beads of single frames to tracks: the phase of each frame, and the identity of each bead.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/progress.hpp"
#include "imaging/cell/cell.hpp"
#include "imaging/link/link.hpp"
#include "imaging/phase/phase_lock.hpp"
#include "imaging/track/detection_store.hpp"

namespace twincell {

/// How a stack's phases are learnt. With neither: from the cell's frames per cycle.
struct PhaseWay {
  bool find = false;                              ///< from the bed's own motion (phase_estimation.hpp)
  std::optional<std::filesystem::path> triggers;  ///< from a list (trigger_list.hpp)
  std::optional<double> drive_hz;                 ///< frequency of the drive, for a list in seconds
};

/// What is known of a track when the stack ends.
struct TrackSummary {
  std::int64_t first = 0, last = 0;  ///< frames in which it was seen
  std::int64_t seen = 0;             ///< number of frames
  std::int64_t tracer = 0;           ///< of them, those in which the bead looked like a tracer
  std::int64_t ambiguous = 0;        ///< of its links, those that are
  double radius_px = 0;              ///< mean
  [[nodiscard]] bool is_tracer() const { return 2 * tracer > seen; }
};

/// The beads of a stack with their tracks. They are on disk; in memory are about 50 bytes per track and 24
/// per frame.
struct LinkedDetections {
  DetectionStore frames;  ///< frames[f]: the beads of frame f
  std::vector<TrackSummary> tracks;
  std::int64_t n_tracks = 0;
  PhaseTable phases;
  LinkReport links;

  /// Tracers (by majority) that are not seen from the first frame to the last: their identity was lost, or
  /// they came or went.
  [[nodiscard]] std::vector<std::int64_t> broken_tracers() const;
};

/// Finds the phase of each frame, then links. Frames taken twice are linked without a step.
/// \param cell drive, frames per cycle and scale tell the linker how fast beads fall
/// \param folder where the beads wait on disk, about 64 bytes per bead and frame; empty: the folder for
/// temporary files
LinkedDetections link_detections(const DetectionStore& located, LinkOptions link, const CellDescription& cell,
                                 const PhaseWay& way, const std::filesystem::path& folder,
                                 Progress& progress = Progress::none());

}  // namespace twincell
