#include "cli/truth_options.hpp"

#include <CLI/CLI.hpp>

namespace twincell::cli {

void add_truth_options(CLI::App& verb, TruthOptions& options) {
  verb.add_option("--truth", options.file,
                  "Score the result against the ground truth: truth.csv, or a folder of truth_NN.csv");
  verb.add_option("--scored-rows", options.scored_rows,
                  "First and last row of pixels that is scored, px; default: all rows")
      ->expected(2);
}

}  // namespace twincell::cli
