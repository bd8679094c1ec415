#include "cli/truth_options.hpp"

#include <CLI/CLI.hpp>

#include "cli/output.hpp"
#include "core/error.hpp"

namespace twincell::cli {

imaging::ScoredRows TruthOptions::rows() const {
  if (scored_rows.size() != 2) return {};
  if (file.empty())
    throw ConfigError({.file = {}, .key = "--scored-rows"}, "applies to --truth, which is not given.");
  return {scored_rows[0], scored_rows[1]};
}

void add_truth_options(CLI::App& verb, TruthOptions& options) {
  const OptionHeading heading(verb, "Comparison with a known truth");
  verb.add_option("--truth", options.file,
                  "Score the result against the ground truth: truth.csv, or a folder of truth_NN.csv");
  verb.add_option("--scored-rows", options.scored_rows,
                  "First and last row of pixels that is scored, px; default: all rows")
      ->expected(2)
      ->delimiter(',');
}

}  // namespace twincell::cli
