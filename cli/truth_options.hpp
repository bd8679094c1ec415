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

  [[nodiscard]] imaging::ScoredRows rows() const {
    return scored_rows.size() == 2 ? imaging::ScoredRows{scored_rows[0], scored_rows[1]}
                                   : imaging::ScoredRows{};
  }
};

void add_truth_options(CLI::App& verb, TruthOptions& options);

}  // namespace twincell::cli
