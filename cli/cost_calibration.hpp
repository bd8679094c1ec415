#pragma once
/// \file
/// twincell cost calibration: errors of calibrated numbers against frames used and time.

#include "cli/cost_locate.hpp"

namespace twincell::cli {

/// \param quick fewer frames
CostReport cost_of_calibrating(bool quick, const Common& common);

}  // namespace twincell::cli
