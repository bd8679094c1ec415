#pragma once
/// \file
/// All results of a sweep in one file.

#include <string>

#include "sweep/schedule.hpp"

namespace twincell::sweep {

/// {"format", "plan": its TOML, "seed": master seed, "points": [{"id", "axes": {key: value}, "replica",
/// "seed", and of the result all that does not depend on where and when it was computed}], "open": points
/// that are not done, "onsets": [{"axes", "key", "verdict", "value", "low", "high", "level", "method",
/// "runs", "yes", "text", "complete"}], "pooled": [{"axes", "runs", "results"}]}. `pooled` holds, for the
/// points with two runs or more that differ in nothing but the seed, their scalars and words as
/// analysis/runs/pooling.hpp pools them. The same bytes for the same plan, whichever process computed the
/// points in whatever order.
std::string collected_json(const Schedule& schedule);

/// A line a point: id, axes, replica, seed, answer, then value, low and high of every scalar result; empty
/// where there is none.
std::string collected_csv(const Schedule& schedule);

/// The same for `pooled`: a line for each set of axes; empty if no point has two runs.
std::string pooled_csv(const Schedule& schedule);

/// A line an onset, for a reader; for a grid the number of points.
std::string collected_text(const Schedule& schedule);

}  // namespace twincell::sweep
