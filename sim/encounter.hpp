#pragma once
/// \file
/// One isolated collision, of two beads or of a bead and a wall, integrated to round-off: what event-driven
/// flight (flight_kernel.hpp) does between first touch and parting, with the same laws as every kernel.

#include <array>
#include <optional>

#include "sim/plan.hpp"
#include "sim/state.hpp"

namespace twincell::sim {

/// Relative motion of two bodies in contact.
struct RelativeMotion {
  Vec3 r;  ///< from j to i; or from a point of the wall's surface to the bead
  Vec3 u;  ///< v_i - v_j, or against the wall
  Vec3 s;  ///< R_i w_i + R_j w_j; R w at a wall
};

/// What an encounter's course depends on.
struct EncounterSetting {
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

/// How an encounter went.
struct EncounterEnd {
  bool parted = false;  ///< false: still in contact when the time was over
  double time = 0;
  RelativeMotion motion;
  double deepest = 0;  ///< overlap, sigma, at the moments that its steps look at
  /// About half way: where the deepest of its steps ended.
  double middle = 0;
  RelativeMotion at_middle;
  Vec3 xi = Vec3::Zero();  ///< the tangential spring at the end, of laws that remember
};

/// Whether encounters of these laws can be integrated alone: forces that are smooth but for the Coulomb
/// limit, and depend on the present only or on a tangential spring (history_encounter.hpp).
bool can_meet_alone(const ContactLaws& laws);

/// Shortest time in which the contact force changes (t_c, for a linear law).
double encounter_time(const EncounterSetting& setting, double speed);

/// Integrates from `motion` at `time` (in contact, or at first touch) until the surfaces part or `last`.
///
/// Steps of order 15 (collocation.hpp) of at most half a contact time, as long as `tolerance` allows; the
/// polynomial that each one is tells where the Coulomb limit begins or ceases to bind, where F_n changes its
/// sign, and where the surfaces part, and there it ends.
///
/// Laws that remember begin with a spring of length 0: `motion` is that of first touch.
/// \param tolerance of lengths and velocities relative to those of the encounter; 1e-13 .. 1e-3
EncounterEnd meet(const EncounterSetting& setting, const RelativeMotion& motion, double time, double last,
                  double tolerance);

/// Contact force on i now, its turning moment n x F_t, and n.
struct EncounterForce {
  Vec3 force, moment, normal;
};
/// \param xi the tangential spring, of laws that remember
EncounterForce force_of(const EncounterSetting& setting, const RelativeMotion& motion,
                        const Vec3& xi = Vec3::Zero());

}  // namespace twincell::sim
