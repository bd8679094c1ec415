#pragma once
/// \file
/// From the beads of single frames to tracks: the phase of each frame, and the identity of each bead.

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.hpp"
#include "imaging/cell/cell.hpp"
#include "imaging/link/link.hpp"
#include "imaging/phase/camera_jump.hpp"
#include "imaging/phase/lock_check.hpp"
#include "imaging/phase/phase_lock.hpp"
#include "imaging/track/detection_store.hpp"

namespace twincell::imaging {

/// Source of a stack's phases, with the arguments of a list of triggers (trigger_list.hpp).
struct PhaseSource {
  PhaseMethod method = PhaseMethod::fixed;  ///< fixed: the cell's frames per cycle, if it states them
  std::filesystem::path triggers = {};      ///< the list
  std::optional<double> drive_hz = {};      ///< frequency of the drive, for a list in seconds
  bool trusted = false;                     ///< a stated number of frames per cycle is not checked
};

/// Summary of a track at the end of the stack.
struct TrackSummary {
  std::int64_t first = 0, last = 0;  ///< frames in which it was seen
  std::int64_t seen = 0;             ///< number of frames
  std::int64_t tracer = 0;           ///< of them, those in which the bead looked like a tracer
  std::int64_t ambiguous = 0;        ///< of its links, those that are ambiguous
  double radius_px = 0;              ///< mean radius
  double x_px = 0, y_px = 0;         ///< mean position
  double squares_px2 = 0;            ///< sum of the squared distances from it
  /// Root mean square distance from the mean position, px.
  [[nodiscard]] double scatter_px() const {
    return seen > 0 ? std::sqrt(squares_px2 / static_cast<double>(seen)) : 0;
  }
  [[nodiscard]] bool is_tracer() const { return 2 * tracer > seen; }
};

/// The beads of a stack with their tracks. The beads are on disk; memory is about 50 bytes per track and 24
/// per frame.
struct LinkedDetections {
  DetectionStore frames;  ///< frames[f]: the beads of frame f
  std::vector<TrackSummary> tracks;
  std::int64_t n_tracks = 0;
  PhaseTable phases;
  LinkReport links;
  std::vector<CameraJump> camera_jumps;  ///< of a bumped camera or cell

  /// Tracks of tracers (by majority of frames) that do not span the first frame to the last: the tracer's
  /// identity was lost, or the tracer entered or left.
  [[nodiscard]] std::vector<std::int64_t> broken_tracers() const;
  /// A sentence, without a full stop, if some frame holds less than 0.95 of the beads of another: beads leave
  /// the picture, or are not found in every frame. Frames without beads do not count. Empty otherwise.
  [[nodiscard]] std::string missing_beads() const;
  /// A sentence, without a full stop, that names frames without beads in a film with beads, as black frames
  /// are. Empty if there are none.
  [[nodiscard]] std::string empty_frames() const;
  /// A sentence, without a full stop, that names the frames from which all is shifted. Empty if there are
  /// none.
  [[nodiscard]] std::string camera_moved() const;
  /// A sentence, without a full stop, if there are more than 1.2 times as many tracks as beads in any frame.
  /// Empty otherwise.
  [[nodiscard]] std::string surplus_tracks() const;
  /// A sentence, without a full stop, that names discs that stand still in a moving bed, as bubbles, dirt and
  /// letters do: seen in at least 20 frames and half of all, within 0.01 diameters (rms) of their mean
  /// positions, while the median bead moves by more than 0.1 (a sine of 0.28 from its lowest to its highest
  /// point). Empty if there are none, or if more than a tenth of all stand still.
  [[nodiscard]] std::string still_discs() const;
};

/// Determines the phase of each frame, then links. A frame taken twice is linked with interval 0. A stated
/// number of frames per cycle is checked (lock_check.hpp): by plate and time stamps before linking, otherwise
/// by the bed's motion after it; if frames are missing, the beads are linked anew with the corrected phases.
/// \param cell drive, frames per cycle and scale give the linker the fall of a bead per frame interval
/// \param folder folder for the beads on disk, about 64 bytes per bead and frame; empty: the folder for
///     temporary files
/// \param evidence plate and time stamps of the frames, for a stated number of frames per cycle
/// \throws InputError if a list of triggers does not have a line for each frame; ConfigError as check_lock
LinkedDetections link_detections(const DetectionStore& located, LinkOptions link, const CellDescription& cell,
                                 const PhaseSource& source, const std::filesystem::path& folder,
                                 Progress& progress = Progress::none(), const LockEvidence& evidence = {});

}  // namespace twincell::imaging
