#pragma once
/// \file
/// The ground truth against which `locate` and `track` score their beads.

#include <string>
#include <vector>

#include "imaging/benchmark/score.hpp"

namespace CLI {
class App;
}

namespace twincell::cli {

/// Values of --truth and --scored-rows.
struct TruthOptions {
  std::string file;                 ///< truth.csv, or a folder of truth_NN.csv; empty: not scored
  std::vector<double> scored_rows;  ///< first and last, px; empty: all

  /// \throws ConfigError for rows without a truth
  [[nodiscard]] imaging::ScoredRows rows() const;
};

/// Adds --truth and --scored-rows.
void add_truth_options(CLI::App& verb, TruthOptions& options);

}  // namespace twincell::cli
