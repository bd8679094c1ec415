#pragma once
/// \file
/// No rolling resistance.

#include <cmath>
#include <string_view>

#include "sim/laws/lammps_contact.hpp"
#include "sim/laws/parameters.hpp"

namespace twincell::sim {

/// Beads roll freely, as in both papers (Fortini & Huang 2015; Bhateja et al. 2016).
struct NoRolling {
  static constexpr std::string_view kWord = "none", kName = "none";
  static constexpr std::string_view kHelp = "beads roll freely";
  static constexpr std::array<const char*, 0> kKeys = {};
  static constexpr int kConstants = 0;
  static constexpr bool kActs = false;
  static constexpr std::string_view kInLammps = kWord;

  static NoRolling read(const ContactTable&) { return {}; }
  [[nodiscard]] double shortest_time(const PairScale&) const { return HUGE_VAL; }
  [[nodiscard]] std::array<double, kConstants> constants(const PairScale&) const { return {}; }
  void write_lammps(LammpsContact&, double) const {}

  template <class V, class T, class X>
  static T torque(const V*, const T& w, V, V, X&) {
    return w;  // never called, because kActs is false
  }
};

}  // namespace twincell::sim
