#pragma once
/// \file
/// One isolated collision of two beads, or of a bead and a wall: its initial data and its result.

#include <optional>

#include "sim/laws/parameters.hpp"
#include "sim/system/system.hpp"

namespace twincell::sim {

struct ContactLaws;

/// Relative motion of two bodies in contact.
struct RelativeMotion {
  Vec3 r;  ///< from j to i; at a wall, from a point of its surface to the bead
  Vec3 u;  ///< v_i - v_j; at a wall, relative to the wall
  Vec3 s;  ///< R_i w_i + R_j w_j; at a wall, R w
};

/// Bodies, laws and external accelerations of a collision.
struct CollisionSetting {
  int dimension = 2;
  const ContactLaws* laws = nullptr;  ///< laws/contact_laws.hpp
  PairScale pair{};
  double reach = 1;  ///< R_i + R_j; at a wall, R
  double turn = 0;   ///< R_i^2/I_i + R_j^2/I_j; at a wall, R^2/I
  /// Inward normal of the wall. Empty for two beads, whose normal rotates during the contact.
  std::optional<Vec3> wall;
  /// At a wall, accelerations of the relative motion other than that of the contact: gravity, and minus the
  /// acceleration -A omega^2 sin(omega t) of the wall.
  Vec3 pull = Vec3::Zero(), swing = Vec3::Zero();  ///< pull + swing sin(omega t)
  double omega = 0;
};

/// Result of a collision.
struct CollisionEnd {
  bool parted = false;  ///< false: still in contact at the end of the interval
  double time = 0;
  RelativeMotion motion;
  double deepest = 0;  ///< largest overlap at any evaluated instant, sigma
  /// Time, at about half the contact, at which the deepest of the steps ends.
  double middle = 0;
  RelativeMotion at_middle;
  Vec3 xi = Vec3::Zero();  ///< the tangential spring at the end, for laws with history
};

/// Shortest time scale of the contact force, t0 (t_c for a linear law).
/// \param speed of the impact, sqrt(g sigma)
double collision_time(const CollisionSetting& setting, double speed);

/// Contact force on i, n x F_t (which gives the torque), and n.
struct CollisionForce {
  Vec3 force, moment, normal;
};
}  // namespace twincell::sim
