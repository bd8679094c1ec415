#pragma once
/// \file
/// Binary collisions in a trajectory, with the velocities before and after.

#include <cstddef>
#include <optional>
#include <vector>

#include "calibration/contact/walton.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::calibration {

/// Options of find_collisions.
struct CollisionOptions {
  std::optional<double> gravity;  ///< along -z, reduced units; default: that of the trajectory
  double least_speed = 0.1;       ///< smallest approach speed, sigma/t0
  /// Largest change of the pair's centre-of-mass velocity between the frames, beyond gravity, as a fraction
  /// of the approach speed. A larger change means that a third body took part.
  double largest_kick = 0.05;
  /// Uses every stride-th frame. 0: tries 1, 2, 4 ... while 16 frames or more remain and each finds more than
  /// 1.25 times the collisions of the one before. A collision that lasts longer than half of the time between
  /// two frames is not detected between them.
  std::size_t stride = 0;
};

/// Collisions that were found.
struct FoundCollisions {
  std::vector<Impact> impacts;
  std::size_t pairs = 0;    ///< pairs that met between two frames at least_speed or faster
  std::size_t crowded = 0;  ///< pairs left out because a third body took part
  bool spins = false;       ///< whether psi_1 and psi_2 are known
  std::size_t stride = 1;   ///< every stride-th frame was used
};

/// Finds pairs of beads that do not touch in either of two consecutive frames, approach each other in the
/// first, move apart in the second, and meet in between on straight relative paths (gravity is common to both
/// beads). Positions and velocities are those in the plane x, z; pairs across a periodic boundary are
/// skipped. The collision normal is the mean of the normals extrapolated from both frames. Velocities come
/// from the file or, if it has none, from differences between two frames, corrected for gravity. Spins come
/// from the file or are unknown.
///
/// \throws InputError for fewer than 2 used frames, or fewer than 4 if the file has no velocities
FoundCollisions find_collisions(const TrajectorySource& trajectory, const CollisionOptions& options = {});

}  // namespace twincell::calibration
