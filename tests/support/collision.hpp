#pragma once
/// \file
/// Single contacts: scenes whose kernel the test advances step by step, and collisions with a chosen entry
/// phase.

#include <cmath>
#include <string>

#include "sim/run/make_solver.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"

namespace twincell::sim {

/// A kernel and a system with the model of the first paper without gravity, changed by `extra` (TOML, table
/// by table).
struct Bench {
  Scene scene;
  Plan plan;
  System system;
  std::unique_ptr<Solver> kernel;

  /// \param n steps per contact time of the bead-bead contact. Use a non-integer such as 50.37: a step that
  /// divides t_c hides errors.
  explicit Bench(const std::string& extra, double n = 50.37, SolverKind kind = SolverKind::best) {
    scene = read_scene_text(
        "preset = \"fortini-huang-2015\"\n[beads]\ncount = 1\n[drive]\namplitude = 0.0\n" + extra, "bench");
    scene.steps_per_contact = n;
    if (!scene.integrator_stated) scene.integrator = "verlet";
    if (scene.stepping == Stepping::automatic)
      scene.stepping = Stepping::steps;  // these tests concern the fixed steps
    plan = make_plan(scene);
    system = make_system(scene, plan);
    // The plan rounds the step to give whole phases; these tests need the exact step.
    double shortest = HUGE_VAL;
    for (const TimeLimit& limit : plan.limits)
      if (limit.name.find("bead-bead, normal") == 0) shortest = limit.time;
    system.dt = shortest / n;
    GuardLimits limits;
    limits.travel_per_step = 1;
    kernel = make_solver(plan, limits, kind);
  }

  Bead& add(double x, double z, double vx, double vz, double spin = 0) {
    system.beads.push_back({x, z, vx, vz, spin, scene.radius, scene.mass,
                            scene.inertia_factor * scene.mass * scene.radius * scene.radius});
    return system.beads.back();
  }
  void advance_time(double time) {
    kernel->advance(system, static_cast<std::int64_t>(std::ceil(time / system.dt)));
  }
};

inline const std::string kNoGravity = "[cell]\ngravity = 0.0\nheight = 1000.0\nlid = \"wall\"\n";

/// Head-on collision of two beads far from the walls at +-v/2; returns e. `phase`: the initial gap is
/// 5 + `phase` steps of v dt.
inline double pair_restitution(const std::string& extra, double n, double v, double phase) {
  Bench b(kNoGravity + extra, n);
  const double gap = (5 + phase) * v * b.system.dt;
  b.add(10 - 0.5 - gap / 2, 50, v / 2, 0);
  b.add(10 + 0.5 + gap / 2, 50, -v / 2, 0);
  b.advance_time(8e-3 + 2 * gap / v);
  return (b.system.beads[1].vx - b.system.beads[0].vx) / v;
}

/// Vertical collision with the plate at rest; returns e.
inline double wall_restitution(const std::string& extra, double n, double v, double phase) {
  Bench b(kNoGravity + extra, n);
  const double gap = (5 + phase) * v * b.system.dt;
  b.add(10, 0.5 + gap, 0, -v);
  b.advance_time(1e-2 + 2 * gap / v);
  return b.system.beads[0].vz / v;
}

/// Mean and largest error of e over entry phases spread evenly over a step.
struct PhaseErrors {
  double mean = 0, largest = 0;
};
template <class Measure>
PhaseErrors over_entry_phases(Measure measure, double exact, int phases = 100) {
  PhaseErrors errors;
  for (int k = 0; k < phases; ++k) {
    const double error = measure((k + 0.5) / phases) - exact;
    errors.mean += error / phases;
    errors.largest = std::max(errors.largest, std::abs(error));
  }
  return errors;
}

}  // namespace twincell::sim
