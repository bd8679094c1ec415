#pragma once
/// \file
/// Mean volume fraction of an open bed, in two conventions, for where it ends is not defined.

#include <memory>

#include "analysis/observable/observable.hpp"

namespace twincell {

/// Results phi_top and phi_cm, mean over frames of the volume of the beads (2D: area of discs) over that of
/// the cell from the plate's mean height up to
///   phi_top  the top of the highest bead
///   phi_cm   twice the height of the centre of mass
/// Bhateja, Sharma & Singh 2016, sec. IV, name "about 0.2 at W_f" and no convention. Whole cycles carry an
/// interval; absent without beads, or where a frame has more beads than room below
/// that height: a bed that sinks with the plate.
std::unique_ptr<Observable> make_volume_fraction(const AnalysisContext& context);

}  // namespace twincell
