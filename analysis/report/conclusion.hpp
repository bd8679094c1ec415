#pragma once
/// \file
/// The conclusion of a comparison in sentences.

#include <cstddef>
#include <string>
#include <vector>

#include "analysis/runs/comparison.hpp"

namespace twincell::analysis {

/// The phases of some runs: the common one, or each in the order of the runs, "bouncing / convecting"; "no
/// run" without runs.
/// \param members indices of the runs
std::string phases_of(const std::vector<Run>& runs, const std::vector<std::size_t>& members);

/// Where the sides agree and where they differ, the onsets, and how many numbers differ really; of a sweep
/// without runs, its points and onsets.
std::vector<std::string> conclusion_sentences(const Comparison& comparison);

}  // namespace twincell::analysis
