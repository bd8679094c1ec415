#pragma once
/// \file
/// Notes on a trajectory that the verbs print which analyse one.

#include "cli/output.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::cli {

/// Notes what is doubtful in the first frames of a trajectory (doubts_of).
void note_trajectory(const Common& common, const TrajectorySource& trajectory);

}  // namespace twincell::cli
