#pragma once
/// \file
/// Results as text, JSON and HDF5.

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/observable/observable.hpp"

namespace twincell {

/// A table for a reader: value, interval, unit, count of each scalar, then how each was made. Arrays are
/// named with their range.
std::string results_text(const std::vector<Result>& results);

/// {"NAME": {"value": number | text | array, "shape": […], "unit", "n", "n_of", "interval": {"low", "high",
/// "level", "method"} | "no_interval": reason, "convention", "source"} | {"absent": reason, "source"}}. NaN
/// becomes null. Pooled scalars (pooling.hpp) have "runs" as well, the value of each run. Text of one JSON
/// object.
std::string results_json(const std::vector<Result>& results);

/// What results_json wrote, in the order of names. \pre `text` is such
std::vector<Result> results_from_json(const std::string& text);

/// One group per result below /results: dataset `value` with the attributes of results_json, or attribute
/// `absent`; text /provenance. Whole or not at all. \throws ConfigError, RunError
void write_results(const std::filesystem::path& path, const std::vector<Result>& results,
                   const std::string& provenance_json);

}  // namespace twincell
