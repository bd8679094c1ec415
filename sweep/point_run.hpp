#pragma once
/// \file
/// Computes one point of a sweep, from scene to results, in one pass on one core.

#include <filesystem>
#include <string>

#include "core/progress.hpp"
#include "core/stage_times.hpp"
#include "sim/run/make_solver.hpp"
#include "sweep/plan.hpp"

namespace twincell::sweep {

/// Simulates and analyses a point. The result is the text of one JSON object: {"id", "answer": true | false |
/// null, "n_cycles", "stopped": why the run ended before its last cycle, "until": {"reached", "text"} of the
/// scene's [until], "rest_height", "contact_fraction", "failed": error message of a failed run, "results": as
/// results_json of `twincell analyze`, "computed": {"seconds", "processor_seconds" of this thread, "program",
/// "utc", "processor"}}. A run on a graphics card states no processor time. Everything but "computed" is the
/// same wherever and whenever the point is run. A failed run would fail again, so the failure counts as its
/// result.
/// \param trajectory file for the frames; empty: frames are not stored
/// \param times receives the times of "placing" and of the stages of the simulation and the analysis; null:
/// not timed
/// \throws Interrupted
/// \throws Error if the trajectory cannot be written
std::string run_point(const Plan& plan, const Point& point, const std::filesystem::path& trajectory,
                      Progress& progress = Progress::none(), StageTimes* times = nullptr,
                      sim::SolverKind solver = sim::SolverKind::best);

}  // namespace twincell::sweep
