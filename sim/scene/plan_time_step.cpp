#include "sim/scene/plan_time_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/error.hpp"
#include "sim/laws/cell_laws.hpp"

namespace twincell::sim {

namespace {

struct BeadScale {
  double radius, mass;
};

bool is_smaller(const BeadScale& a, const BeadScale& b) {
  return a.radius < b.radius;
}

/// The sizes of beads that the scene states, without those of a file.
std::vector<BeadScale> stated_sizes(const Scene& s) {
  const double smallest = s.radius * (1 - largest_deviation(s.spread, s.spread_width));
  std::vector<BeadScale> all = {{smallest, s.mass_of(smallest)}};
  if (s.intruder) all.push_back({s.intruder->radius, s.intruder->mass});
  return all;
}

/// The sizes that a run can have. Only beads from a file can differ from those that the scene states. Sets
/// radius and mass of the median bead in the plan.
std::vector<BeadScale> sizes_of(const Scene& s, const std::vector<Bead>& beads, Plan& plan) {
  plan.usual_radius = s.radius, plan.usual_mass = s.mass;
  std::vector<BeadScale> sizes;
  if (start_row(s.start).from_file)
    for (const Bead& b : beads) sizes.push_back({b.radius, b.mass});
  if (sizes.empty()) return stated_sizes(s);
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end(), is_smaller);
  plan.usual_radius = middle->radius, plan.usual_mass = middle->mass;
  // A run in motion keeps the step of the run that drew the sizes, which the bounds of the spread set.
  if (s.in_motion && s.spread != SizeSpread::none) {
    const std::vector<BeadScale> drawn_from = stated_sizes(s);
    sizes.insert(sizes.end(), drawn_from.begin(), drawn_from.end());
  }
  return sizes;
}

/// The sizes with the fastest contacts: the lightest bead, and, where the stiffness is proportional to the
/// square root of the radius (Hertz), the bead of least m^2/R.
std::vector<BeadScale> fastest(const std::vector<BeadScale>& all) {
  const auto least = [&](auto of) {
    return *std::min_element(all.begin(), all.end(),
                             [&](const BeadScale& a, const BeadScale& b) { return of(a) < of(b); });
  };
  return {least([](const BeadScale& b) { return b.mass; }),
          least([](const BeadScale& b) { return b.mass * b.mass / b.radius; })};
}

/// Largest speed of a bead at the start: those of a file state theirs, drawn ones have components up to
/// start.velocity_scale, next to start.fall_speed.
double start_speed(const Scene& s, const std::vector<Bead>& beads) {
  double largest = start_row(s.start).draws ? std::numbers::sqrt2 * s.velocity_scale + s.fall_speed : 0;
  if (start_row(s.start).from_file)
    for (const Bead& b : beads) largest = std::max(largest, std::hypot(b.vx, b.vy, b.vz));
  return largest;
}

/// Largest factor on the drive's amplitude in its schedule.
double largest_factor(const Scene& s) {
  double largest = 1;
  for (const auto& [cycle, factor] : s.envelope.points) largest = std::max(largest, factor);
  return largest;
}

void set_bounds(const Scene& s, const std::vector<BeadScale>& sizes, Plan& plan) {
  plan.travel_bound = kTravelBound * 2 * std::min_element(sizes.begin(), sizes.end(), is_smaller)->radius;
  plan.overlap_bound = s.overlap_bound * 2 * plan.usual_radius;
  const auto force = [&](const auto& law) { return law.largest_force(plan.overlap_bound); };
  plan.largest_force = std::visit(force, plan.laws->bead.normal);
  for (const ContactLaws& laws : plan.laws->walls)
    plan.largest_force = std::max(plan.largest_force, std::visit(force, laws.normal));
}

/// Adds a limit, or keeps the shorter of two limits with the same name.
void keep_shorter(std::vector<TimeLimit>& limits, const TimeLimit& limit) {
  for (TimeLimit& known : limits)
    if (known.name == limit.name) {
      known.time = std::min(known.time, limit.time);
      return;
    }
  limits.push_back(limit);
}

/// Time that the tangential law needs to be resolved, t0; infinite without a limit. A stiffness that grows
/// with the overlap is not bounded by that of a normal law with a constant stiffness.
double tangential_time(const ContactLaws& laws, const PairScale& pair, double speed) {
  const double overlap =
      std::visit([&](const auto& law) { return law.impact_overlap(pair, speed); }, laws.normal);
  return std::visit(
      [&]<class Law>(const Law& law) {
        if constexpr (ReadsOverlap<Law>)
          return std::min(law.shortest_time(pair), law.shortest_time(pair, overlap));
        else
          return law.shortest_time(pair);
      },
      laws.tangential);
}

void add_limits(const std::string& kind, const ContactLaws& laws, const PairScale& pair, double speed,
                std::vector<TimeLimit>& limits) {
  keep_shorter(limits,
               {kind + ", normal contact",
                std::visit([&](const auto& law) { return law.shortest_time(pair, speed); }, laws.normal)});
  const double tangential = tangential_time(laws, pair, speed);
  if (std::isfinite(tangential)) keep_shorter(limits, {kind + ", tangential contact", tangential});
  const double rolling = std::visit([&](const auto& law) { return law.shortest_time(pair); }, laws.rolling);
  if (std::isfinite(rolling)) keep_shorter(limits, {kind + ", rolling", rolling});
}

/// The shortest times of all kinds of contact. \param speed of the fastest impact
std::vector<TimeLimit> list_limits(const Scene& s, const std::vector<BeadScale>& sizes, double speed,
                                   const Plan& plan) {
  std::vector<TimeLimit> limits;
  for (const auto& [radius, mass] : fastest(sizes)) {
    add_limits("bead-bead", plan.laws->bead, equal_beads(radius, mass, s.inertia_factor), speed, limits);
    for (std::size_t w = 0; w < plan.walls.size(); ++w)
      add_limits("bead-" + plan.walls[w].name, plan.laws->walls[w],
                 bead_and_wall(radius, mass, s.inertia_factor), speed, limits);
  }
  if (s.plate_drag > 0) limits.push_back({"plate drag", 1 / s.plate_drag});
  return limits;
}

/// Steps of a cycle: each phase is a whole number of them.
std::int64_t steps_of_cycle(const Scene& s, double shortest) {
  constexpr double kMaxSteps = 1e10;
  double steps = s.drive.period() / (shortest / s.steps_per_contact);
  // While the frequency changes, a frame is at the step nearest to its phase.
  constexpr double kFinePhases = 1000;  // steps of the shortest cycle
  if (s.drive.ramp)
    if (const DriveRamp& ramp = *s.drive.ramp; ramp.changes_frequency())
      steps = std::max({steps, kFinePhases * ramp.to.omega / ramp.from.omega, kFinePhases});
  if (!(steps <= kMaxSteps))
    throw ConfigError(
        s.where("drive"),
        fmt::format("a cycle of {:.3g} t0 takes {:.3g} steps of the shortest contact, the bound is {:g}.",
                    s.drive.period(), steps, kMaxSteps));
  const auto whole = static_cast<std::int64_t>(std::ceil(steps));
  const std::int64_t rest = whole % s.phases;
  return rest == 0 ? whole : whole + s.phases - rest;
}

void require_sound_step(const Scene& s, const Plan& plan) {
  constexpr double kShortestStep = 1e-12;
  if (!(plan.dt >= kShortestStep))
    throw ConfigError(s.where("drive"),
                      fmt::format("a cycle of {:.3g} t0 makes steps of {:.3g} t0, the bound is {:g}.",
                                  s.drive.period(), plan.dt, kShortestStep));
  if (const double travel = largest_factor(s) * s.drive.velocity_bound() * plan.dt;
      !(travel <= plan.travel_bound))
    throw ConfigError(s.where("drive"),
                      fmt::format("the plate moves {:.3g} sigma in one step, the bound is {:g}; raise "
                                  "time.steps_per_contact or contact.k_n.",
                                  travel, plan.travel_bound));
}

}  // namespace

void set_time_step(const Scene& s, const std::vector<Bead>& beads, Plan& plan) {
  const std::vector<BeadScale> sizes = sizes_of(s, beads, plan);
  set_bounds(s, sizes, plan);
  const double speed = std::max(
      {2 * largest_factor(s) * s.drive.velocity_bound(), std::sqrt(2 * s.g()), start_speed(s, beads), 1e-3});
  plan.limits = list_limits(s, sizes, speed, plan);
  plan.steps_per_period = steps_of_cycle(s, plan.shortest().time);
  plan.dt = s.drive.period() / static_cast<double>(plan.steps_per_period);
  require_sound_step(s, plan);
}

}  // namespace twincell::sim
