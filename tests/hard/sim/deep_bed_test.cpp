// A deep bed comes to rest.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "sim/run/make_solver.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/start/start.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sim::deep_bed_test {
namespace {

using test::validate;

/// Eighty layers of the first paper's beads on a plate at rest, after 30 t0 of settling.
struct DeepBed {
  Scene scene;
  Plan plan;
  System system;
  std::unique_ptr<Solver> kernel;

  DeepBed()
      : scene(read_scene_text("preset = \"fortini-huang-2015\"\n[cell]\nwidth = 4.0\n[beads]\ncount = 280\n"
                              "[drive]\namplitude = 0.0\n[contact]\ngamma_n = 400.0\ngamma_t = 400.0\n"
                              "[time]\nsteps_per_contact = 20\n",
                              "deep")),
        plan(make_plan(scene)),
        system(make_system(scene, plan)),
        kernel(make_solver(plan, guard_limits(plan))) {
    system.beads = make_start(scene).beads;
    advance_time(30);
  }
  void advance_time(double time) {
    kernel->advance(system, static_cast<std::int64_t>(std::ceil(time / system.dt)));
  }
  /// Force on the floor over the weight N m g.
  [[nodiscard]] double carried() const {
    double force = 0;
    for (const Force& f : system.forces) force += f.z;
    return force / static_cast<double>(system.beads.size());
  }
};

TEST(DeepBed, EightyLayersRest) {
  DeepBed bed;
  EXPECT_GE(std::max_element(bed.system.beads.begin(), bed.system.beads.end(),
                             [](const Bead& a, const Bead& b) { return a.z < b.z; })
                ->z,
            80 * 0.86);
  const std::vector<Bead> before = bed.system.beads;
  bed.advance_time(30);
  double moved = 0;
  for (std::size_t k = 0; k < before.size(); ++k)
    moved = std::max({moved, std::abs(bed.system.beads[k].x - before[k].x),
                      std::abs(bed.system.beads[k].z - before[k].z)});
  validate({"H28", "80 layers at rest: kinetic energy a bead, m g sigma", 0, 1e-10, "at rest"},
           kinetic_energy_per_bead(bed.system));
  validate({"H28", "80 layers at rest: largest way of a bead in 30 t0, sigma", 0, 1e-9, "at rest"}, moved);
  validate({"H28", "80 layers at rest: floor's force over N m g", 1, 1e-9, "closed form"}, bed.carried());
}

}  // namespace
}  // namespace twincell::sim::deep_bed_test
