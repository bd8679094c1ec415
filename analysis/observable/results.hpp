#pragma once
/// \file
/// Results as text, JSON and HDF5.

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/observable/observable.hpp"

namespace twincell {
class JsonView;
}

namespace twincell::analysis {

/// Text table: value, interval, unit and count of each scalar, then how each result is computed. For an array
/// the table gives its shape and range.
std::string results_text(const std::vector<Result>& results);

/// Results as the text of one JSON object with one member per result:
///
///     {"NAME": {"value": number | text | array, "shape": […], "unit", "n", "n_of",
///               "interval": {"low", "high", "level", "method"} | "no_interval": reason,
///               "convention", "source"}
///            | {"absent": reason, "source"}}
///
/// NaN becomes null. Pooled scalars (pooling.hpp) also have "runs", the value of each run.
std::string results_json(const std::vector<Result>& results);

/// Inverse of results_json, in alphabetical order of the names. "value" or "absent" is required, with an
/// array also "shape".
/// \throws InputError as JsonView, also for a shape that does not fit the number of values
std::vector<Result> results_from_json(const JsonView& results);

/// Writes an HDF5 file with one group per result below /results, and the text /provenance. A group has the
/// dataset `value` and the members of results_json as attributes, or the attribute `absent`. The file appears
/// only when it is complete.
/// \throws ConfigError, RunError
void write_results(const std::filesystem::path& path, const std::vector<Result>& results,
                   const std::string& provenance_json);

}  // namespace twincell::analysis
