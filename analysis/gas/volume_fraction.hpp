#pragma once
/// \file
/// Mean volume fraction of a bed with an open top, in two conventions for the undefined upper end of the bed.

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// Mean over frames of the volume of the beads (2D: area of the discs) divided by the volume (2D: area) of
/// the cell from the plate's mean height up to a convention-dependent top. Results:
///
/// - phi_top: up to the top of the highest bead
/// - phi_cm: up to twice the height of the centre of mass
///
/// Bhateja, Sharma & Singh 2016, sec. IV, give "about 0.2 at W_f" without a convention. The interval is from
/// correlated series over frames. A result is absent if no frame contains beads, or if the beads of any frame
/// need more volume than there is below the top (a bed that moves down with the plate).
extern const ObservableEntry volume_fraction_observable;

}  // namespace twincell::analysis
