#pragma once
/// \file
/// Beds that the test advances step by step, to check that results stay identical to the bit.

#include <cstring>

#include "sim/run/make_solver.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/start/start.hpp"

namespace twincell::sim {

inline bool same_bits(const System& a, const System& b) {
  return a.beads.size() == b.beads.size() &&
         std::memcmp(a.beads.data(), b.beads.data(), a.beads.size() * sizeof(Bead)) == 0;
}

/// Sixty beads with the contact law of the first paper, with softer springs, thrown onto a plate that shakes
/// them at Gamma = 3.
struct ShakenBed {
  Scene scene;
  Plan plan;
  System system;
  std::unique_ptr<Solver> kernel;

  explicit ShakenBed(const std::vector<std::string>& set = {}, SolverKind kind = SolverKind::best,
                     int threads = 1)
      : scene(read_scene_text(
            "[beads]\ncount = 60\n[drive]\nomega = 1.0\ngamma = 3.0\n[start]\nkind = \"random\"\nseed = 5\n"
            "[cell]\nwidth = 8.0\n[contact]\nk_n = 1e5\ngamma_n = 10.0\ngamma_t = 10.0\nk_t = 2e3\n",
            "shaken", set)),
        plan(make_plan(scene)),
        system(make_system(scene, plan)),
        kernel(make_solver(plan, guard_limits(plan), kind, threads)) {
    system.beads = make_start(scene).beads;
    for (Bead& b : system.beads) b.vz -= 2, b.vx *= 2, b.spin = b.vx;
  }
  void advance(std::int64_t steps) { kernel->advance(system, steps); }
};

}  // namespace twincell::sim
