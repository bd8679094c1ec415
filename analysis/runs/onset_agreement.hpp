#pragma once
/// \file
/// Agreement of the phase boundaries of experiment and simulation, in sentences.

#include <string>
#include <vector>

#include "analysis/runs/phase_boundaries.hpp"

namespace twincell::analysis {

/// Agreement of two onsets. The interval of an onset reaches from the strongest drive without the phase to
/// the weakest drive with it; without one of them it is open.
enum class OnsetAgreement {
  unknown,     ///< one of the onsets has no interval
  compatible,  ///< the intervals have a common point
  different,   ///< they have none
};
/// Agreement of two onsets of one phase.
OnsetAgreement agreement_of(const PhaseBoundary& a, const PhaseBoundary& b);

/// One sentence for each onset that experiment and simulation (or, without one, a sweep) both have at one N_l
/// (within 10 %), with both intervals and their agreement; equal sentences of several N_l are one. N_l is
/// named if the experiments have more than one. Empty if no onset has both sides.
std::vector<std::string> onset_sentences(const std::vector<PhaseBoundary>& boundaries);

}  // namespace twincell::analysis
