#include "sim/run/cost.hpp"

#include <algorithm>
#include <chrono>

#include "core/error.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/run/simulation.hpp"

namespace twincell::sim {

namespace {

/// Advances in small pieces until `seconds` have passed or `most` steps are done; returns the elapsed
/// seconds.
double advance_for(double seconds, std::int64_t most, Solver& solver, System& system, Progress& progress) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  const std::int64_t piece = 1 + 200'000 / (1 + static_cast<std::int64_t>(system.beads.size()));
  for (std::int64_t done = 0; done < most && elapsed() < seconds; done += piece) {
    progress.update(0, 0);
    solver.advance(system, std::min(piece, most - done));
  }
  return elapsed();
}

}  // namespace

Cost measure_cost(const Scene& scene, double seconds, int threads, Progress& progress) {
  constexpr double kSettling = 0.1;
  RunState state = placed(scene, progress);
  Cost cost;
  cost.plan = make_plan(scene, state.beads);
  const Plan& plan = cost.plan;
  System system = make_system(scene, plan);
  if (!state.driven) system.drive.amplitude = 0;
  system.step = state.step;
  system.beads = std::move(state.beads);
  const auto solver = make_solver(plan, guard_limits(plan), SolverKind::best, threads);
  solver->restore(std::move(state.contacts));
  cost.beads = system.beads.size();
  cost.solver = solver->description();
  try {
    const bool falls = scene.g() > 0 && !state.driven;
    advance_for(falls ? kSettling : 0, falls ? static_cast<std::int64_t>(scene.settle_limit / plan.dt) : 0,
                *solver, system, progress);
    if (!state.driven) {
      cost.settled_for = system.time();
      begin_drive(scene, plan, system);
    }
    const std::int64_t begin = system.step;
    const double took = advance_for(seconds, plan.steps, *solver, system, progress);
    cost.measured_steps = system.step - begin;
    cost.seconds_per_step = took / static_cast<double>(cost.measured_steps);
  } catch (const RunError& e) {
    cost.stopped = e.what();
  }
  const Solver::Footprint held = solver->footprint();
  if (cost.beads > 0) {
    cost.bytes_per_bead = static_cast<double>(held.beads) / static_cast<double>(cost.beads);
    cost.pairs_per_bead = static_cast<double>(held.listed) / static_cast<double>(cost.beads);
  }
  if (held.listed > 0)
    cost.bytes_per_pair = static_cast<double>(held.pairs) / static_cast<double>(held.listed);
  return cost;
}

}  // namespace twincell::sim
