#pragma once
/// \file
/// The results of an analysis for people.

#include <string>
#include <vector>

#include "analysis/observable/observable.hpp"

namespace twincell::cli {

/// The phase with its reason, then the main results (NamedResult::main) with their intervals, in at most 100
/// columns.
/// \param requested the results were asked for by name: all of them are rows, lists and absent ones, too;
///   otherwise the others are only counted, and results_text() has them
std::string results_summary(const std::vector<analysis::Result>& results, bool requested);

}  // namespace twincell::cli
