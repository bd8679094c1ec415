#include "analysis/runs/match_verdict.hpp"

#include <algorithm>

#include "analysis/runs/phase_evidence.hpp"

namespace twincell::analysis {

MatchVerdict verdict(const std::vector<Run>& runs, const Match& match) {
  if (match.simulations.empty()) return MatchVerdict::only_experiment;
  if (match.experiments.empty()) return MatchVerdict::only_simulation;
  const std::vector<BedPhase> experiment = possible_phases(runs, match.experiments),
                              simulation = possible_phases(runs, match.simulations);
  if (experiment.empty() || simulation.empty()) return MatchVerdict::undetermined;
  const bool common = std::any_of(experiment.begin(), experiment.end(), [&](BedPhase phase) {
    return std::find(simulation.begin(), simulation.end(), phase) != simulation.end();
  });
  if (!common) return MatchVerdict::differ;
  return experiment.size() == 1 && simulation.size() == 1 ? MatchVerdict::same : MatchVerdict::undecided;
}

std::string verdict_word(const std::vector<Run>& runs, const Match& match) {
  return std::string(row_of(kMatchVerdicts, verdict(runs, match)).word);
}

}  // namespace twincell::analysis
