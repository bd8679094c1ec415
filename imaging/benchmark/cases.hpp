#pragma once
/// \file
/// The pictures on which locators are measured.

#include <cstdint>
#include <string>
#include <vector>

#include "imaging/benchmark/picture.hpp"

namespace twincell::rendered {

struct Case {
  std::string name;
  std::string what;  ///< in words
  double diameter;   ///< nominal, px: what a locator is told
  std::vector<double> snr;
  Picture (*make)(std::uint64_t seed);
  std::vector<double> other_diameters = {};  ///< likewise, of further sizes
};

/// To add a case: one entry in the list in cases.cpp.
const std::vector<Case>& cases();

}  // namespace twincell::rendered
