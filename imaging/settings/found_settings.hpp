#pragma once
/// \file
/// Locator settings found from a frame.

#include <string>
#include <vector>

namespace twincell {

/// The settings found, and how much of the picture they explain.
struct FoundSettings {
  double diameter_px = 0;
  bool bright = false;                     ///< beads are brighter than the background
  double explained = 0;                    ///< sum of -R^2 ln(1 - score), px^2
  std::vector<double> other_diameters_px;  ///< diameters of discs of further sizes
  std::string method;                      ///< new value of RefineOptions::method; empty: unchanged
  double contrast = 1;                     ///< PreprocessOptions::contrast of plain discs
};

}  // namespace twincell
