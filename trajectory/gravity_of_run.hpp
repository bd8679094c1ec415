#pragma once
/// \file
/// The gravity of a run in reduced units, which the drive of a trajectory does not know.

#include "trajectory/trajectory.hpp"

namespace twincell {

/// g of the run in units of the trajectory's g: A omega^2/Gamma, with the Gamma of the run's conditions. 1 if
/// the trajectory states no Gamma.
inline double gravity_of(const TrajectoryInfo& info) {
  const double peak = info.drive ? info.drive->gamma() : 0;
  return info.conditions.gamma.value_or(0) > 0 && peak > 0 ? peak / *info.conditions.gamma : 1;
}

}  // namespace twincell
