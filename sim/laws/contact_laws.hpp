#pragma once
/// \file
/// The contact laws that a scene selects for one kind of contact.

#include "sim/laws/axes.hpp"

namespace twincell::sim {

/// The laws of one kind of contact, with their parameters.
struct ContactLaws {
  NormalAxis normal;
  TangentialAxis tangential;
  RollingAxis rolling;
};

/// Whether the rolling law of these contacts exerts a torque, that is, is not NoRolling.
bool resists_rolling(const ContactLaws& laws);

/// Whether these laws are a tangential spring with history, combined with a normal force without memory and
/// without rolling resistance.
bool remembers(const ContactLaws& laws);

/// Whether one isolated collision under these laws can be integrated separately: apart from the Coulomb limit
/// the forces are smooth, and they depend only on the present motion or also on a tangential spring.
bool integrable_alone(const ContactLaws& laws);

}  // namespace twincell::sim
