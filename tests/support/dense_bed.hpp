#pragma once
/// \file
/// A small dense bed for every combination of laws, dimension, integrator, sizes and boundaries, on which
/// solvers are compared bit for bit.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <ostream>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "sim/laws/law_words.hpp"
#include "sim/scene/plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/start/start.hpp"
#include "sim/stepping/solver.hpp"

namespace twincell::sim {

struct LawWords {
  std::string normal, tangential, rolling;
};
inline std::vector<LawWords> all_laws() {
  std::vector<LawWords> all;
  for (const auto& normal : normal_words())
    for (const auto& tangential : tangential_words())
      for (const auto& rolling : rolling_words())
        if (tangential != "none" || rolling == "none") all.push_back({normal, tangential, rolling});
  return all;
}

struct Case {
  int dimension;
  std::string integrator;
  bool unequal;  ///< distributed radii, and an intruder
  bool periodic;
};
inline void PrintTo(const Case& c, std::ostream* out) {
  *out << c.dimension << "D " << c.integrator << (c.unequal ? " unequal" : " equal")
       << (c.periodic ? " periodic" : " walls");
}

/// A small bed, dense and fast enough that contacts begin, slide, stick, roll and end from the first steps
/// on.
inline Scene scene_of(const Case& c, const LawWords& laws) {
  std::string text = "[cell]\ndimension = " + std::to_string(c.dimension);
  text += c.dimension == 2 ? "\nwidth = 5.0\n" : "\nwidth = 3.8\ndepth = 3.8\n";
  if (c.periodic) text += "sides = \"periodic\"\n";
  if (c.periodic && c.dimension == 3) text += "plates = \"periodic\"\n";
  text += "[beads]\ncount = 20\n";
  if (c.unequal)
    text += "spread = \"uniform\"\nspread_width = 0.2\n[beads.intruder]\nradius = 0.83\nz = 2.5\n";
  text += "[drive]\nomega = 7.0\ngamma = 4.0\n[time]\nsteps_per_contact = 12\nintegrator = \"" +
          c.integrator + "\"\n";
  text += "[contact]\nnormal = \"" + laws.normal + "\"\ntangential = \"" + laws.tangential +
          "\"\nrolling = \"" + laws.rolling + "\"\n";
  // One value for every key that a law may read. Where several keys set the same quantity, only the one
  // listed here is used.
  const std::map<std::string, double> values = {{"k_n", 1e4},
                                                {"restitution", 0.8},
                                                {"restitution_fast", 0.6},
                                                {"youngs_modulus", 3e4},
                                                {"viscous_time", 1e-3},
                                                {"pull_off_force", 3},
                                                {"mu", 0.4},
                                                {"k_t", 3e3},
                                                {"k_r", 50},
                                                {"c_r", 0.05},
                                                {"mu_r", 0.2}};
  const std::vector<std::string> keys = keys_of(laws.normal, laws.tangential, laws.rolling);
  const auto reads = [&](const char* key) { return std::find(keys.begin(), keys.end(), key) != keys.end(); };
  const std::set<std::string> once(keys.begin(), keys.end());
  for (const std::string& key : once)
    if (const auto value = values.find(key); value != values.end())
      text += key + " = " + std::to_string(value->second) + "\n";
  if (reads("c_t")) text += reads("restitution") ? "c_t_over_c_n = 0.5\n" : "c_t = 5.0\n";
  const bool rough = laws.tangential != "none";
  if (rough) text += "[contact.wall]\nmu = 0.7\n";
  return read_scene_text(text, "bed");
}

/// The beads of the start, at their velocities.
inline System start_of(const Scene& scene, const Plan& plan) {
  System s = make_system(scene, plan);
  s.beads = make_start(scene).beads;
  return s;
}

inline System bed_of(const Scene& scene, const Plan& plan) {
  System s = start_of(scene, plan);
  std::mt19937_64 engine(11);
  const auto random = [&] { return static_cast<double>(engine() >> 11) * 0x1p-52 - 1; };
  for (Bead& b : s.beads) {
    b.vx = 2 * random(), b.vz = 2 * random(), b.spin = 4 * random();
    if (s.dimension == 3) b.vy = 2 * random(), b.spin_x = 4 * random(), b.spin_z = 4 * random();
  }
  return s;
}

inline std::vector<Case> all_cases() {
  std::vector<Case> all;
  for (const int dimension : {2, 3})
    for (const char* integrator : {"verlet", "predicted", "split"})
      for (const bool unequal : {false, true})
        for (const bool periodic : {false, true}) all.push_back({dimension, integrator, unequal, periodic});
  return all;
}
inline std::string name_of_case(const testing::TestParamInfo<Case>& of) {
  const Case& c = of.param;
  return std::string(c.dimension == 2 ? "Plane" : "Space") + "_" + c.integrator + "_" +
         (c.unequal ? "unequal" : "equal") + "_" + (c.periodic ? "periodic" : "walls");
}

/// Final state of a run.
struct Outcome {
  System system;
  std::vector<ContactMemory> contacts;
};

inline bool same_bits(const Outcome& a, const Outcome& b) {
  const auto same = [](const auto& u, const auto& v) {
    return u.size() == v.size() && std::memcmp(u.data(), v.data(), u.size() * sizeof(u[0])) == 0;
  };
  if (!same(a.system.beads, b.system.beads) || a.contacts.size() != b.contacts.size()) return false;
  for (std::size_t k = 0; k < a.contacts.size(); ++k) {
    const ContactMemory &p = a.contacts[k], &q = b.contacts[k];
    const std::size_t kept = std::min(p.values.size(), q.values.size());  // the oracle stores trailing zeros
    if (p.i != q.i || p.j != q.j || std::memcmp(p.values.data(), q.values.data(), kept * sizeof(double)) != 0)
      return false;
  }
  return true;
}

}  // namespace twincell::sim
