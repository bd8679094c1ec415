#pragma once
/// \file
/// Drag of the plates in front of and behind a 2D bed.

#include "sim/contact/contact.hpp"

namespace twincell::sim {

/// One component of the drag on a bead, m g: -rate m (v - v_cell), rounded as the force of a contact is
/// (contact.hpp rounded()), so that the sum of a bead's forces does not depend on their order. A velocity
/// below quantum/(rate m) does not decay further. v is the velocity in the middle of the last step: a step
/// leaves 1 - rate dt of it instead of exp(-rate dt), as if the rate were larger by the factor 1 + rate dt/2.
/// \param coefficient rate m, with the rate in 1/t0
inline double plate_drag_force(double coefficient, double v, double v_cell, double quantum) {
  return rounded(-coefficient * (v - v_cell), quantum);
}

}  // namespace twincell::sim
