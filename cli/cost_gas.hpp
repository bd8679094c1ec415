#pragma once
/// \file
/// twincell cost gas: error and time of the granular temperature of a dilute gas.

#include "cli/cost_locate.hpp"

namespace twincell::cli {

/// \param accuracy requested relative error of T_z
CostReport cost_of_gas(double accuracy, bool quick, const Common& common);

}  // namespace twincell::cli
