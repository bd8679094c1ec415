#include "sim/simulation.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace

Simulation::Simulation(Scene scene, Progress& progress, KernelKind kind, int threads)
    : scene_(std::move(scene)), plan_(make_plan(scene_)) {
  Start start = make_start(scene_);
  require_sound(start.beads, scene_, 0.05);
  // High enough never to be reached: the bed, the plate's stroke, twice the ballistic height of the plate's
  // speed, ten diameters.
  const double v = scene_.drive.peak_velocity(), g = scene_.g();
  const double flight = g > 0 ? v * v / g : 0;
  height_ =
      scene_.height.value_or(std::ceil(top_of(start.beads) + 2 * scene_.drive.amplitude + 2 * flight + 10));

  system_ = make_system(scene_, plan_);
  system_.beads = std::move(start.beads);
  GuardLimits limits;
  limits.overlap = overlap_bound(scene_);
  limits.travel_per_step *= 2 * scene_.radius;
  // A height that the scene names without a lid binds; the one we chose merely keeps the box of the file
  // finite.
  limits.ceiling = scene_.lid || scene_.bottom == Edge::periodic ? 0 : scene_.height.value_or(0);
  kernel_ = make_kernel(plan_, limits, kind, threads);
  settle(progress);
  tracer_ = start.tracer.empty() ? choose_tracers(system_.beads, scene_) : std::move(start.tracer);
}

void Simulation::settle(Progress& progress) {
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
}

void Simulation::start_drive() {
  system_.drive = scene_.drive;
  system_.envelope = scene_.envelope;
  system_.step = 0;
  // At phase 0 the plate moves at A omega but does not accelerate: beads moving with it are in equilibrium.
  // Beads at rest would be hit by a plate at full speed, which by itself breaks a crystal.
  if (!scene_.comoving) return;
  const double v = system_.plate_velocity();
  for (Bead& b : system_.beads) {
    if (scene_.drive.axis == Axis::x) b.vx += v;
    if (scene_.drive.axis == Axis::y) b.vy += v;
    if (scene_.drive.axis == Axis::z) b.vz += v;
  }
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
  start_drive();
  const std::int64_t per_phase = plan_.steps_per_period / scene_.phases;
  // A schedule of amplitudes comes before the cycles that are discarded.
  const std::int64_t before =
      static_cast<std::int64_t>(std::ceil(scene_.envelope.duration())) + scene_.discard;
  const std::int64_t total = (before + scene_.cycles) * scene_.phases;
  for (std::int64_t k = 0; k < total; ++k) {
    const std::int64_t cycle = k / scene_.phases - before;
    if (cycle >= 0) sink.append(snapshot(cycle, static_cast<int>(k % scene_.phases)));
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
