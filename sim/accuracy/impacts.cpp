#include "sim/accuracy/impacts.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <set>

#include "core/error.hpp"
#include "sim/event_driven/binary_collision.hpp"
#include "sim/laws/cell_laws.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/start/start.hpp"

namespace twincell::sim {

namespace {

constexpr double kRunUp = 5;  // whole steps before first touch; a fraction of a step is added

/// Two beads, or a bead and the plate, as used by the solver and by the exact solution.
struct Bodies {
  double radius, mass, inertia;
  bool wall;

  Bodies(const Scene& s, bool at_wall)
      : radius(s.radius),
        mass(s.mass),
        inertia(s.inertia_factor * s.mass * s.radius * s.radius),
        wall(at_wall) {}
  [[nodiscard]] double turn() const { return (wall ? 1 : 2) * radius * radius / inertia; }
  [[nodiscard]] double m_eff() const { return wall ? mass : mass / 2; }
  [[nodiscard]] CollisionSetting setting(const Plan& plan) const {
    return {.dimension = plan.dimension,
            .laws = wall ? &plan.laws->walls.at(0) : &plan.laws->bead,
            .pair = {m_eff(), wall ? radius : radius / 2, 1 / m_eff() + turn()},
            .reach = wall ? radius : 2 * radius,
            .turn = turn(),
            .wall = wall ? std::optional(Vec3(Vec3::UnitZ())) : std::nullopt};
  }
  /// At first touch the normal points up, so the tangent (-n_z, n_x) is -x.
  [[nodiscard]] RelativeMotion at_touch(const Impact& i) const {
    return {Vec3(0, 0, wall ? radius : 2 * radius), Vec3(-i.v_t, 0, -i.v_n), Vec3(0, -i.rim, 0)};
  }
  /// \param r from j to i; at the plate, from the plate
  [[nodiscard]] Outcome outcome(const Vec3& r, const Vec3& u, double rim) const {
    const Vec3 n = wall ? Vec3(Vec3::UnitZ()) : Vec3(r.normalized());
    return {u.dot(n), -n.z() * u.x() + n.x() * u.z(), rim / (wall ? radius : 2 * radius), 0};
  }
};

}  // namespace

double Impact::speed() const {
  return std::hypot(v_n, v_t - rim);
}
Impact Impact::at(double degrees, bool wall, double speed, double rim) {
  const double a = degrees * std::numbers::pi / 180;
  return {wall, speed * std::cos(a), speed * std::sin(a), rim};
}

Scene impact_scene(const std::string& contact, int dimension) {
  const std::string depth = dimension == 3 ? fmt::format("depth = {}\n", kImpactDistance) : "";
  return read_scene_text(
      fmt::format("preset = \"fortini-huang-2015\"\n[cell]\ndimension = {}\nwidth = {}\nheight = {}\n{}"
                  "lid = \"wall\"\ngravity = 0.0\n[beads]\ncount = 1\n[drive]\namplitude = 0.0\n[time]\n"
                  "stepping = \"steps\"\n[contact]\n{}",
                  dimension, 4 * kImpactDistance, 4 * kImpactDistance, depth, contact),
      "impacts");
}

namespace {

/// \param reading if empty, the reading of the laws
std::vector<Outcome> solve(const std::vector<Impact>& impacts, const Scene& scene,
                           std::optional<SlipReading> reading) {
  constexpr double kPatience = 20, kTolerance = 1e-12;
  const Plan plan = make_plan(scene);
  std::vector<Outcome> all;
  for (const Impact& impact : impacts) {
    const Bodies bodies(scene, impact.wall);
    const CollisionSetting setting = bodies.setting(plan);
    const bool history = remembers(*setting.laws);
    if (!history && (reading || !integrable_alone(*setting.laws)))
      throw RunError("the exact outcome of impacts is not available for these laws.");
    const double patience = kPatience * collision_time(setting, impact.v_n);
    const RelativeMotion touch = bodies.at_touch(impact);
    const CollisionEnd end =
        history ? integrate_collision_with_memory(setting, touch, 0, patience,
                                                  reading.value_or(reading_of(*setting.laws)))
                : integrate_collision(setting, touch, 0, patience, kTolerance);
    if (!end.parted)
      throw RunError(fmt::format("beads that meet at {:.3g} do not part within {} contact times.", impact.v_n,
                                 kPatience));
    all.push_back(bodies.outcome(end.motion.r, end.motion.u, -end.motion.s.y()));
    all.back().duration = end.time;
  }
  return all;
}

}  // namespace

std::vector<Outcome> exact_outcomes(const std::vector<Impact>& impacts, const Scene& scene) {
  return solve(impacts, scene, std::nullopt);
}
std::vector<Outcome> exact_outcomes(const std::vector<Impact>& impacts, const Scene& scene,
                                    SlipReading reading) {
  return solve(impacts, scene, reading);
}

std::vector<std::vector<Outcome>> outcomes_by_steps(const std::vector<Impact>& impacts, Scene scene,
                                                    const StepSetting& setting, int phases) {
  const auto total = static_cast<int>(impacts.size()) * phases;
  scene.integrator = setting.integrator;
  scene.steps_per_contact = setting.n;
  scene.width = kImpactDistance * (total + 1);
  scene.stepping = Stepping::steps;
  const Plan plan = make_plan(scene);
  System system = make_system(scene, plan);
  // The plan rounds the step so that frames are at whole steps; here the exact step is studied.
  system.dt = plan.shortest().time / setting.n;
  // Placement: one impact per place, so many steps before first touch that no pair is in contact at the
  // start.
  double longest = 0;
  for (int k = 0; k < total; ++k) {
    const Impact& impact = impacts[static_cast<std::size_t>(k / phases)];
    const Bodies bodies(scene, impact.wall);
    const RelativeMotion touch = bodies.at_touch(impact);
    const double before = (kRunUp + (k % phases + 0.5) / phases) * system.dt;
    const Vec3 r = touch.r - before * touch.u;
    const double x = kImpactDistance * (k + 1), y = scene.dimension == 3 ? kImpactDistance / 2 : 0;
    const double share = impact.wall ? 1 : 0.5, spin = impact.rim / (impact.wall ? 1 : 2) / bodies.radius;
    const auto add = [&](double side, double height) {
      system.beads.push_back({.x = x + side * r.x(),
                              .z = height + side * r.z(),
                              .vx = side * touch.u.x(),
                              .vz = side * touch.u.z(),
                              .spin = spin,
                              .radius = bodies.radius,
                              .mass = bodies.mass,
                              .inertia = bodies.inertia,
                              .y = y});
    };
    add(share, impact.wall ? 0 : 2 * kImpactDistance);
    if (!impact.wall) add(-share, 2 * kImpactDistance);
    longest = std::max(longest, collision_time(bodies.setting(plan), impact.v_n));
  }
  const auto kernel = make_solver(plan, {});
  kernel->advance(system, static_cast<std::int64_t>(std::ceil(kRunUp + 1.2 * longest / system.dt)) + 8);
  // Outcomes after all impacts have ended.
  std::vector<std::vector<Outcome>> all(impacts.size());
  std::size_t b = 0;
  for (int k = 0; k < total; ++k) {
    const auto which = static_cast<std::size_t>(k / phases);
    const Bodies bodies(scene, impacts[which].wall);
    const Bead& i = system.beads[b++];
    Vec3 r(i.x, 0, i.z), u(i.vx, 0, i.vz);
    double rim = bodies.radius * i.spin;
    if (!bodies.wall) {
      const Bead& j = system.beads[b++];
      r -= Vec3(j.x, 0, j.z), u -= Vec3(j.vx, 0, j.vz);
      rim += bodies.radius * j.spin;
    }
    if (bodies.wall ? r.z() < bodies.radius : r.norm() < 2 * bodies.radius)
      throw RunError("the bodies of an impact have not parted.");
    if (!bodies.wall) {
      // The normal at parting, not after the following steps.
      const double along = r.dot(u), beyond = r.squaredNorm() - 4 * bodies.radius * bodies.radius;
      r -= beyond / (along + std::sqrt(std::max(0.0, along * along - u.squaredNorm() * beyond))) * u;
    }
    all[which].push_back(bodies.outcome(r, u, rim));
  }
  return all;
}

ImpactErrors impact_errors(const std::vector<Impact>& impacts, const std::vector<Outcome>& exact,
                           const Scene& scene, const StepSetting& setting, int phases) {
  const auto measured = outcomes_by_steps(impacts, scene, setting, phases);
  std::vector<double> e, v_t, spin;
  double change = 0;
  for (std::size_t k = 0; k < impacts.size(); ++k) {
    const Impact& impact = impacts[k];
    for (const Outcome& o : measured[k]) {
      e.push_back((o.v_n - exact[k].v_n) / impact.v_n);
      v_t.push_back((o.v_t - exact[k].v_t) / impact.speed());
      spin.push_back(scene.radius * (o.spin - exact[k].spin) / impact.speed());
    }
    const double before = impact.rim / (impact.wall ? 1 : 2);
    change += std::pow((scene.radius * exact[k].spin - before) / impact.speed(), 2);
  }
  return {EntryPhaseSpread::of(e, 0), EntryPhaseSpread::of(v_t, 0), EntryPhaseSpread::of(spin, 0),
          std::sqrt(change / static_cast<double>(impacts.size()))};
}
ImpactErrors impact_errors(const std::vector<Impact>& impacts, const Scene& scene, const StepSetting& setting,
                           int phases) {
  return impact_errors(impacts, exact_outcomes(impacts, scene), scene, setting, phases);
}

EqualImpacts equal_impacts(const std::vector<Impact>& impacts, const Scene& scene, const std::string& slow,
                           const std::string& fast, double share, int phases) {
  constexpr double kMinStepsPerContact = 6.37, kMaxStepsPerContact = 1e5, kMaxRatio = 1.02;
  const std::vector<Outcome> exact = exact_outcomes(impacts, scene);
  const auto errors = [&](const StepSetting& s) { return impact_errors(impacts, exact, scene, s, phases); };
  // Errors decrease with n apart from scatter: n is doubled until it passes, then bisected by geometric
  // means.
  const auto fewest = [&](const std::string& integrator, const auto& passes) {
    StepSetting setting{.integrator = integrator, .n = kMinStepsPerContact};
    while (!passes(errors(setting))) {
      setting.n *= 2;
      if (setting.n > kMaxStepsPerContact)
        throw RunError(integrator + " does not reach the required accuracy.");
    }
    double low = setting.n / 2;
    while (setting.n > kMinStepsPerContact && setting.n / low > kMaxRatio) {
      StepSetting between = setting;
      between.n = std::sqrt(low * setting.n);
      passes(errors(between)) ? setting.n = between.n : low = between.n;
    }
    return setting;
  };
  EqualImpacts equal;
  equal.slow = fewest(slow, [&](const ImpactErrors& e) { return e.spin.rms <= share * e.spin_change; });
  equal.slow_errors = errors(equal.slow);
  equal.fast = fewest(fast, [&](const ImpactErrors& e) {
    return e.restitution.rms <= equal.slow_errors.restitution.rms &&
           e.tangential.rms <= equal.slow_errors.tangential.rms && e.spin.rms <= equal.slow_errors.spin.rms;
  });
  equal.fast_errors = errors(equal.fast);
  return equal;
}

std::vector<Impact> impacts_of_a_bed(double gamma, int count) {
  constexpr double kMinSpeed = 0.01, kSteps = 20.37;  // sqrt(g sigma); per contact
  // Steps between checks: less than half a contact, so that no contact is missed.
  constexpr std::int64_t kStepsBetweenLooks = 8;
  Scene scene = read_scene_text(
      fmt::format("preset = \"fortini-huang-2015\"\n[beads]\ncount = 400\n[drive]\ngamma = {}\n", gamma),
      "bed of impacts");
  scene.integrator = "split";
  scene.steps_per_contact = kSteps;
  scene.stepping = Stepping::steps;
  const Plan plan = make_plan(scene);
  System system = make_system(scene, plan);
  system.beads = make_start(scene).beads;
  for (Bead& b : system.beads) b.vz = scene.drive.peak_velocity();
  // Two periods of transient; the third is observed. New pairs among the contacts are impacts.
  const auto kernel = make_solver(plan, {});
  kernel->advance(system, 2 * plan.steps_per_period);
  std::vector<Impact> all;
  std::set<std::pair<std::int32_t, std::int32_t>> before;
  std::vector<Bead> beads;
  Vec3 plate_velocity = Vec3::Zero();
  for (std::int64_t done = 0; done < plan.steps_per_period; done += kStepsBetweenLooks) {
    std::set<std::pair<std::int32_t, std::int32_t>> now;
    for (const ContactMemory& c : kernel->contacts()) now.emplace(c.i, c.j);
    for (const auto& pair : now) {
      if (done == 0 || before.contains(pair)) continue;
      const Bead& i = beads[static_cast<std::size_t>(pair.first)];
      Vec3 n, u(i.vx, 0, i.vz);
      double rim = i.radius * i.spin;
      if (pair.second < 0) {
        const Wall& wall = system.walls.at(static_cast<std::size_t>(-1 - pair.second));
        n = wall.n;
        if (wall.moves) u -= plate_velocity;
      } else {
        const Bead& j = beads[static_cast<std::size_t>(pair.second)];
        n = Vec3(i.x - j.x, 0, i.z - j.z).normalized();
        u -= Vec3(j.vx, 0, j.vz);
        rim += j.radius * j.spin;
      }
      const Impact impact{pair.second < 0, -u.dot(n), -n.z() * u.x() + n.x() * u.z(), rim};
      if (impact.v_n > 0.1 * kMinSpeed && impact.speed() > kMinSpeed) all.push_back(impact);
    }
    before = std::move(now);
    beads = system.beads;
    plate_velocity = system.plate_velocity_in_space();
    kernel->advance(system, kStepsBetweenLooks);
  }
  if (all.empty()) throw RunError("the bed has no impacts.");
  // The fixed seed gives the same impacts in every call.
  std::mt19937_64 random(1);
  std::vector<Impact> drawn;
  for (int k = 0; k < count; ++k) drawn.push_back(all[random() % all.size()]);
  return drawn;
}

}  // namespace twincell::sim
