#pragma once
/// \file
/// Stack -> tracks: configure, locate, link.

#include <cstdint>
#include <filesystem>

#include "core/progress.hpp"
#include "imaging/cell/cell.hpp"
#include "imaging/link/link.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/stack/frame_source.hpp"
#include "imaging/track/link_detections.hpp"

namespace twincell {

/// A stack located and linked.
struct TrackedStack : LinkedDetections {
  LocatorOptions locator;  ///< by which the beads were located
  int width_px = 0, height_px = 0;
  std::size_t outside_cell = 0;  ///< detections left out because the cell does not reach there
  std::size_t wrong_radius = 0;  ///< candidates left out as discs of another size
};

/// Locates, finds phases, links; the stack is read once.
/// \param locator what it leaves open is found from the first frames (configure_locator.hpp)
/// \param cell detections more than half a bead outside its walls are counted and left out, which needs
///     origin, scale and size, otherwise all stay; drive, frames per cycle and scale tell the linker how fast
///     beads fall
/// \param folder where the beads wait on disk, about 64 bytes per bead and frame; empty: the folder for
/// temporary files
/// \throws InputError if a list of triggers does not have a line for each frame
TrackedStack track_stack(FrameSource& frames, const LocatorOptions& locator, LinkOptions link,
                         const CellDescription& cell, int threads, Progress& progress = Progress::none(),
                         const PhaseWay& way = {}, const std::filesystem::path& folder = {});

}  // namespace twincell
