#pragma once
/// \file
/// twincell cost locate: accuracy and time of the locating methods.

#include <nlohmann/json.hpp>
#include <string>

#include "analysis/report/figure.hpp"
#include "cli/output.hpp"

namespace twincell::cli {

/// The result of a cost measurement, as JSON, as text and as a figure.
struct CostReport {
  nlohmann::json document;
  std::string text;
  analysis::Figure figure;
};

/// Measures accuracy and time of the locating methods on rendered pictures.
/// \param accuracy_px requested rms error per coordinate, px, > 0
/// \param quick fewer pictures, for a test
CostReport cost_of_locating(double accuracy_px, bool quick, const Common& common);

}  // namespace twincell::cli
