#pragma once
/// \file
/// Discs inside the plate: text that the camera writes into a dark plate, or marks on it.

#include <vector>

#include "imaging/cell/cell.hpp"
#include "imaging/geometry/pixel_frame.hpp"
#include "imaging/track/link_detections.hpp"

namespace twincell::imaging {

/// For each track, whether it lies in the plate: its centre is less than 0.3 radii above the plate, or below
/// it, in nine tenths of its frames. All false if the drive, its phases or the origin are unknown, or if such
/// tracks make more than a twentieth of all beads: then the plate is elsewhere than the cell states.
/// Reads the beads of all frames.
std::vector<char> beneath_plate(const LinkedDetections& linked, const CellDescription& cell,
                                const PixelFrame& pixel_frame);

}  // namespace twincell::imaging
