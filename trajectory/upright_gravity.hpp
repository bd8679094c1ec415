#pragma once
/// \file
/// The part of gravity that pulls a bed onto its plate.

#include "trajectory/trajectory.hpp"

namespace twincell {

/// -g_z/|g| of the run, between -1 and 1: cos(cell.tilt), or that of the vector cell.gravity of the scene in
/// the provenance (`config`). 1, gravity along -z, if no scene is stated, and without gravity. Drive::gravity
/// times this share is the acceleration onto the plate; Gamma, K_m and the unit of time refer to |g|.
double upright_share_of_gravity(const TrajectoryInfo& info);

}  // namespace twincell
