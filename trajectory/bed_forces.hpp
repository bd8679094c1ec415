#pragma once
/// \file
/// Forces on the walls and stress of a bed at one instant. The simulation averages them over time, the
/// analysis over frames.

#include "trajectory/bed_window.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell {

/// The window of the bed to whose content the stress of a frame refers, with a margin of half a bead
/// diameter; content 0 without beads.
BedWindow stress_window(const Frame& frame, const Box& box);

/// Forces of a frame with its contact forces, positions and velocities:
///
///     stress_ab = 1/V sum over contacts of f_a l_b             (virial, Love & Weber)
///     kinetic_ab = 1/V sum over beads of m v'_a v'_b
///
/// f is the force on bead i, l the branch vector (branch_vector.hpp), v' relative to the velocity of the
/// centre of mass, V the content of stress_window(). `kinetic` is NaN without velocities. A frame without
/// contact forces has the zero forces of a bed without contacts. Unknown if V = 0.
BedForces bed_forces(const Frame& frame, const TrajectoryInfo& info);

}  // namespace twincell
