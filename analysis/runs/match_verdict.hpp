#pragma once
/// \file
/// Verdict on the phases of both sides at one drive strength.

#include <array>
#include <string>
#include <vector>

#include "analysis/runs/phase_diagram.hpp"
#include "core/choice.hpp"

namespace twincell::analysis {

/// Verdict on the phases of a match.
enum class MatchVerdict { same, differ, only_experiment, only_simulation, undecided, undetermined };
/// All verdicts with their words.
inline constexpr std::array kMatchVerdicts = {
    Choice<MatchVerdict>{MatchVerdict::same, "same", "experiment and simulation have the same phase"},
    Choice<MatchVerdict>{MatchVerdict::differ, "differ", "experiment and simulation have different phases"},
    Choice<MatchVerdict>{MatchVerdict::only_experiment, "only experiment", "no simulation has this Gamma"},
    Choice<MatchVerdict>{MatchVerdict::only_simulation, "only simulation", "no experiment has this Gamma"},
    Choice<MatchVerdict>{MatchVerdict::undecided, "undecided",
                         "an interval contains the threshold of a phase, or a bed has annealed"},
    Choice<MatchVerdict>{MatchVerdict::undetermined, "undetermined",
                         "the runs of one side disagree or have no phase"}};
/// Compares the phases that the experiments of a match may have (phase_evidence.hpp) with those that its
/// simulations may have; a side without runs is named instead.
/// \param runs the runs to which the indices of the match refer
MatchVerdict verdict(const std::vector<Run>& runs, const Match& match);
/// The word of the verdict on a match.
std::string verdict_word(const std::vector<Run>& runs, const Match& match);

}  // namespace twincell::analysis
