#pragma once
/// \file
/// The tables of a report in HTML. The script of the page makes them sortable by their headings and
/// downloadable.

#include <string>
#include <vector>

#include "analysis/runs/comparison.hpp"

namespace twincell::analysis {

/// Phases, s_b and s_c of both sides at each drive strength, with the verdict.
std::string verdict_table(const std::vector<Run>& runs, const std::vector<Match>& matches);

/// The runs with all their numbers. After name and side come the columns of the numbers that differ really
/// between the sides, then those that differ between the runs, then those that are the same in all.
std::string runs_table(const Comparison& comparison);

/// The onsets.
std::string boundary_table(const std::vector<PhaseBoundary>& boundaries);

/// The differences, what they are made of and their attribution.
std::string differences_table(const Comparison& comparison);

/// A list of the conventions of each result. Each distinct sentence appears once, with the runs to which it
/// applies.
std::string conventions(const std::vector<Run>& runs);

}  // namespace twincell::analysis
