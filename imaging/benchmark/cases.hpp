#pragma once
/// \file
/// Benchmark cases: the rendered pictures on which locators are measured.

#include <cstdint>
#include <string>
#include <vector>

#include "imaging/benchmark/picture.hpp"

namespace twincell::imaging::rendered {

/// One benchmark case: a kind of picture and the noise levels at which it is rendered.
struct Case {
  std::string name;
  std::string what;         ///< description in words
  double diameter;          ///< nominal diameter given to the locator, px
  std::vector<double> snr;  ///< signal-to-noise ratios (picture.hpp)
  Picture (*make)(std::uint64_t seed);
  std::vector<double> other_diameters = {};  ///< nominal diameters of further sizes, px
};

/// All cases. To add one, add an entry to the list in cases.cpp.
const std::vector<Case>& cases();

}  // namespace twincell::imaging::rendered
