#pragma once
/// \file
/// A column of beads at rest, whose contacts carry the weight above.

#include <fmt/format.h>

#include "sim/run/simulation.hpp"
#include "sim/scene/read_scene.hpp"

namespace twincell::sim {

inline constexpr int kColumnBeads = 8;

/// A run of one column of beads at rest on a plate at rest, which stores its contacts.
inline MemoryTrajectory column_at_rest(int dimension) {
  const Scene scene = read_scene_text(
      fmt::format("[beads]\ncount = {}\n[cell]\ndimension = {}\nwidth = 1.000001\n{}[contact]\n"
                  "k_n = 1e5\ngamma_n = 100\nmu = 0.0\n[start]\nkind = \"crystal_a\"\nrest_energy = "
                  "1e-20\nsettle_limit = 2000\n[drive]\nomega = 1.0\n"
                  "amplitude = 0.0\n[time]\ndiscard = 0\ncycles = 1\nphases = 4\ncontacts = true\n",
                  kColumnBeads, dimension, dimension == 2 ? "" : "depth = 1.000001\n"),
      "column");
  Simulation run(scene);
  MemoryTrajectory t(run.trajectory_info());
  run.run(t);
  return t;
}

}  // namespace twincell::sim
