#pragma once
/// \file
/// Periods too short for the neighbours of a bed.

#include <string>
#include <vector>

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// A sentence, without its full stop, for each period shorter than twice the reach of a neighbour: beyond
/// half a period a bead has several images, of which only the nearest counts. The reach is the neighbour
/// cutoff and, in a planar cell, the diameter of a Voronoi cell if that is larger.
std::vector<std::string> short_periods(const TrajectoryInfo& info, const AnalysisOptions& options);

}  // namespace twincell::analysis
