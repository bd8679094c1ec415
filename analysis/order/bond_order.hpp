#pragma once
/// \file
/// Bond order of the bed: q6, psi6 and psi4 of its beads.

#include "analysis/neighbours/bond_orientational_order.hpp"
#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// Bond order with the neighbour rule of the analysis; definitions in bond_orientational_order.hpp. Results:
///
/// - q6, psi6, psi4: scalars, mean over beads and frames
/// - hexagonal_fraction: scalar, share of the beads with Structure::hexagonal, mean over frames
/// - square_fraction: scalar, share of the beads with Structure::square, mean over frames
/// - q6_beads, psi6_beads, psi4_beads: [n_beads] values of the beads in the last frame
///
/// Absent in a cell that is not planar.
extern const ObservableEntry bond_order_observable;

}  // namespace twincell::analysis
