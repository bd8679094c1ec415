#pragma once
/// \file
/// Comparison of experiments with simulations: analysis, matching, virtual experiment, and frames for the
/// report.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/runs/comparison.hpp"
#include "imaging/camera/options.hpp"

namespace twincell::twin {

/// Options of compare_runs.
struct ComparingOptions {
  std::vector<std::filesystem::path> experiments, simulations;
  /// Frame stacks of the experiments, in their order; empty: the stacks that the provenance names, if they
  /// still exist.
  std::vector<std::filesystem::path> stacks;
  std::vector<std::filesystem::path> sweeps;  ///< collected results of sweeps
  analysis::AnalysisOptions analysis;
  double tolerance = 0.02;  ///< of Gamma, as in match_runs
  bool film = true;         ///< run a virtual experiment for one simulation of each match
  /// Camera of the virtual experiment; absent: the defaults at the scale of the experiment, with the noise of
  /// its frames if they still exist.
  std::optional<imaging::CameraOptions> camera;
  std::filesystem::path scratch = {};  ///< folder of the film; empty: the folder for temporary files
  int threads = 1;
};

/// Analyses every run, places it in the phase diagram, finds phase boundaries, and traces the differences
/// between the sides to their sources. Each run keeps at most 20 snapshots for the report, fewer if many runs
/// or beads would make the page larger than about 20 MB.
/// The notes name frames that no longer exist, simulations that could not be filmed, and pairs of runs that
/// are compared although their drives differ.
/// \throws InputError, ConfigError, RunError as analyze_run
analysis::Comparison compare_runs(const ComparingOptions& options, const ProgressOf& progress);

}  // namespace twincell::twin
