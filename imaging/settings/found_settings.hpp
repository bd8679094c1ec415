#pragma once
/// \file
/// The settings that a frame asks for.

#include <string>
#include <vector>

namespace twincell {

/// What was found.
struct FoundSettings {
  double diameter_px = 0;
  bool bright = false;                     ///< beads are brighter than what lies behind them
  double explained = 0;                    ///< sum of -R^2 ln(1 - score), px^2
  std::vector<double> other_diameters_px;  ///< of discs of further sizes
  std::string method;                      ///< RefineOptions::method is to be that; empty: as it was
  double contrast = 1;                     ///< PreprocessOptions::contrast of plain discs
};

}  // namespace twincell
