#pragma once
/// \file
/// Tracks a stack: configure the locator, locate the beads, link them.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.hpp"
#include "core/stage_times.hpp"
#include "imaging/cell/cell.hpp"
#include "imaging/link/link.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/preprocess/region.hpp"
#include "imaging/refine/rim_aspect.hpp"
#include "imaging/stack/chosen_frames.hpp"
#include "imaging/stack/frame_source.hpp"
#include "imaging/track/link_detections.hpp"

namespace twincell::imaging {

/// How the frames of a stack are located and linked.
struct TrackingOptions {
  LocatorOptions locator;  ///< settings left open are found from the first frames (configure_locator.hpp)
  LinkOptions link = {};
  PhaseSource phases = {};
  Region region = {};  ///< part of the picture that is searched
  int threads = 1;
  /// Folder for the beads on disk, about 64 bytes per bead and frame; empty: the folder for temporary files.
  std::filesystem::path folder = {};
};

/// A located and linked stack.
struct TrackedStack : LinkedDetections {
  LocatorOptions locator;  ///< complete options with which the beads were located
  int width_px = 0, height_px = 0;
  std::size_t outside_cell = 0;  ///< detections excluded because they are outside the cell
  std::size_t wrong_radius = 0;  ///< candidates excluded as discs of another size
  std::size_t paler = 0;  ///< candidates in the cell excluded as discs of another darkness (paler_discs.hpp)
  std::size_t rejected = 0;        ///< candidates in the cell that no disc explains, where a bead has room
  FrameRange range = {};           ///< numbers of the frames, which become the steps of the trajectory
  std::string spacing_doubt = {};  ///< of a table: beads overlap or are listed twice, a sentence
  std::vector<std::string> settings_doubts = {};  ///< settings_doubts.hpp, of the settings that were found
  bool has_errors = true;                         ///< the standard errors of the positions are known
  std::optional<Aspect> aspect = {};  ///< height over width of the beads in a dozen frames of the stack
  /// Says that no bead is about one sigma wide (10 %); empty if one is, or the scale is unknown.
  [[nodiscard]] std::string scale_doubt(const CellDescription& cell) const;
  /// A sentence, without a full stop, if more paler discs than a fiftieth of the beads were left out, as
  /// tracers of another darkness may be. Empty otherwise.
  [[nodiscard]] std::string paler_doubt() const;
  /// A sentence, without a full stop, if there is a rejected candidate in every other frame; else empty.
  [[nodiscard]] std::string rejected_doubt() const;
  /// Aspect::doubt of the stack.
  [[nodiscard]] std::string aspect_doubt() const { return aspect ? aspect->doubt() : ""; }
  /// All doubts about the stack, phases, links and sizes, in sentences with their full stop.
  [[nodiscard]] std::vector<std::string> doubts(const CellDescription& cell) const;
};

/// Locates the beads, determines the phases and links. The stack is read once.
/// \param cell origin, scale and size: if all are known, detections more than half a bead outside the walls,
///     or below the plate where the drive is known, are counted and excluded; otherwise all are kept. Drive,
///     frames per cycle and scale give the linker the fall of a bead per frame interval
/// \param options of the region: positions remain those of the whole picture. Discs cut by the mask are left
///     out. The plate is sought in the whole picture
/// \param times receives the times of the stages "reading", "settings", "locating" (located beads) and
///     "linking" (links; with the estimate of the phases); null: not timed
/// \throws InputError if a list of triggers does not have a line for each frame; ConfigError if all
///     detections lie outside the cell, and as check_lock and Region::check
TrackedStack track_stack(FrameSource& frames, const CellDescription& cell, const TrackingOptions& options,
                         Progress& progress = Progress::none(), StageTimes* times = nullptr);

}  // namespace twincell::imaging
