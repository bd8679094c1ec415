#pragma once
/// \file
/// Collected results of a sweep as JSON, CSV or text.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/output_kind.hpp"
#include "sweep/schedule.hpp"

namespace twincell::sweep {

/// A value of an axis for people: 0.4 for 0.40000000000000002, the words without quotes.
/// \param literal the value as TOML
std::string shown_value(const std::string& literal);

/// All results of a sweep as one JSON object:
/// {"format", "plan": TOML of the plan, "seed": master seed, "points": [{"id", "axes": {key: value},
/// "conditions": {"n_l", "gamma", "start"} (conditions.hpp), "replica", "seed", and every part of the result
/// that does not depend on where and when it was computed}], "open": number of points that are not done,
/// "onsets": [{"axes", "conditions": {"n_l", "start"}, "key", "verdict", "value", "low", "high", "level",
/// "method", "range", "runs", "yes", "complete", "text"}], "pooled": [{"axes", "runs", "results"}]}.
///
/// `pooled` contains, for points with two or more runs that differ only in the seed, their scalars and words,
/// pooled by analysis/runs/pooling.hpp. The bytes depend on the plan only, not on which process computed the
/// points or in which order.
std::string collected_json(const Schedule& schedule);

/// CSV with one line per point: id, axes, replica, seed, answer, number of cycles, failure, then value, low
/// and high of every scalar result; empty fields for absent values.
std::string collected_csv(const Schedule& schedule);
/// The kind of file that holds such a text, whatever the axes and results of its plan.
Product collected_csv_file();

/// Names of the results that are not single numbers, such as spectra and tensors, and that collected_csv()
/// therefore leaves out, in alphabetical order.
/// \param collected the parsed text of collected_json()
std::vector<std::string> results_outside_csv(const nlohmann::json& collected);

/// CSV of `pooled`, one line per set of axes; empty if no point has two runs.
std::string pooled_csv(const Schedule& schedule);
/// The kind of file that holds such a text, whatever the axes and results of its plan.
Product pooled_csv_file();

/// Summary for a reader: the number of points, then one line per onset, or, for a grid, a table of at most 24
/// rows with the phase and the first two results at each set of axes (of several runs the extremes).
std::string collected_text(const Schedule& schedule);

}  // namespace twincell::sweep
