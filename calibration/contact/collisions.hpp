#pragma once
/// \file
/// Collisions of two beads found in a trajectory, with their velocities before and after.

#include <cstddef>
#include <vector>

#include "calibration/contact/walton.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell {

struct CollisionOptions {
  double gravity = 1;        ///< along -z, reduced units
  double least_speed = 0.1;  ///< of approach, sigma/t0
  /// How far the two beads' common momentum may change between the frames, in speeds of approach: more says
  /// that a third body took part.
  double largest_kick = 0.05;
  /// Every how manyth frame is looked at; 0: 1, 2, 4 ... while each finds clearly more. A collision that
  /// lasts longer than half of the time between two frames is not seen between them.
  std::size_t stride = 0;
};

/// What was found.
struct FoundCollisions {
  std::vector<Impact> impacts;
  std::size_t pairs = 0;    ///< that met between two frames
  std::size_t crowded = 0;  ///< of them left out because a third body took part
  bool spins = false;       ///< whether psi_1 and psi_2 are known
  std::size_t stride = 1;   ///< every how manyth frame was looked at
};

/// Two beads that are apart in two frames that follow each other, approach in the first, part in the second,
/// and meet in between on straight lines against each other (gravity is common to both). The normal is that
/// of the meeting, from both sides. Velocities are the file's, or, where it has none, steps between two
/// frames with gravity taken off; spins are the file's or unknown. \throws InputError for fewer than 2 frames
FoundCollisions find_collisions(const TrajectorySource& trajectory, const CollisionOptions& options = {});

}  // namespace twincell
