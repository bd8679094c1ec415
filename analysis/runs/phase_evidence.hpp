#pragma once
/// \file
/// Which phases the measurement of a run leaves possible.

#include <string>
#include <vector>

#include "analysis/runs/phase_diagram.hpp"

namespace twincell::analysis {

/// The phases that a run may have, in the order of their onsets. Its own phase alone, if the 95 % intervals
/// of s_b and s_c are clear of their thresholds; the phases on both sides of a threshold that an interval
/// contains. A convecting run that has annealed (Drift::annealed) may as well be bouncing. Empty if the phase
/// is undetermined.
std::vector<BedPhase> possible_phases(const Run& run);

/// The same for the runs of one side, which differ by chance: all phases that one of them may have. A
/// threshold separates them all if the sum of their distances from it, in standard errors, exceeds 1.96
/// sqrt(n). Empty without a common phase.
std::vector<BedPhase> possible_phases(const std::vector<Run>& runs, const std::vector<std::size_t>& members);

/// Why a run leaves several phases possible: "s_c = 1.18 [0.79, 1.84], threshold 1"; empty if it does not.
std::string doubt_text(const Run& run);

/// Whether a run shows the phase that begins at an onset.
enum class OnsetEvidence { absent, present, undecided };
OnsetEvidence evidence_of(const Run& run, BedPhase onset);

}  // namespace twincell::analysis
