#include "sim/accuracy/work_precision.hpp"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/cpu_clock.hpp"
#include "core/error.hpp"
#include "core/median.hpp"
#include "sim/accuracy/impacts.hpp"
#include "sim/laws/cell_laws.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/start/start.hpp"

namespace twincell::sim {

namespace {

// Steps per contact, ascending.
constexpr std::array kSteps = {6.37, 8.37, 10.37, 14.37, 20.37, 30.37, 50.37, 70.37, 100.37, 200.37, 400.37};
constexpr std::array kStepsOfAQuickStudy = {6.37, 10.37, 20.37, 50.37};

const std::string kPaperOne = "preset = \"fortini-huang-2015\"\n";

Scene make_scene(const StepSetting& setting, const std::string& text) {
  Scene scene = read_scene_text(text, "work precision");
  scene.integrator = setting.integrator;
  scene.steps_per_contact = setting.n;
  return scene;
}

/// Table I of the first paper, scaled to another stiffness.
std::string scaled_contact(double k_n) {
  const double gamma = 100 * std::sqrt(k_n / kPaperStiffness);
  return fmt::format("[contact]\nk_n = {}\nk_t = {}\ngamma_n = {}\ngamma_t = {}\n", k_n, k_n / 100, gamma,
                     gamma);
}

/// A scene whose beads and steps the caller controls.
struct Run {
  Scene scene;
  Plan plan;
  System system;
  std::unique_ptr<Solver> kernel;

  explicit Run(Scene given)
      : scene(std::move(given)), plan(make_plan(scene)), system(make_system(scene, plan)) {
    kernel = make_solver(plan, {});
  }
  void add(double x, double z, double vx, double vz) {
    system.beads.push_back({.x = x,
                            .z = z,
                            .vx = vx,
                            .vz = vz,
                            .radius = scene.radius,
                            .mass = scene.mass,
                            .inertia = scene.inertia_factor * scene.mass * scene.radius * scene.radius});
  }
  void advance_time(double time) {
    kernel->advance(system, static_cast<std::int64_t>(std::ceil(time / system.dt)));
  }
  /// 1/m + R^2/I.
  [[nodiscard]] double mobility() const { return (1 + 1 / scene.inertia_factor) / scene.mass; }
};

struct ImpactSpread {
  EntryPhaseSpread restitution, sticking;
};
ImpactSpread compare(const std::vector<double>& e, const std::vector<double>& sticking,
                     const ContactLaws& laws, double m_eff, double inv_m_t) {
  const LinearCollision exact =
      std::get<LinearSpringDashpot>(laws.normal).oscillator({.m_eff = m_eff, .r_eff = 0, .inv_m_t = inv_m_t});
  const auto& friction = std::get<SpringSlider>(laws.tangential);
  return {EntryPhaseSpread::of(e, exact.restitution()),
          EntryPhaseSpread::of(sticking, sticking_ratio(friction.k_t, friction.damping.eta(m_eff), inv_m_t,
                                                        exact.contact_time()))};
}

constexpr double kImpactSpeed = 1e-3;

/// A cell without gravity, for impacts of free beads without slip (mu = 1e9).
std::string impact_cell(double width, double height, double k_n) {
  return kPaperOne +
         fmt::format(
             "[cell]\nwidth = {}\nheight = {}\nlid = \"wall\"\ngravity = 0.0\n[drive]\namplitude = 0.0\n",
             width, height) +
         "[beads]\ncount = 1\n" + scaled_contact(k_n) + "mu = 1e9\n";
}

/// Number of steps after which every impact that began within `gap` steps is over; a contact at the plate
/// lasts sqrt(2) t_c.
std::int64_t impact_steps(double gap, double n) {
  return static_cast<std::int64_t>(std::ceil(gap + 1.6 * n)) + 8;
}
/// Initial gap in steps: no contact at the start, and a different fraction of a step for each k.
double entry_gap(int k, int phases) {
  return 5 + (k + 0.5) / phases;
}

ImpactSpread pair_impacts(const StepSetting& setting, int phases) {
  const int side = static_cast<int>(std::ceil(std::sqrt(phases)));
  Run run(
      make_scene(setting, impact_cell(kImpactDistance * side, kImpactDistance * (side + 1), setting.k_n)));
  const double v = kImpactSpeed;
  for (int k = 0; k < phases; ++k) {
    const int column = k % side, row = k / side;
    const double x = kImpactDistance * (0.5 + column), z = kImpactDistance * (1 + row);
    const double half = run.scene.radius + entry_gap(k, phases) * v * run.system.dt / 2;
    run.add(x - half, z, v / 2, v / 2);
    run.add(x + half, z, -v / 2, -v / 2);
  }
  run.kernel->advance(run.system, impact_steps(6, setting.n));
  std::vector<double> e, sticking;
  for (std::size_t k = 0; k < run.system.beads.size(); k += 2) {
    const Bead &i = run.system.beads[k], &j = run.system.beads[k + 1];
    const double dx = i.x - j.x, dz = i.z - j.z, r = std::hypot(dx, dz), nx = dx / r, nz = dz / r;
    e.push_back(((i.vx - j.vx) * nx + (i.vz - j.vz) * nz) / v);
    sticking.push_back(((i.vz - j.vz) * nx - (i.vx - j.vx) * nz - run.scene.radius * (i.spin + j.spin)) / -v);
  }
  return compare(e, sticking, run.plan.laws->bead, run.scene.mass / 2, 2 * run.mobility());
}

ImpactSpread wall_impacts(const StepSetting& setting, int phases) {
  Run run(make_scene(setting, impact_cell(kImpactDistance * phases, 10, setting.k_n)));
  const double v = kImpactSpeed;
  for (int k = 0; k < phases; ++k)
    run.add(kImpactDistance * (0.5 + k), run.scene.radius + entry_gap(k, phases) * v * run.system.dt, v, -v);
  run.kernel->advance(run.system, impact_steps(6, setting.n));
  std::vector<double> e, sticking;
  for (const Bead& b : run.system.beads) {
    e.push_back(b.vz / v);
    sticking.push_back((b.vx + run.scene.radius * b.spin) / v);
  }
  return compare(e, sticking, run.plan.laws->walls.at(0), run.scene.mass, run.mobility());
}

constexpr double kSettling = 2250;  ///< contact times

/// Contact time of two beads.
double contact_time(const Plan& plan) {
  return std::get<LinearSpringDashpot>(plan.laws->bead.normal)
      .oscillator({.m_eff = 0.5, .r_eff = 0, .inv_m_t = 0})
      .contact_time();
}

/// Sums m <(v_z - v_z,cm)^2> over frames, period by period.
class VerticalTemperature : public TrajectorySink {
 public:
  explicit VerticalTemperature(int phases) : phases_(phases) {}
  void append(const Frame& frame) override {
    double sum = 0, squares = 0;
    for (const Vec3& v : frame.velocity) sum += v.z(), squares += v.z() * v.z();
    const double n = static_cast<double>(frame.velocity.size());
    if (frame.phase == 0) periods_.push_back(0);
    periods_.back() += (squares / n - sum * sum / n / n) / phases_;
  }
  [[nodiscard]] const std::vector<double>& periods() const { return periods_; }

 private:
  int phases_;
  std::vector<double> periods_;
};

/// The driven bed on which steps are timed, with its state at the start of each window.
struct TimedBed {
  double k_n;
  std::vector<std::vector<Bead>> entered;  ///< [window] beads
};
constexpr int kWindows = 5, kPhases = 20;
constexpr double kWindow = 0.01;  ///< of a period

Scene timed_scene(const StepSetting& setting) {
  Scene scene = make_scene(
      setting, kPaperOne + "[beads]\ncount = 400\n[drive]\ngamma = 2.0\n" + scaled_contact(setting.k_n));
  scene.phases = kPhases;
  return scene;
}

TimedBed timed_bed(double k_n) {
  Run run(timed_scene({.integrator = "verlet", .n = 20.37, .k_n = k_n}));
  run.system.beads = make_start(run.scene).beads;
  for (Bead& b : run.system.beads) b.vz = run.scene.drive.peak_velocity();
  const std::int64_t period = run.system.steps_per_period;
  TimedBed bed{k_n, {}};
  for (int w = 0; w < kWindows; ++w) {
    run.kernel->advance(run.system, 2 * period + w * period / kWindows - run.system.step);
    bed.entered.push_back(run.system.beads);
  }
  return bed;
}

/// One setting on its bed.
struct TimedSetting {
  TimedBed bed;
  Run run;

  TimedSetting(const StepSetting& setting, TimedBed given)
      : bed(std::move(given)), run(timed_scene(setting)) {}
  /// Seconds per simulated time.
  double measure() {
    // Short windows are repeated, because of the resolution of the clock.
    constexpr double kMinSteps = 4000;
    const std::int64_t period = run.system.steps_per_period;
    const auto steps = static_cast<std::int64_t>(std::ceil(kWindow * static_cast<double>(period)));
    const auto repeats = static_cast<int>(std::ceil(kMinSteps / static_cast<double>(kWindows * steps)));
    double seconds = 0;
    for (int r = 0; r < repeats; ++r)
      for (int w = 0; w < kWindows; ++w) {
        run.system.beads = bed.entered[static_cast<std::size_t>(w)];
        run.system.forces_known = false;
        run.kernel = make_solver(run.plan, {});  // without the contact memories of the last window
        run.system.step = w * period / kWindows;
        run.kernel->advance(run.system, steps / 2);
        const double begun = thread_cpu_seconds();
        run.kernel->advance(run.system, steps);
        seconds += thread_cpu_seconds() - begun;
      }
    return seconds / (repeats * kWindows * static_cast<double>(steps) * run.system.dt);
  }
};

bool no_worse(const BedErrors& a, const BedErrors& b) {
  return a.kinetic_energy <= std::max(b.kinetic_energy, 1e-12) &&
         a.floor_force <= std::max(b.floor_force, 1e-8) && a.overlap <= std::max(b.overlap, 1e-5);
}

}  // namespace

double CollisionErrors::restitution() const {
  return std::max(restitution_pair.largest, restitution_wall.largest);
}
double CollisionErrors::sticking() const {
  return std::max(sticking_pair.largest, sticking_wall.largest);
}

std::vector<StepSetting> study_settings(bool quick) {
  std::vector<StepSetting> all;
  const auto add = [&](double k_n, const auto& steps) {
    for (const char* integrator : {"verlet", "predicted", "split"})
      for (const double n : steps) all.push_back({.integrator = integrator, .n = n, .k_n = k_n});
  };
  if (quick) {
    add(kPaperStiffness, kStepsOfAQuickStudy);
  } else {
    for (const double k_n : {1e5, kPaperStiffness, 1e7}) add(k_n, kSteps);
  }
  return all;
}

StepSetting longest_study_step() {
  return {.integrator = "verlet", .n = kSteps.front()};
}

CollisionErrors collision_errors(const StepSetting& setting, int phases) {
  const ImpactSpread pair = pair_impacts(setting, phases), wall = wall_impacts(setting, phases);
  return {pair.restitution, wall.restitution, pair.sticking, wall.sticking};
}

std::vector<Impact> bed_impacts() {
  constexpr int kEach = 100;
  std::vector<Impact> all = impacts_of_a_bed(2, kEach), more = impacts_of_a_bed(3, kEach);
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

Scene scaled_impact_scene(double k_n) {
  const std::string contact = scaled_contact(k_n);
  return impact_scene(contact.substr(contact.find('\n') + 1));
}

BedErrors bed_errors(const StepSetting& setting) {
  BedErrors errors;
  Run bed(make_scene(
      setting, kPaperOne + "[cell]\nwidth = 10.0\nsides = \"periodic\"\n[beads]\ncount = 40\n" +
                   "[drive]\namplitude = 0.0\n[start]\nperturbation = 1e-4\n" + scaled_contact(setting.k_n)));
  bed.system.beads = make_start(bed.scene).beads;
  bed.advance_time(kSettling * contact_time(bed.plan));
  errors.kinetic_energy = kinetic_energy_per_bead(bed.system);
  for (int k = 0; k < 10 * setting.n; ++k) {
    bed.kernel->advance(bed.system, 1);
    // Contact forces between beads cancel; the remaining sum is the force of the floor.
    double force = 0, weight = 0;
    for (std::size_t b = 0; b < bed.system.beads.size(); ++b) {
      force += bed.system.forces[b].z;
      weight += bed.system.beads[b].mass * bed.scene.g();
    }
    errors.floor_force = std::max(errors.floor_force, std::abs(force / weight - 1));
  }

  Run column(make_scene(setting, kPaperOne +
                                     "[cell]\nwidth = 10.0\n[beads]\ncount = 1\n[drive]\namplitude = 0.0\n" +
                                     scaled_contact(setting.k_n)));
  constexpr int kBeads = 5;
  for (int i = 0; i < kBeads; ++i) column.add(5, column.scene.radius * (1 + 2 * i), 0, 0);
  column.advance_time(4 * kSettling * contact_time(column.plan));
  for (int i = 0; i < kBeads; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const std::vector<Bead>& b = column.system.beads;
    const double overlap =
        i == 0 ? b[0].radius - b[0].z : b[at].radius + b[at - 1].radius - (b[at].z - b[at - 1].z);
    const double carried = (kBeads - i) * b[at].mass * column.scene.g();
    errors.overlap = std::max(errors.overlap, std::abs(overlap * setting.k_n / carried - 1));
  }
  return errors;
}

double GasTemperature::seconds_to(double relative) const {
  const double times = standard_error / (relative * value);
  return seconds * times * times;
}

GasTemperature gas_temperature(const StepSetting& setting, const GasCase& gas, int periods,
                               Progress& progress) {
  constexpr int kBlocks = 10;
  Scene scene = make_scene(
      setting, fmt::format("preset = \"bhateja-2016-{}\"\n[drive]\nk_m = {}\n[start]\nsettle_limit = 2.0\n"
                           "[contact]\nk_n = {}\n[time]\nstepping = \"{}\"\ndiscard = 50\ncycles = {}\n",
                           gas.system, gas.w, setting.k_n, gas.event_driven ? "event-driven" : "steps",
                           std::max(periods, kBlocks)));
  Simulation run(scene);
  VerticalTemperature frames(scene.phases);
  const double begun = thread_cpu_seconds();
  run.run(frames, progress);
  GasTemperature t{.setting = setting, .gas = gas, .periods = static_cast<int>(frames.periods().size())};
  t.seconds = (thread_cpu_seconds() - begun) * t.periods / (t.periods + static_cast<double>(scene.discard));
  const double scale = scene.drive.peak_velocity() * scene.drive.peak_velocity();
  std::array<double, kBlocks> block{};
  for (int b = 0; b < kBlocks; ++b) {
    const int first = b * t.periods / kBlocks, last = (b + 1) * t.periods / kBlocks;
    for (int p = first; p < last; ++p)
      block[static_cast<std::size_t>(b)] +=
          frames.periods()[static_cast<std::size_t>(p)] / scale / (last - first);
    t.value += block[static_cast<std::size_t>(b)] / kBlocks;
  }
  double squares = 0;
  for (const double b : block) squares += (b - t.value) * (b - t.value);
  t.standard_error = std::sqrt(squares / (kBlocks - 1) / kBlocks);
  return t;
}

std::vector<StepCost> step_costs(const std::vector<StepSetting>& settings, int rounds, Progress& progress) {
  std::vector<TimedBed> beds;
  std::vector<TimedSetting> timed;
  timed.reserve(settings.size());
  const auto total = static_cast<std::int64_t>(settings.size()) * rounds;
  std::int64_t done = 0;
  for (const StepSetting& setting : settings) {
    auto bed =
        std::find_if(beds.begin(), beds.end(), [&](const TimedBed& b) { return b.k_n == setting.k_n; });
    if (bed == beds.end()) {
      progress.update(done, total);
      bed = beds.insert(beds.end(), timed_bed(setting.k_n));
    }
    timed.emplace_back(setting, *bed);
  }
  std::vector<std::vector<double>> seconds(settings.size());
  for (int r = 0; r < rounds; ++r)
    for (std::size_t k = 0; k < timed.size(); ++k) {
      seconds[k].push_back(timed[k].measure());
      progress.update(++done, total);
    }
  std::vector<StepCost> costs;
  for (std::size_t k = 0; k < settings.size(); ++k) {
    const Run& run = timed[k].run;
    costs.push_back({upper_median(seconds[k]) / static_cast<double>(run.system.beads.size()), run.system.dt,
                     contact_time(run.plan)});
  }
  return costs;
}

std::vector<WorkPrecision> work_precision(const std::vector<StepSetting>& settings, int rounds,
                                          Progress& progress) {
  // Progress counts units of similar duration: one for the errors of a setting, one for each of its rounds.
  const auto count = static_cast<std::int64_t>(settings.size()), total = count * (rounds + 1);
  std::vector<WorkPrecision> all;
  const std::vector<Impact> impacts = bed_impacts();
  std::vector<std::pair<double, std::vector<Outcome>>> exact;  // by stiffness
  for (const StepSetting& setting : settings) {
    const Scene scene = scaled_impact_scene(setting.k_n);
    if (exact.empty() || exact.back().first != setting.k_n)
      exact.emplace_back(setting.k_n, exact_outcomes(impacts, scene));
    all.push_back({setting,
                   collision_errors(setting),
                   bed_errors(setting),
                   {},
                   impact_errors(impacts, exact.back().second, scene, setting, kBedPhases)});
    progress.update(static_cast<std::int64_t>(all.size()), total);
  }
  struct After : Progress {
    Progress& whole;
    std::int64_t before, total;
    After(Progress& p, std::int64_t b, std::int64_t t) : whole(p), before(b), total(t) {}
    void update(std::int64_t done, std::int64_t) override { whole.update(before + done, total); }
  } rest(progress, count, total);
  const std::vector<StepCost> costs = step_costs(settings, rounds, rest);
  for (std::size_t k = 0; k < all.size(); ++k) all[k].cost = costs[k];
  return all;
}

std::vector<WorkPrecision> front(const std::vector<WorkPrecision>& all, double k_n) {
  std::vector<WorkPrecision> sorted, kept;
  for (const WorkPrecision& w : all)
    if (w.setting.k_n == k_n) sorted.push_back(w);
  std::sort(sorted.begin(), sorted.end(), [](const WorkPrecision& a, const WorkPrecision& b) {
    return a.cost.seconds_per_time < b.cost.seconds_per_time;
  });
  for (const WorkPrecision& w : sorted)
    if (kept.empty() || w.collision.restitution() < kept.back().collision.restitution()) kept.push_back(w);
  return kept;
}

namespace {

/// The cheapest setting of stiffness k_n that passes, together with every larger n of its integrator.
template <class Kernels>
const WorkPrecision* cheapest_that(const std::vector<WorkPrecision>& all, double k_n, const Kernels& passes) {
  const WorkPrecision* best = nullptr;
  for (const WorkPrecision& w : all) {
    const bool sound =
        w.setting.k_n == k_n && std::all_of(all.begin(), all.end(), [&](const WorkPrecision& o) {
          return o.setting.k_n != k_n || o.setting.integrator != w.setting.integrator ||
                 o.setting.n < w.setting.n || passes(o);
        });
    if (sound && (best == nullptr || w.cost.seconds_per_time < best->cost.seconds_per_time)) best = &w;
  }
  return best;
}

}  // namespace

std::optional<WorkPrecision> cheapest(const std::vector<WorkPrecision>& all, double k_n, double accuracy) {
  const WorkPrecision* best =
      cheapest_that(all, k_n, [&](const WorkPrecision& w) { return w.collision.restitution() <= accuracy; });
  return best == nullptr ? std::nullopt : std::optional(*best);
}

WorkPrecision equal_accuracy(const std::vector<WorkPrecision>& all, const WorkPrecision& reference,
                             bool mean) {
  const auto as_good = [&](const EntryPhaseSpread& a, const EntryPhaseSpread& b) {
    return a.rms <= b.rms && a.largest <= b.largest && (!mean || std::abs(a.mean) <= std::abs(b.mean));
  };
  const CollisionErrors& own = reference.collision;
  const WorkPrecision* best = cheapest_that(all, reference.setting.k_n, [&](const WorkPrecision& w) {
    return w.setting == reference.setting ||
           (as_good(w.collision.restitution_pair, own.restitution_pair) &&
            as_good(w.collision.restitution_wall, own.restitution_wall) &&
            as_good(w.collision.sticking_pair, own.sticking_pair) &&
            as_good(w.collision.sticking_wall, own.sticking_wall) &&
            as_good(w.impacts.restitution, reference.impacts.restitution) &&
            as_good(w.impacts.tangential, reference.impacts.tangential) &&
            as_good(w.impacts.spin, reference.impacts.spin) && no_worse(w.bed, reference.bed));
  });
  return best == nullptr || best->cost.seconds_per_time > reference.cost.seconds_per_time ? reference : *best;
}

}  // namespace twincell::sim
