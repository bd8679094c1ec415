#pragma once
/// \file
/// Complete comparison of experiment and simulation: the input of a report.

#include <string>
#include <vector>

#include "analysis/runs/differences.hpp"
#include "analysis/runs/phase_boundaries.hpp"
#include "analysis/runs/phase_diagram.hpp"

namespace twincell::analysis {

/// A point of a sweep, analysed elsewhere; its frames are not kept.
struct SweepPoint {
  double n_l = 0;  ///< N_l sigma
  double gamma = 0;
  std::string start;
  BedPhase phase = BedPhase::undetermined;
};

/// Runs of both sides with everything derived from them.
struct Comparison {
  std::vector<Run> runs;
  std::vector<Match> matches;
  std::vector<PhaseBoundary> boundaries;  ///< of the runs and of the sweep
  std::vector<Difference> differences;
  Checks checks;
  std::vector<SweepPoint> sweep;
  std::vector<std::string> notes;  ///< what the user should know about the runs, sentences
};

}  // namespace twincell::analysis
