#include "sim/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/trajectory/error.hpp"
#include "sim/cell_grid.hpp"

namespace twincell::sim {

namespace {

double kinetic_energy_per_bead(const System& s) {
  double sum = 0;
  for (const Bead& b : s.beads)
    sum += 0.5 * (b.mass * (b.vx * b.vx + b.vy * b.vy + b.vz * b.vz) +
                  b.inertia * (b.spin_x * b.spin_x + b.spin * b.spin + b.spin_z * b.spin_z));
  return s.beads.empty() ? 0 : sum / static_cast<double>(s.beads.size());
}

double top_of(const std::vector<Bead>& beads) {
  double top = 0;
  for (const Bead& b : beads) top = std::max(top, b.z + b.radius);
  return top;
}

bool touches(const System& s, const Bead& b, const Wall& wall) {
  return wall.n.dot(centre_of(b)) - offset_now(s, wall) < b.radius;
}

std::int64_t beads_in_contact(const System& s) {
  std::vector<char> touching(s.beads.size(), 0);
  for_each_near_pair(s.beads, s.dimension, s.period, 0,
                     [&](std::int32_t i, std::int32_t j, double, const Vec3&) {
                       touching[static_cast<std::size_t>(i)] = touching[static_cast<std::size_t>(j)] = 1;
                     });
  for (const Wall& wall : s.walls)
    for (std::size_t i = 0; i < s.beads.size(); ++i)
      if (touches(s, s.beads[i], wall)) touching[i] = 1;
  return std::count(touching.begin(), touching.end(), 1);
}

/// Largest speed at which a moving wall and a bead that touches it differ.
double largest_kick(const System& s) {
  const Vec3 plate = s.plate_velocity() * Vec3::Unit(static_cast<int>(s.drive.axis));
  double kick = 0;
  for (const Wall& wall : s.walls)
    for (const Bead& b : s.beads)
      if (wall.moves && touches(s, b, wall)) kick = std::max(kick, (Vec3(b.vx, b.vy, b.vz) - plate).norm());
  return kick;
}

}  // namespace

Simulation::Simulation(Scene scene, Progress& progress, KernelKind kind, int threads)
    : scene_(std::move(scene)), plan_(make_plan(scene_)) {
  Start start = make_start(scene_);
  require_sound(start.beads, scene_, 0.05);
  plan_ = make_plan(scene_, start.beads);  // a file's beads may be lighter than the scene's
  // High enough never to be reached: the bed, the plate's stroke, twice the ballistic height of the plate's
  // speed, ten diameters.
  const double v = scene_.drive.peak_velocity(), g = scene_.g();
  const double flight = g > 0 ? v * v / g : 0;
  height_ =
      scene_.height.value_or(std::ceil(top_of(start.beads) + 2 * scene_.drive.amplitude + 2 * flight + 10));

  system_ = make_system(scene_, plan_);
  system_.beads = std::move(start.beads);
  GuardLimits limits = guard_limits(plan_);
  // A height that the scene names without a lid binds; the one we chose merely keeps the box of the file
  // finite.
  limits.ceiling = scene_.lid || scene_.bottom == Edge::periodic ? 0 : scene_.height.value_or(0);
  kernel_ = make_kernel(plan_, limits, kind, threads);
  try {
    check_motion(system_, limits);
  } catch (const RunError& e) {  // before the first step it is the start that is wrong
    throw ConfigError({scene_.file, 0, 0, "start"}, e.what());
  }
  settle(progress);
  tracer_ = start.tracer.empty() ? choose_tracers(system_.beads, scene_) : std::move(start.tracer);
}

void Simulation::settle(Progress& progress) try {
  system_.drive.amplitude = 0;  // the plate rests at its mean
  if (system_.beads.empty() || scene_.g() == 0 || scene_.settle_limit == 0) return;
  // Rest must last: the energy is looked at every ten contact times.
  const auto block = static_cast<std::int64_t>(10 * scene_.steps_per_contact);
  const auto most = static_cast<std::int64_t>(scene_.settle_limit / system_.dt);
  int quiet = 0;
  while (system_.step < most && quiet < 2) {
    kernel_->advance(system_, block);
    settled_.energy_per_bead = kinetic_energy_per_bead(system_);
    quiet = settled_.energy_per_bead < scene_.rest_energy ? quiet + 1 : 0;
    progress.update(std::min(system_.step, most), most);
  }
  settled_.time = system_.time();
  settled_.reached = quiet >= 2;
} catch (const RunError& e) {
  throw RunError(std::string("While the bed settled, ") + e.what());
}

std::vector<std::string> Simulation::warnings() const {
  std::vector<std::string> all = plan_.warnings;
  if (!settled_.reached && scene_.g() > 0 && scene_.settle_limit > 0 && !system_.beads.empty())
    all.push_back(
        fmt::format("the bed still moved at {:.3g} m g sigma a bead when start.settle_limit = {:g} ended its "
                    "settling.",
                    settled_.energy_per_bead, scene_.settle_limit));
  if (steps_done_ > 0) return all;
  System at_start = system_;
  start_drive(at_start);
  constexpr double kGentle = 0.01;
  if (const double kick = largest_kick(at_start); kick > kGentle)
    all.push_back(
        fmt::format("the drive starts with a blow: a bead at rest on a wall meets it at {:.3g} sigma/t0; "
                    "drive.start = \"comoving\" or \"ramp\" avoids it.",
                    kick));
  return all;
}

void Simulation::start_drive(System& system) const {
  system.drive = scene_.drive;
  system.envelope = scene_.envelope;
  system.step = 0;
  // At phase 0 the plate moves at A omega but does not accelerate: beads moving with it are in equilibrium.
  // Beads at rest would be hit by a plate at full speed, which by itself breaks a crystal.
  if (!scene_.comoving) return;
  const double v = system.plate_velocity();
  for (Bead& b : system.beads) {
    if (scene_.drive.axis == Axis::x) b.vx += v;
    if (scene_.drive.axis == Axis::y) b.vy += v;
    if (scene_.drive.axis == Axis::z) b.vz += v;
  }
}

std::optional<double> Simulation::contact_fraction() const {
  if (looked_at_ == 0) return std::nullopt;
  return static_cast<double>(touching_) / static_cast<double>(looked_at_);
}

TrajectoryInfo Simulation::trajectory_info() const {
  TrajectoryInfo info;
  info.n_beads = system_.beads.size();
  info.columns = {
      .velocity = true, .spin = plan_.rotation, .identity = false, .phase = true, .plate_height = true};
  const auto boundary = [](Edge e) {
    return e == Edge::periodic ? Boundary::periodic : e == Edge::wall ? Boundary::wall : Boundary::open;
  };
  info.box.dimension = scene_.dimension;
  info.box.lower = Vec3(0, 0, 0);
  info.box.upper = Vec3(scene_.width, scene_.dimension == 3 ? scene_.depth : 2 * scene_.radius, height_);
  info.box.boundary = {boundary(scene_.sides),
                       scene_.dimension == 3 ? boundary(scene_.plates) : Boundary::open,
                       boundary(scene_.bottom)};
  info.drive = scene_.drive;
  info.phases_per_cycle = scene_.phases;
  info.scale = scene_.scale;
  info.source = "simulation";
  for (const Bead& b : system_.beads) {
    info.radius.push_back(b.radius);
    info.mass.push_back(b.mass);
  }
  info.tracer = tracer_;
  return info;
}

Frame Simulation::snapshot(std::int64_t cycle, int phase) const {
  Frame frame;
  frame.step = system_.step;
  frame.time = system_.time();
  frame.cycle = cycle;
  frame.phase = phase;
  frame.plate_height = system_.plate_height();
  for (const Bead& b : system_.beads) {
    frame.position.emplace_back(b.x, b.y, b.z);
    frame.velocity.emplace_back(b.vx, b.vy, b.vz);
    if (plan_.rotation) frame.spin.emplace_back(b.spin_x, -b.spin, b.spin_z);
  }
  return frame;
}

void Simulation::run(TrajectorySink& sink, Progress& progress) {
  start_drive(system_);
  const std::int64_t per_phase = plan_.steps_per_period / scene_.phases;
  // A schedule of amplitudes comes before the cycles that are discarded.
  const std::int64_t before =
      static_cast<std::int64_t>(std::ceil(scene_.envelope.duration())) + scene_.discard;
  const std::int64_t total = (before + scene_.cycles) * scene_.phases;
  for (std::int64_t k = 0; k < total; ++k) {
    const std::int64_t cycle = k / scene_.phases - before;
    if (cycle >= 0) {
      sink.append(snapshot(cycle, static_cast<int>(k % scene_.phases)));
      touching_ += beads_in_contact(system_);
      looked_at_ += static_cast<std::int64_t>(system_.beads.size());
    }
    progress.update(k, total);
    // In pieces of about a tenth of a second at most, so that a signal is noticed.
    for (std::int64_t done = 0; done < per_phase;) {
      const std::int64_t piece = std::min<std::int64_t>(
          per_phase - done, 1 + 2'000'000 / (1 + static_cast<std::int64_t>(system_.beads.size())));
      kernel_->advance(system_, piece);
      done += piece;
      steps_done_ += piece;
      progress.update(k, total);
    }
  }
  progress.update(total, total);
}

}  // namespace twincell::sim
