#pragma once
/// \file
/// Trajectories of both sides become a comparison: analysed, matched, filmed, and with frames to look at.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/runs/comparison.hpp"
#include "imaging/camera/options.hpp"

namespace twincell {

struct ComparingOptions {
  std::vector<std::filesystem::path> experiments, simulations;
  /// Frames of the experiments, in their order; empty: where their provenance says, if they are there still.
  std::vector<std::filesystem::path> stacks;
  std::vector<std::filesystem::path> sweeps;  ///< collected results of sweeps
  AnalysisOptions analysis;
  double tolerance = 0.02;  ///< of Gamma, as in match_runs
  bool film = true;         ///< one simulation of each match with both sides goes through camera and tracker
  /// The camera of the film; absent: the defaults at the scale of the match's experiment, with the noise of
  /// its frames where these are there still.
  std::optional<CameraOptions> camera;
  std::filesystem::path scratch = {};  ///< where the film waits; empty: the folder for temporary files
  int threads = 1;
};

/// Makes the progress of one stage, named for the user.
using ProgressOf = std::function<std::unique_ptr<Progress>(const std::string& stage)>;

/// Every run analysed and placed; boundaries; differences with what they come from. At most 20 moments of
/// each run are kept to be looked at, fewer where many runs or beads would make a page of more than some 20
/// MB. \param notes sentences for the user: frames that are not there any more, simulations that could not be
/// filmed \throws InputError, ConfigError, RunError as analyze_run
Comparison compare_runs(const ComparingOptions& options, const ProgressOf& progress,
                        std::vector<std::string>& notes);

}  // namespace twincell
