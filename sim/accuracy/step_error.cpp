#include "sim/accuracy/step_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/laws/cell_laws.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/scene/make_plan.hpp"

namespace twincell::sim {

namespace {

/// The beads and laws of a scene, without walls, gravity and drive.
Scene in_empty_space(Scene s, const Plan& plan) {
  s.radius = plan.usual_radius, s.mass = plan.usual_mass;
  s.gravity = Vec3::Zero();
  s.plate_drag = 0;
  s.sides = s.plates = s.bottom = Edge::absent;
  s.lid = false;
  s.height.reset();
  s.drive = s.drive.at_rest();
  s.spread = SizeSpread::none;
  s.intruder.reset();
  s.start = StartKind::crystal_a;
  s.stepping = Stepping::steps;  // without gravity "auto" is event-driven, which has no step error
  return s;
}

/// The speed, or the largest at which beads overlap and travel within half of the guard's bounds.
double within_bounds(double speed, const Scene& s, const Plan& plan) {
  // With the linear law the overlap is at most v t_c/pi.
  const double gentle = std::numbers::pi * plan.overlap_bound / (2 * s.steps_per_contact * plan.dt);
  return std::min({speed, gentle, plan.travel_bound / (2 * plan.dt)});
}

/// Speed at which gravity and the drive make beads meet, estimated before a run; 0 without both.
double speed_of_forces(const Scene& s) {
  return std::max(2 * s.drive.velocity_bound(), std::sqrt(2 * s.g()));
}

constexpr int kEntryPhases = 32;  ///< entry phases of the stated errors
constexpr double kSlow = 1e-3;    ///< speed of impacts in a scene that sets nothing in motion, sqrt(g sigma)

/// e of one collision for each of `phases` entry phases; nothing if a pair does not part.
std::vector<double> restitutions(const Scene& space, double dt, double v, int phases) {
  constexpr double kPatience = 100;  // contact times
  const Plan plan = make_plan(space);
  System system = make_system(space, plan);
  system.dt = dt;
  const double reach = 2 * space.radius;
  const int side = static_cast<int>(std::ceil(std::sqrt(phases)));
  for (int k = 0; k < phases; ++k) {
    const int column = k % side, row = k / side;
    // Initial gap: no contact at the start, and a different fraction of a step for each pair.
    const double half = (reach + (5 + (k + 0.5) / phases) * v * dt) / 2;
    for (const int i : {-1, 1})
      system.beads.push_back({.x = 4 * reach * column + i * half,
                              .z = 4 * reach * row,
                              .vx = -i * v / 2,
                              .radius = space.radius,
                              .mass = space.mass,
                              .inertia = space.inertia_factor * space.mass * space.radius * space.radius});
  }
  const auto apart = [&] {
    for (std::size_t k = 0; k < system.beads.size(); k += 2) {
      const Bead &i = system.beads[k], &j = system.beads[k + 1];
      if (j.x - i.x <= reach || j.vx <= i.vx) return false;
    }
    return true;
  };
  const auto kernel = make_solver(plan, guard_limits(plan));
  const double contact = plan.shortest().time / dt;
  for (double waited = 0; !apart(); waited += 1) {
    if (waited > kPatience) return {};
    kernel->advance(system, static_cast<std::int64_t>(std::ceil(contact)) + 6);
  }
  kernel->advance(system, 2);  // half of the effect of a force comes in the next step
  std::vector<double> e;
  for (std::size_t k = 0; k < system.beads.size(); k += 2)
    e.push_back((system.beads[k + 1].vx - system.beads[k].vx) / v);
  return e;
}

std::optional<ImpactErrors> friction_error(const Scene& space, const Plan& plan, double speed) {
  constexpr int kOblique = 16;  // entry phases per angle
  if (!plan.rotation || !(remembers(plan.laws->bead) || integrable_alone(plan.laws->bead)))
    return std::nullopt;
  std::vector<Impact> impacts;
  for (const double degrees : {15.0, 30.0, 45.0, 60.0, 75.0})
    impacts.push_back(Impact::at(degrees, false, speed));
  // The n that gives the step of the plan for two isolated beads: the plan's own n also depends on walls,
  // drive and gravity.
  const double n = make_plan(space).shortest().time / plan.dt;
  try {
    return impact_errors(impacts, space, {.integrator = space.integrator, .n = n}, kOblique);
  } catch (const RunError&) {
    return std::nullopt;  // the beads do not part
  }
}

}  // namespace

std::vector<double> stated_speeds(const Scene& scene, const Plan& plan,
                                  const std::optional<StartSpeeds>& start) {
  constexpr double kAlike = 1.1;  // ratio of speeds of which one is stated
  const double forces = speed_of_forces(scene);
  if (!start) return {within_bounds(std::max(forces, kSlow), scene, plan)};
  const double typical = within_bounds(std::max(forces, start->typical), scene, plan),
               largest = within_bounds(std::max(forces, start->largest), scene, plan);
  if (largest < kAlike * typical) return {largest};
  return {typical, largest};
}

std::optional<StepError> step_error(const Scene& scene, const Plan& plan, int phases,
                                    std::optional<double> speed) {
  constexpr double kFiner = 8, kFine = 2000;
  const Scene space = in_empty_space(scene, plan);
  Scene fine = space;
  fine.integrator = "split";
  const double v = speed.value_or(within_bounds(std::max(speed_of_forces(scene), kSlow), scene, plan));
  const auto exact =
      restitutions(fine, plan.dt / std::max(kFiner, std::ceil(kFine / scene.steps_per_contact)), v, 1);
  const auto measured = restitutions(space, plan.dt, v, phases);
  if (exact.empty() || measured.empty()) return std::nullopt;
  return StepError{v, exact.front(), EntryPhaseSpread::of(measured, exact.front()),
                   friction_error(space, plan, v)};
}

namespace {

/// The result at a speed, in words.
std::string clause(double speed, const std::optional<StepError>& error) {
  if (!error) return fmt::format("two beads that meet at v = {:.3g} do not part", speed);
  std::string s = fmt::format(
      "e of two beads that meet at v = {:.3g} is {:.4g} and errs by up to {:.2g}, by {:.2g} on average "
      "over collisions",
      error->speed, error->restitution, error->error.largest, error->error.mean);
  if (error->friction)
    s += fmt::format(
        "; at 15 to 75 degrees friction changes R w by {:.2g} v, with an error of {:.2g} v rms and up to "
        "{:.2g} v",
        error->friction->spin_change, error->friction->spin.rms, error->friction->spin.largest);
  return s;
}

}  // namespace

void state_step_error(const Scene& scene, Plan& plan, const std::optional<StartSpeeds>& start) {
  std::string text;
  for (const double speed : stated_speeds(scene, plan, start))
    text += (text.empty() ? ": " : "; ") + clause(speed, step_error(scene, plan, kEntryPhases, speed));
  for (Effect& effect : plan.effects)
    if (effect.name == kTimeIntegration) effect.reason += text;
}

}  // namespace twincell::sim
