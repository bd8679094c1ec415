#pragma once
/// \file
/// No resistance to rolling.

#include <cmath>
#include <string_view>

#include "sim/laws/parameters.hpp"

namespace twincell::sim {

/// Both papers: beads roll freely.
struct NoRolling {
  static constexpr std::string_view kWord = "none", kName = "none";
  static constexpr std::array<const char*, 0> kKeys = {};
  static constexpr int kConstants = 0;
  static constexpr bool kActs = false;

  static NoRolling read(const ContactTable&) { return {}; }
  [[nodiscard]] double shortest_time(const PairScale&) const { return HUGE_VAL; }
  [[nodiscard]] std::array<double, kConstants> constants(const PairScale&) const { return {}; }

  template <class V, class T, class X>
  static T torque(const V*, const T& w, V, V, X&) {
    return w;  // never asked for
  }
};

}  // namespace twincell::sim
