#pragma once
/// \file
/// twincell cost calibration: errors of the calibrated quantities against number of frames and time.

#include "cli/cost_locate.hpp"

namespace twincell::cli {

/// \param quick uses fewer frames
CostReport cost_of_calibrating(bool quick, const Common& common);

}  // namespace twincell::cli
