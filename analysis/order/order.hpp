#pragma once
/// \file
/// How ordered a bed is: q6, psi6 and psi4 of its beads.

#include <memory>

#include "analysis/neighbours/bond_order.hpp"
#include "analysis/observable/observable.hpp"

namespace twincell {

/// Results q6, psi6, psi4 (means over beads and frames), hexagonal_fraction, square_fraction, and q6_beads,
/// psi6_beads, psi4_beads of the last frame (bond_order.hpp), by the neighbour rule of the analysis.
std::unique_ptr<Observable> make_bond_order(const AnalysisContext& context);

}  // namespace twincell
