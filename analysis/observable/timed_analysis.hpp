#pragma once
/// \file
/// The analysis of observable.hpp with the time of each observable.

#include <vector>

#include "analysis/observable/observable.hpp"
#include "core/stage_times.hpp"

namespace twincell::analysis {

/// As `analyze` of observable.hpp, with the same results.
/// \param times receives the times of "reading" and of each observable, in bead-frames, under its name in
/// observables.cpp. Neighbours, bond order and Voronoi cells of a frame are found by the first observable
/// that needs them and belong to its time. Null: not timed
std::vector<Result> analyze(const TrajectorySource& trajectory, const AnalysisOptions& options,
                            Progress& progress, StageTimes* times);

}  // namespace twincell::analysis
