#include "sim/run/cost.hpp"

#include <algorithm>
#include <chrono>
#include <limits>

#include "core/cpu_clock.hpp"
#include "core/error.hpp"
#include "sim/run/driven_work.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/starts.hpp"

namespace twincell::sim {

namespace {

/// Processor time of one thread does not depend on other programs. Several threads also wait for each other,
/// which only the elapsed time includes.
double now(std::size_t beads, int threads) {
  if (threads_for(beads, threads) == 1) return thread_cpu_seconds();
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Steps and the time that they took.
struct Piece {
  std::int64_t steps = 0;
  double seconds = 0;
};

/// Advances in calls of the length that a run uses, until `seconds` have passed or `most` steps are done.
Piece advance_for(double seconds, std::int64_t most, Solver& solver, System& system, int threads,
                  Progress& progress) {
  const std::size_t beads = system.beads.size();
  const double begin = now(beads, threads);
  Piece piece;
  while (piece.steps < most && piece.seconds < seconds) {
    progress.update(0, 0);
    const std::int64_t steps = std::min(steps_per_call(beads), most - piece.steps);
    solver.advance(system, steps);
    piece.steps += steps;
    piece.seconds = now(beads, threads) - begin;
  }
  return piece;
}

double layers_of(const Scene& scene, std::size_t beads) {
  const double diameter = 2 * scene.radius;
  double per_layer = scene.width / diameter;
  if (scene.dimension == 3) per_layer *= scene.depth / diameter;
  return static_cast<double>(beads) / per_layer;
}

/// Beads of unlike sizes do not touch on a lattice, whose constant is the largest diameter, and would fall
/// without contacts. With that diameter they are a bed in contact; by their masses they stay unlike, as in
/// the run.
void enlarge_to_touch(std::vector<Bead>& beads, std::size_t intruders) {
  const auto end = beads.end() - static_cast<std::ptrdiff_t>(intruders);
  double largest = 0;
  for (auto b = beads.begin(); b != end; ++b) largest = std::max(largest, b->radius);
  for (auto b = beads.begin(); b != end; ++b) b->radius = largest;
}

constexpr double kCrossing = 8;  ///< most time for the bed to be compressed, over that of the measurement

/// Time of a step of the bed at rest. Beads that start at random positions would fall first, so the same
/// beads are measured in a crystal.
double seconds_per_step_at_rest(Scene scene, double seconds, int threads, Progress& progress) {
  if (start_row(scene.start).draws) scene.start = StartKind::crystal_a;
  RunState state = placed(scene, progress);
  const Plan plan = make_plan(scene, state.beads);
  if (!start_row(scene.start).from_file) enlarge_to_touch(state.beads, scene.intruder ? 1 : 0);
  System system = make_system(scene, plan);
  system.drive = scene.drive.at_rest();
  system.beads = std::move(state.beads);
  const auto solver = make_solver(plan, guard_limits(plan), SolverKind::best, threads);
  // Beads of a crystal touch without overlap and fall together. Those above the sound wave that starts at the
  // plate have no contact forces yet. The wave crosses a layer in half a contact time at most.
  const std::size_t beads = system.beads.size();
  const double crossing = layers_of(scene, beads) * scene.steps_per_contact / 2;
  advance_for(kCrossing * seconds, std::max(steps_per_call(beads), static_cast<std::int64_t>(crossing)),
              *solver, system, threads, progress);
  const Piece piece =
      advance_for(seconds, std::numeric_limits<std::int64_t>::max(), *solver, system, threads, progress);
  return piece.seconds / static_cast<double>(piece.steps);
}

}  // namespace

Cost measure_cost(const Scene& scene, double seconds, int threads, Progress& progress) {
  constexpr double kSettling = 0.1;
  RunState state = placed(scene, progress);
  Cost cost;
  cost.plan = make_plan(scene, state.beads);
  cost.start_speeds = speeds_of_start(scene, state.beads);
  const Plan& plan = cost.plan;
  System system = make_system(scene, plan);
  if (!state.driven) system.drive = scene.drive.at_rest();
  system.step = state.step;
  system.beads = std::move(state.beads);
  const auto solver = make_solver(plan, guard_limits(plan), SolverKind::best, threads);
  solver->restore(std::move(state.contacts));
  cost.beads = system.beads.size();
  cost.solver = solver->description();
  const bool falls = scene.g() > 0 && !state.driven;
  try {
    advance_for(falls ? kSettling : 0, falls ? static_cast<std::int64_t>(scene.settle_limit / plan.dt) : 0,
                *solver, system, threads, progress);
    if (!state.driven) {
      cost.settled_for = system.time();
      begin_drive(scene, plan, system);
    }
    const Piece driven = advance_for(seconds, plan.steps, *solver, system, threads, progress);
    cost.measured_steps = driven.steps;
    cost.seconds_per_step = driven.seconds / static_cast<double>(driven.steps);
    const bool bed = falls && !plan.event_driven && cost.beads > 0;
    if (bed && driven.steps < std::min(plan.steps, plan.steps_per_period)) {
      cost.relative_work = driven_work(scene.drive.gamma(), layers_of(scene, cost.beads));
      cost.seconds_per_step =
          *cost.relative_work * seconds_per_step_at_rest(scene, seconds, threads, progress);
    }
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
