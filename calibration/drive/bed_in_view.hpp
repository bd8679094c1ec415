#pragma once
/// \file
/// Side walls and plate of a cell whose edges do not show in the picture, from the beads that touch them.
/// Lengths in px.

#include <optional>
#include <vector>

#include "calibration/camera/size_statistics.hpp"
#include "imaging/phase/phase_lock.hpp"

namespace twincell::calibration {

/// Column of the wall at one side of the bed, if there is one: where the outermost rims of the beads pile up.
/// The rims of a heap without a wall, or of a bed that the picture cuts, do not.
///
/// Rims within 0.03 diameters of the place count as touching. There must be 1.5 of them per frame, and twice
/// as many as between 0.05 and 0.15 diameters inside. The error contains the scatter over the touching beads
/// of one frame, 0.003 diameters because beads need not touch, what the rims within 0.1 diameters trail
/// inwards (the distance of their median from the tenth inside less that from the tenth outside), and the
/// difference of the median radius from half the diameter.
///
/// \param diameter of a bead: the distance of touching ones
std::optional<Estimate> wall_of_bed(const BeadFrames& beads, double diameter, bool right);

/// Motion of the plate as the bed shows it. Heights count upwards.
struct PlateOfBed {
  imaging::PhaseTable phases;
  Estimate row;  ///< mean height of the plate as a row of the picture
  Estimate amplitude;
  std::vector<double> heights;  ///< [frames] of the bed's lower side about the plate's mean height
};

/// Period, phases, mean height and amplitude of the plate, from a bed that rests on it in a part of each
/// cycle. The phases are those of estimate_phases() for the mean height of the beads. At the phases at which
/// a bed without rebound rests on a plate of this strength (time_at_rest()), the lower side of the bed is
/// fitted by z_0 + a sin th + c cos th. The lower side is the median over columns one diameter wide of the
/// lowest rim.
/// \param gamma A omega^2/g of the drive
/// \throws InputError if the bed has no period, frames are missing or doubled, the bed flies for longer than
/// a cycle, or its lower side does not move as a plate with these phases (c beyond a fifth of a)
PlateOfBed plate_of_bed(const BeadFrames& beads, double diameter, double gamma);

}  // namespace twincell::calibration
