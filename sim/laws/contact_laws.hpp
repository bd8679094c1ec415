#pragma once
/// \file
/// The laws that a scene chose for one kind of contact.

#include "sim/laws/axes.hpp"

namespace twincell::sim {

/// The laws of one kind of contact, with their parameters.
struct ContactLaws {
  NormalAxis normal;
  TangentialAxis tangential;
  RollingAxis rolling;
};

/// Whether these laws are a tangential spring with history, next to a normal force without memory and no
/// resistance to rolling.
bool remembers(const ContactLaws& laws);

/// Whether one isolated collision under these laws can be integrated by itself: the forces are smooth but for
/// the Coulomb limit, and depend on the present only or on a tangential spring.
bool integrable_alone(const ContactLaws& laws);

}  // namespace twincell::sim
