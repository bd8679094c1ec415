#pragma once
/// \file
/// One point of a sweep from its scene to its results, in one pass and on one core.

#include <filesystem>
#include <string>

#include "core/progress.hpp"
#include "sweep/plan.hpp"

namespace twincell::sweep {

/// Simulates and analyses a point; what it keeps are the results alone. Text of one JSON object:
/// {"id", "answer": true | false | null, "n_cycles", "stopped": why the run ended before its last cycle,
/// "until": {"reached", "text"} of the scene's [until], "rest_height", "contact_fraction", "failed": why it
/// went wrong, "results": as results_json of `twincell analyze`, "computed": {"seconds",
/// "program", "date"}}. All but "computed" is the same wherever and whenever the point is run. A run that
/// goes wrong would go wrong again: that is its result. \param trajectory where to keep the frames too;
/// empty: not kept \throws Interrupted; Error if the trajectory cannot be written
std::string run_point(const Plan& plan, const Point& point, const std::filesystem::path& trajectory,
                      Progress& progress = Progress::none());

}  // namespace twincell::sweep
