#include "calibration/fit/law.hpp"

#include <fmt/format.h>

#include "core/error.hpp"

namespace twincell::calibration {

const Law& constant_law();
const Law& line_law();
const Law& power_law();
const Law& slope_break_law();
const Law& arrhenius_law();
const Law& arrhenius_break_law();
const Law& algebraic_law();
const Law& exponential_law();

const std::vector<const Law*>& laws() {
  static const std::vector<const Law*> list = {
      &constant_law(),        &line_law(),      &power_law(),       &slope_break_law(), &arrhenius_law(),
      &arrhenius_break_law(), &algebraic_law(), &exponential_law(),
  };
  return list;
}

const Law& law_named(const std::string& name) {
  std::string names;
  for (const Law* law : laws()) {
    if (law->name == name) return *law;
    names += (names.empty() ? "" : ", ") + law->name;
  }
  throw ConfigError({.file = {}, .key = "law"},
                    fmt::format("there is no law called \"{}\"; the laws are {}", name, names));
}

}  // namespace twincell::calibration
