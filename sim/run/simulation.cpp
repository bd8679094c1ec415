#include "sim/run/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/plate_motion.hpp"
#include "sim/scene/resource_demand.hpp"
#include "sim/system/cell_grid.hpp"
#include "trajectory/bed_forces.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "trajectory/temperature.hpp"

namespace twincell::sim {

namespace {

/// Contacts as files store them, so that an analysis in memory has the numbers of one of the file.
std::vector<ContactForce> in_single_precision(std::vector<ContactForce> all) {
  const auto stored = [](double v) { return static_cast<double>(static_cast<float>(v)); };
  for (ContactForce& c : all) {
    c.overlap = stored(c.overlap);
    c.normal = c.normal.unaryExpr(stored);
    c.normal_force = stored(c.normal_force);
    c.tangential_force = c.tangential_force.unaryExpr(stored);
  }
  return all;
}

double top_of(const std::vector<Bead>& beads) {
  double top = 0;
  for (const Bead& b : beads) top = std::max(top, b.z + b.radius);
  return top;
}

bool touches(const System& s, const Bead& b, const Wall& wall) {
  return wall.n.dot(centre_of(b)) - offset_now(s, wall) < b.radius;
}

std::int64_t beads_in_contact(const System& s, Progress& progress) {
  CancellationCheck check(progress);
  std::vector<char> touching(s.beads.size(), 0);
  for_each_near_pair(s.beads, s.dimension, s.period, 0,
                     [&](std::int32_t i, std::int32_t j, double, const Vec3&) {
                       check();
                       touching[static_cast<std::size_t>(i)] = touching[static_cast<std::size_t>(j)] = 1;
                     });
  for (const Wall& wall : s.walls)
    for (std::size_t i = 0; i < s.beads.size(); ++i)
      if (touches(s, s.beads[i], wall)) touching[i] = 1;
  return std::count(touching.begin(), touching.end(), 1);
}

/// The contact memories of a start in motion, if this plan can read them.
/// \throws ConfigError if other laws or another integrator wrote them
std::vector<ContactMemory> readable(const Scene& scene, const Plan& plan,
                                    std::vector<ContactMemory> contacts) {
  const std::size_t wanted = remembered_numbers(plan);
  for (const ContactMemory& c : contacts) {
    if (c.values.size() != wanted)
      throw ConfigError(scene.where("start.in_motion"),
                        fmt::format("{}: its contacts store {} values, but this scene's laws and integrator "
                                    "(\"{}\") store {}; select those that wrote the file, or write it with "
                                    "time.springs = false.",
                                    scene.from.string(), c.values.size(), scene.integrator, wanted));
    if (-1 - c.j >= static_cast<std::int64_t>(plan.walls.size()))
      throw ConfigError(scene.where("start.in_motion"),
                        fmt::format("{}: bead {} touches wall {}, this cell has {} walls.",
                                    scene.from.string(), c.i, -1 - c.j, plan.walls.size()));
  }
  return contacts;
}

/// Steps per cycle of the run whose frame a start in motion continues with its contact springs; absent if the
/// start is another one.
std::optional<double> steps_per_cycle_of_file(const Scene& scene) {
  if (scene.start != StartKind::trajectory) return std::nullopt;
  const H5mdReader file(scene.from);
  if (file.info().source != Origin::simulation || !file.info().columns.contacts || !file.info().drive)
    return std::nullopt;
  Frame frame;
  file.read(scene.frame, frame);
  if (frame.step <= 0 || !(frame.time > 0)) return std::nullopt;
  return file.info().drive->period() * static_cast<double>(frame.step) / frame.time;
}

/// Largest speed at which the start of the drive makes a moving wall meet a bead that touches it.
/// \param before the same beads above walls at rest; their own motion, as in a bed that still falls, does not
///     count
double largest_kick(const System& s, const std::vector<Bead>& before) {
  const Vec3 plate = s.plate_velocity_in_space();
  double kick = 0;
  for (const Wall& wall : s.walls)
    for (std::size_t i = 0; i < s.beads.size(); ++i) {
      const Bead &b = s.beads[i], &old = before[i];
      if (wall.moves && touches(s, b, wall))
        kick = std::max(kick, (Vec3(b.vx - old.vx, b.vy - old.vy, b.vz - old.vz) - plate).norm());
    }
  return kick;
}

}  // namespace

namespace {
/// The step, above `from` and at most `to`, at which the forces of pair `pair` of the samples after frame
/// `frame` are taken: at a random place that follows from these numbers alone. At fixed phases of the drive,
/// contacts that last less than the time between samples would be hit or missed in every cycle alike.
std::int64_t force_step(std::int64_t frame, std::int64_t pair, std::int64_t from, std::int64_t to) {
  std::uint64_t h =
      0x9E3779B97F4A7C15u * static_cast<std::uint64_t>(frame) + static_cast<std::uint64_t>(pair);
  h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9u;  // splitmix64
  h = (h ^ (h >> 27)) * 0x94D049BB133111EBu;
  h ^= h >> 31;
  return from + 1 + static_cast<std::int64_t>(h % static_cast<std::uint64_t>(to - from));
}
}  // namespace

std::int64_t steps_per_call(std::size_t beads) {
  // A call packs the beads and unpacks them again, and builds the inner list where it cannot go on from the
  // last call. A list lives for about 64 steps, so calls of that length cost little more than one long call.
  constexpr std::int64_t kListLife = 64;
  return std::max(kListLife, 1 + 2'000'000 / (1 + static_cast<std::int64_t>(beads)));
}

double kinetic_energy_per_bead(const System& s) {
  double sum = 0;
  for (const Bead& b : s.beads)
    sum += 0.5 * (b.mass * (b.vx * b.vx + b.vy * b.vy + b.vz * b.vz) +
                  b.inertia * (b.spin_x * b.spin_x + b.spin * b.spin + b.spin_z * b.spin_z));
  return s.beads.empty() ? 0 : sum / static_cast<double>(s.beads.size());
}

namespace {
/// Refuses a run that begins after the last frame of its only cycle.
void require_frames(const Scene& scene, const Plan& plan, double phase) {
  if (plan.cycles_before > 0 || scene.cycles > 1 ||
      first_step(plan, phase) * scene.phases <= (scene.phases - 1) * plan.steps_per_period)
    return;
  throw ConfigError(
      scene.where("time.cycles"),
      fmt::format("records no frame: the run begins at phase {:g} of its only cycle, after the last of its "
                  "{} frames; at least 2 cycles.",
                  phase, scene.phases));
}
}  // namespace

RunState placed(const Scene& scene, Progress& progress) {
  // An impossible run is refused before ten million beads are placed.
  const Plan plan = make_plan(scene);
  require_memory(scene, plan, scene.n_beads.value_or(0));
  require_frames(scene, plan, scene.phase.value_or(0));
  Start start = make_start(scene, progress);
  const double phase = start.phase.value_or(scene.phase.value_or(0));
  const Vec3 plate = scene.in_motion ? cell_displacement(scene, phase) : Vec3::Zero();
  require_sound(start.beads, scene, 0.05, progress, plate);
  require_frames(scene, plan, phase);
  RunState state;
  // High enough never to be reached: top of the bed, stroke of the plate, twice the ballistic height at the
  // peak plate velocity, ten diameters.
  const double v = scene.drive.velocity_bound(), g = scene.g();
  const double flight = g > 0 ? v * v / g : 0;
  state.height = scene.height.value_or(
      std::ceil(top_of(start.beads) + 2 * scene.drive.displacement_bound() + 2 * flight + 10));
  state.beads = std::move(start.beads);
  state.tracer = std::move(start.tracer);
  if (!scene.in_motion) return state;
  state.driven = true;
  // The beads of a file, not those of the scene, set the number of steps of the run's cycles.
  const Plan of_run = make_plan(scene, state.beads);
  state.step = first_step(of_run, phase);
  state.contacts = readable(scene, of_run, std::move(start.contacts));
  state.forces = std::move(start.forces);
  state.rim_speeds = std::move(start.rim_speeds);
  if (state.tracer.empty()) state.tracer = choose_tracers(state.beads, scene);
  return state;
}

std::int64_t first_step(const Plan& plan, double phase) {
  return std::llround(phase * static_cast<double>(plan.steps_per_period)) % plan.steps_per_period;
}

void begin_drive(const Scene& scene, const Plan& plan, System& system) {
  system.drive = scene.drive;
  system.envelope = scene.envelope;
  system.step = first_step(plan, scene.phase.value_or(0));
  if (const Vec3 shift = system.plate_displacement(); system.step > 0 || shift != Vec3::Zero()) {
    // The bed rests on the plate at the position of this phase.
    for (Bead& b : system.beads) b.x += shift.x(), b.y += shift.y(), b.z += shift.z();
    system.forces_known = false;
  }
  // At phase 0 a sine moves at A omega but does not accelerate: beads that move with it are in
  // equilibrium. Beads at rest would be hit by a plate at full speed, which alone breaks a crystal.
  if (!scene.comoving) return;
  const Vec3 v = system.plate_velocity_in_space();
  for (Bead& b : system.beads) b.vx += v.x(), b.vy += v.y(), b.vz += v.z();
}

Simulation::Simulation(Scene scene, RunState state, SolverKind kind, int threads)
    : scene_(std::move(scene)),
      plan_(make_plan(scene_, state.beads)),  // beads of a file may be lighter than those of the scene
      system_(make_system(scene_, plan_)),
      tracer_(std::move(state.tracer)),
      height_(state.height),
      driven_(state.driven),
      quiet_(state.quiet),
      settled_(state.settled),
      looked_at_(state.looked_at),
      touching_(state.touching),
      temperature_(state.temperature),
      forces_sum_(std::move(state.forces_sum)) {
  GuardLimits limits = guard_limits(plan_);
  // A height that the scene sets without a lid is a limit; a height chosen by the program only keeps the box
  // of the file finite.
  limits.ceiling = scene_.lid || scene_.bottom == Edge::periodic ? 0 : scene_.height.value_or(0);
  solver_ = make_solver(plan_, limits, kind, threads);
  solver_->restore(std::move(state.contacts));
  if (driven_)
    system_.envelope = scene_.envelope;
  else
    system_.drive = scene_.drive.at_rest();
  system_.step = state.step;
  system_.beads = std::move(state.beads);
  for (const Bead& b : system_.beads) masses_.push_back(b.mass);
  system_.forces_known = !state.forces.empty();
  system_.forces = std::move(state.forces);
  system_.rim_speeds = std::move(state.rim_speeds);
  solver_->recall(system_, state.solver);
  if (driven_ || system_.step > 0) return;
  try {
    check_motion(system_, limits);
  } catch (const RunError& e) {  // before the first step only the start can be wrong
    throw ConfigError(scene_.where("start"), e.what());
  }
}

Simulation::Simulation(const Scene& scene, Progress& progress, SolverKind kind, int threads)
    : Simulation(scene, placed(scene, progress), kind, threads) {
  settle(progress);
}

void Simulation::settle(Progress& progress, StageTimes* times) try {
  if (driven_) return;
  // Two consecutive checks must find the bed at rest; the energy is checked every ten contact times.
  constexpr int kLooks = 2;
  const auto block = static_cast<std::int64_t>(10 * scene_.steps_per_contact);
  const bool falls = !system_.beads.empty() && scene_.g() > 0;
  const auto most = falls ? static_cast<std::int64_t>(scene_.settle_limit / system_.dt) : 0;
  while (system_.step / block * block < most && quiet_ < kLooks) {
    advance(
        {std::min(block - system_.step % block, steps_per_call(system_.beads.size()))}, [] {}, times,
        "settling");
    if (system_.step % block == 0) {
      settled_.energy_per_bead = kinetic_energy_per_bead(system_);
      quiet_ = settled_.energy_per_bead < scene_.rest_energy ? quiet_ + 1 : 0;
      settled_.time = system_.time();
      settled_.reached = quiet_ >= kLooks;
    }
    progress.update(std::min(system_.step, most), most);
  }
  if (tracer_.empty()) tracer_ = choose_tracers(system_.beads, scene_);
} catch (const RunError& e) {
  throw RunError(std::string("While the bed settled, ") + e.what());
}

std::vector<std::string> Simulation::warnings() const {
  std::vector<std::string> all = plan_.warnings;
  if (!settled_.reached && !scene_.in_motion && scene_.g() > 0 && scene_.settle_limit > 0 &&
      !system_.beads.empty())
    all.push_back(
        fmt::format("the bed still had a kinetic energy of {:.3g} m g sigma per bead when "
                    "start.settle_limit = {:g} ended its settling.",
                    settled_.energy_per_bead, scene_.settle_limit));
  if (driven_ && scene_.in_motion && plan_.history && steps_done_ == 0 && solver_->contacts().empty() &&
      beads_in_contact(system_, Progress::none()) > 0)
    all.push_back(
        "the start in motion contains no contact springs (simulate --contacts, time.springs), so the "
        "spring of every contact starts unstretched.");
  if (driven_ && scene_.in_motion && steps_done_ == 0)
    if (const auto before = steps_per_cycle_of_file(scene_)) {
      constexpr double kRounding = 1e-9;
      const auto now = static_cast<double>(plan_.steps_per_period);
      if (std::abs(*before / now - 1) > kRounding)
        all.push_back(fmt::format(
            "the run that wrote {} took {:.0f} steps per cycle, this one takes {:.0f}: it continues "
            "with a different error of the step, not bit for bit (time.steps_per_contact).",
            scene_.from.string(), *before, now));
    }
  if (driven_) return all;
  System at_start = system_;
  begin_drive(scene_, plan_, at_start);
  constexpr double kGentle = 0.01;
  if (const double kick = largest_kick(at_start, system_.beads); kick > kGentle)
    all.push_back(
        fmt::format("the drive starts abruptly: a bead at rest on a wall meets it at {:.3g} sigma/t0; "
                    "drive.start = \"comoving\" or \"ramp\" avoids it.",
                    kick));
  return all;
}

RunState Simulation::state() const {
  RunState state;
  state.driven = driven_;
  state.step = system_.step;
  state.quiet = quiet_;
  state.settled = settled_;
  state.height = height_;
  state.beads = system_.beads;
  if (system_.forces_known) state.forces = system_.forces;
  state.rim_speeds = system_.rim_speeds;
  state.contacts = solver_->contacts();
  state.solver = solver_->memory();
  state.tracer = tracer_;
  state.looked_at = looked_at_;
  state.touching = touching_;
  state.temperature = temperature_;
  state.forces_sum = forces_sum_;
  return state;
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
  info.columns.time_mean = samples_per_phase() > 0;
  info.columns.contacts = plan_.stores_memory;
  info.columns.contact_forces = scene_.contacts;
  info.columns.force_mean = scene_.contacts && info.columns.time_mean;
  if (scene_.contacts)
    for (const Wall& wall : system_.walls) info.walls.push_back(wall.name);
  info.samples_per_cycle = static_cast<int>(samples_per_phase()) * scene_.phases;
  const auto boundary = [](Edge e) {
    return e == Edge::periodic ? Boundary::periodic : e == Edge::wall ? Boundary::wall : Boundary::open;
  };
  info.box.dimension = scene_.dimension;
  info.box.lower = Vec3(0, 0, 0);
  info.box.upper = Vec3(scene_.width, scene_.dimension == 3 ? scene_.depth : 2 * scene_.radius, height_);
  info.box.boundary = {boundary(scene_.sides),
                       scene_.dimension == 3 ? boundary(scene_.plates) : Boundary::open,
                       boundary(scene_.bottom)};
  info.box.side_tilt = {scene_.left_tilt, scene_.right_tilt};
  info.drive = scene_.drive;
  info.phases_per_cycle = scene_.phases;
  info.scale = scene_.scale;
  info.conditions = conditions_of(scene_, system_.beads.size());
  info.source = Origin::simulation;
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
  frame.plate_height = plate_follows_drive(scene_) ? system_.plate_height() : 0;
  for (const Bead& b : system_.beads) {
    frame.position.emplace_back(b.x, b.y, b.z);
    frame.velocity.emplace_back(b.vx, b.vy, b.vz);
    if (plan_.rotation) frame.spin.emplace_back(b.spin_x, -b.spin, b.spin_z);
  }
  if (plan_.stores_memory) {
    frame.contacts = solver_->contacts();
    const Vec3 unknown = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    const std::size_t n = system_.beads.size();
    const bool known = system_.forces_known && system_.forces.size() == n;
    for (std::size_t i = 0; i < n; ++i) {
      frame.force.push_back(known ? Vec3(system_.forces[i].x, system_.forces[i].y, system_.forces[i].z)
                                  : unknown);
      // With the signs of the spin above: Force::q turns Bead::spin, and its other components, backwards.
      frame.moment.push_back(known ? Vec3(-system_.forces[i].q_x, system_.forces[i].q, -system_.forces[i].q_z)
                                   : unknown);
      frame.rim_speed.push_back(system_.rim_speeds.size() == n ? system_.rim_speeds[i] : unknown);
    }
  }
  if (scene_.contacts)
    frame.contact_forces = in_single_precision(contact_forces(plan_, system_, solver_->contacts()));
  const std::int64_t index = frame_at(system_.step);
  if (index > 0 && temperature_.steps == step_of(index) - step_of(index - 1)) {
    const auto steps = static_cast<double>(temperature_.steps);
    frame.time_mean = {temperature_.all / steps, temperature_.coarse / steps};
    if (forces_sum_.known()) {
      frame.force_mean = BedForces::zero(system_.walls.size());
      frame.force_mean.add(forces_sum_, 1 / steps);
    }
  }
  return frame;
}

std::int64_t Simulation::step_of(std::int64_t frame) const {
  if (!system_.changes_frequency()) return frame * (plan_.steps_per_period / scene_.phases);
  return system_.step_at(static_cast<double>(frame) / scene_.phases);
}

std::int64_t Simulation::frame_at(std::int64_t step) const {
  if (!system_.changes_frequency()) return step / (plan_.steps_per_period / scene_.phases);
  const double cycles = system_.drive.cycles_at(static_cast<double>(step) * system_.dt);
  auto frame = static_cast<std::int64_t>(cycles * scene_.phases);
  while (step_of(frame + 1) <= step) ++frame;
  while (frame > 0 && step_of(frame) > step) --frame;
  return frame;
}

std::int64_t Simulation::samples_per_phase() const {
  constexpr int kOfABedThatLands = 400;
  const int samples = scene_.samples.value_or(plan_.event_driven ? 2 * scene_.phases : kOfABedThatLands);
  // The shortest interval between frames, which is that of the highest frequency.
  std::int64_t shortest = plan_.steps_per_period / scene_.phases;
  if (scene_.drive.ramp && scene_.drive.ramp->to.omega > scene_.drive.omega)
    shortest = static_cast<std::int64_t>(static_cast<double>(shortest) * scene_.drive.omega /
                                         scene_.drive.ramp->to.omega) -
               1;
  if (samples == 0 || shortest < 2) return 0;
  const std::int64_t pairs = (samples + 2 * scene_.phases - 1) / (2 * scene_.phases);
  return 2 * std::min(pairs, shortest / 2);
}

std::int64_t Simulation::sample_at(std::int64_t j, std::int64_t interval) const {
  const std::int64_t samples = samples_per_phase();
  return (j * interval + samples - 1) / samples;
}

void Simulation::advance(const std::vector<std::int64_t>& pieces, const std::function<void()>& after,
                         StageTimes* times, std::string_view stage) {
  const auto go = [&] {
    // A device computes all pieces before the first call of `after`, but a sample of the forces needs the
    // springs of its own instant.
    if (!scene_.contacts) return solver_->advance_in_pieces(system_, pieces, after);
    for (const std::int64_t steps : pieces) solver_->advance_in_pieces(system_, {steps}, after);
  };
  if (times == nullptr) return go();
  Stage stepping(times, stage, "particle-steps");
  const double before = solver_->counters().bytes;
  const std::int64_t begin = system_.step;
  go();
  stepping.count(static_cast<double>(system_.beads.size()) * static_cast<double>(system_.step - begin),
                 solver_->counters().bytes - before);
}

BedForces Simulation::forces_now() {
  sampled_.position.clear();
  sampled_.velocity.clear();
  for (const Bead& b : system_.beads) {
    sampled_.position.push_back(centre_of(b));
    sampled_.velocity.emplace_back(b.vx, b.vy, b.vz);
  }
  sampled_.contact_forces = contact_forces(plan_, system_, solver_->contacts(), near_);
  return bed_forces(sampled_, of_samples_);
}

void Simulation::take_sample(std::int64_t j, std::int64_t interval) {
  sampled_.velocity.clear();
  for (const Bead& b : system_.beads) sampled_.velocity.emplace_back(b.vx, b.vy, b.vz);
  const Vec3 t = temperature_components(sampled_, masses_);
  const std::int64_t at = sample_at(j, interval), before = sample_at(j - 1, interval);
  temperature_.all += static_cast<double>(at - before) * t;
  if (j % 2 == 0) temperature_.coarse += static_cast<double>(at - sample_at(j - 2, interval)) * t;
  temperature_.steps += at - before;
}

void Simulation::run(TrajectorySink& sink, Progress& progress, std::int64_t most, StageTimes* times) {
  settle(progress, times);
  if (!driven_) begin_drive(scene_, plan_, system_);
  driven_ = true;
  if (scene_.contacts) of_samples_ = trajectory_info();
  const std::int64_t samples = samples_per_phase(), last = plan_.steps;
  std::int64_t handed_over = 0;
  while (system_.step < last) {
    const std::int64_t frame = frame_at(system_.step), into = system_.step - step_of(frame);
    const std::int64_t interval = step_of(frame + 1) - step_of(frame);
    const std::int64_t cycle = frame / scene_.phases - plan_.cycles_before;
    if (into == 0 && cycle >= 0) {
      if (handed_over == most) return;
      ++handed_over;
      // May throw, so it comes before any change of state.
      Stage taking(times, "frames", "frames");
      taking.count(1);
      const std::int64_t touching = beads_in_contact(system_, progress);
      const Frame now = snapshot(cycle, static_cast<int>(frame % scene_.phases));
      {
        Stage writing(times, "writing", "frames");
        writing.count(1);
        sink.append(now);
      }
      touching_ += touching;
      looked_at_ += static_cast<std::int64_t>(system_.beads.size());
    }
    if (into == 0) temperature_ = {}, forces_sum_ = {};
    const std::int64_t end = into + std::min(interval - into, steps_per_call(system_.beads.size()));
    // Samples are taken only in the interval before a frame that is written.
    const bool sampling = samples > 0 && (frame + 1) / scene_.phases >= plan_.cycles_before;
    std::int64_t next = sampling ? into * samples / interval + 1 : 0;
    // Forces cost much more than velocities: one sample for two of these.
    const bool of_forces = sampling && scene_.contacts;
    const auto force_at = [&](std::int64_t pair) {
      return force_step(frame, pair, sample_at(2 * pair - 2, interval), sample_at(2 * pair, interval));
    };
    std::int64_t next_pair = std::max<std::int64_t>(1, next / 2);
    while (of_forces && 2 * next_pair <= samples && force_at(next_pair) <= into) ++next_pair;
    std::vector<std::int64_t> pieces;
    if (sampling)
      for (std::int64_t at = into, k = next, pair = next_pair; at < end;) {
        const bool more = of_forces && 2 * pair <= samples;
        const std::int64_t sample = sample_at(k, interval), force = more ? force_at(pair) : end,
                           stop = std::min({end, sample, force});
        pieces.push_back(stop - at);
        if (stop == sample) ++k;
        if (more && stop == force) ++pair;
        at = stop;
      }
    else
      pieces.push_back(end - into);
    const std::int64_t begin = system_.step - into;
    advance(
        pieces,
        [&] {
          const std::int64_t at = system_.step - begin;
          if (sampling && at == sample_at(next, interval)) {
            Stage sample(times, "samples", "samples");
            take_sample(next++, interval);
            sample.count(1);
          }
          if (of_forces && 2 * next_pair <= samples && at == force_at(next_pair)) {
            Stage sample(times, "forces", "samples");
            if (!forces_sum_.known()) forces_sum_ = BedForces::zero(system_.walls.size());
            const std::int64_t weight =
                sample_at(2 * next_pair, interval) - sample_at(2 * next_pair - 2, interval);
            forces_sum_.add(forces_now(), static_cast<double>(weight));
            sample.count(1);
            ++next_pair;
          }
        },
        times, "stepping");
    steps_done_ += end - into;
    progress.update(system_.step, last);
  }
}

}  // namespace twincell::sim
