#pragma once
/// \file
/// The tables of a report as CSV.

#include <string>
#include <vector>

#include "analysis/runs/comparison.hpp"

namespace twincell::analysis {

/// Names of the results that are single numbers in any of the runs, in the order of the observables.
std::vector<std::string> scalar_names(const std::vector<Run>& runs);

/// The value of a result that is a single number; NaN for none.
double value_of(const Result* result);

/// One line per run: what it is, then each number with its interval. An empty field is an absent value.
std::string runs_csv(const std::vector<Run>& runs);

/// One line per match and number; an empty field is a value that was not determined.
std::string differences_csv(const Comparison& comparison);

/// A series in long form: one line per run and element.
/// \param name of the result
/// \param index head of the column with the number of the element, which counts from 0
std::string series_csv(const std::vector<Run>& runs, const std::string& name, const std::string& index);

}  // namespace twincell::analysis
