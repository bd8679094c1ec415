#pragma once
/// \file
/// One isolated collision, of two beads or of a bead and a wall: what it depends on and how it ends.

#include <optional>

#include "sim/laws/contact_laws.hpp"
#include "sim/system/system.hpp"

namespace twincell::sim {

/// Relative motion of two bodies in contact.
struct RelativeMotion {
  Vec3 r;  ///< from j to i; or from a point of the wall's surface to the bead
  Vec3 u;  ///< v_i - v_j, or against the wall
  Vec3 s;  ///< R_i w_i + R_j w_j; R w at a wall
};

/// What an collision's course depends on.
struct CollisionSetting {
  int dimension = 2;
  const ContactLaws* laws = nullptr;
  PairScale pair{};
  double reach = 1;  ///< R_i + R_j, or R
  double turn = 0;   ///< R_i^2/I_i + R_j^2/I_j
  /// A wall's inward normal; none between beads, whose normal turns as they go round each other.
  std::optional<Vec3> wall;
  /// What acts on the relative motion besides the contact, at a wall: gravity, and the wall's own
  /// acceleration -A omega^2 sin(omega t) taken the other way.
  Vec3 pull = Vec3::Zero(), swing = Vec3::Zero();  ///< pull + swing sin(omega t)
  double omega = 0;
};

/// How an collision went.
struct CollisionEnd {
  bool parted = false;  ///< false: still in contact when the time was over
  double time = 0;
  RelativeMotion motion;
  double deepest = 0;  ///< overlap, sigma, at the moments that its steps look at
  /// About half way: where the deepest of its steps ended.
  double middle = 0;
  RelativeMotion at_middle;
  Vec3 xi = Vec3::Zero();  ///< the tangential spring at the end, of laws that remember
};

/// Shortest time in which the contact force changes (t_c, for a linear law).
double collision_time(const CollisionSetting& setting, double speed);

/// Contact force on i now, its turning moment n x F_t, and n.
struct CollisionForce {
  Vec3 force, moment, normal;
};
}  // namespace twincell::sim
