#pragma once
/// \file
/// twincell cost locate: error and time of the ways of locating.

#include <nlohmann/json.hpp>
#include <string>

#include "analysis/report/figures.hpp"
#include "cli/output.hpp"

namespace twincell::cli {

/// What a cost was found to be, in three ways.
struct CostReport {
  nlohmann::json document;
  std::string text;
  Figure figure;
};

/// \param accuracy_px error per coordinate asked for
CostReport cost_of_locating(double accuracy_px, bool quick, const Common& common);

}  // namespace twincell::cli
