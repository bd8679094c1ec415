#pragma once
/// \file
/// No tangential force.

#include <array>
#include <cmath>
#include <string_view>

#include "sim/laws/lammps_contact.hpp"
#include "sim/laws/parameters.hpp"
#include "sim/laws/tangent.hpp"

namespace twincell::sim {

/// Smooth beads: no tangential force, hence no torque, no rotation and no history. This law reads no key.
struct NoTangential {
  static constexpr std::string_view kWord = "none", kName = "none";
  static constexpr std::string_view kHelp = "smooth beads";
  static constexpr std::array<const char*, 0> kKeys = {};
  static constexpr int kConstants = 0;
  static constexpr bool kActs = false, kHistory = false;
  static constexpr std::string_view kInLammps = kWord;

  static NoTangential read(const ContactTable&) { return {}; }
  [[nodiscard]] double shortest_time(const PairScale&) const { return HUGE_VAL; }
  [[nodiscard]] std::array<double, kConstants> constants(const PairScale&) const { return {}; }
  void write_lammps(LammpsContact&, double) const {}

  template <class V, class T, class X>
  static T force(const V*, const T& v_t, V, V, X&) {
    return v_t;  // never called, because kActs is false
  }
};

}  // namespace twincell::sim
