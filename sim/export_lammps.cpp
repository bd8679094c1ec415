#include "sim/export_lammps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>
#include <variant>
#include <vector>

#include "analysis/trajectory/provenance.hpp"
#include "sim/plan.hpp"
#include "sim/simulation.hpp"

namespace twincell::sim {

namespace {

/// A kind of contact in the numbers of pair_style gran/hooke: dampings are rates, which LAMMPS multiplies by
/// m_eff.
struct Hooke {
  double k_n = 0, k_t = 0, gamma_n = 0, gamma_t = 0, mu = 0;
  bool history = false, clipped = false;
};

/// Flat walls across one axis, where they are when the plate is at its mean.
struct FlatWalls {
  std::string name;
  Axis axis;
  std::optional<double> lower, upper;
  bool move;  ///< with the plate
};

struct DeckBead {
  Vec3 position, velocity, spin;
  bool tracer;
};

/// A scene as far as LAMMPS has words for it. Nothing below `model_of` knows the simulator.
struct Model {
  int dimension = 2;
  std::array<Boundary, 3> boundary{};
  Vec3 lower, upper;  ///< corners of LAMMPS's box; the top grows where beads fly
  Hooke bead, wall;
  std::vector<FlatWalls> walls;
  Vec3 gravity;
  double radius = 0.5, mass = 1;
  bool disc = true, rotation = true;
  Drive drive;
  double dt = 0;
  std::int64_t steps_per_period = 1, discard = 0, cycles = 1, first_step = 0;
  int phases = 1;
  std::vector<DeckBead> beads;
  std::string resolved;  ///< the scene's TOML
};

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

[[noreturn]] void refuse(const Scene& scene, const std::string& key, const std::string& why) {
  throw ConfigError({scene.file, 0, 0, key}, why);
}

Hooke hooke_of(const Plan::Contact& laws, double m_eff, const Scene& scene, const std::string& table) {
  const auto no_word = [&](const char* key, std::string_view law) {
    refuse(scene, table + "." + key,
           fmt::format("LAMMPS's gran/hooke styles do not know the law '{}'.", law));
  };
  Hooke h;
  const auto spring_dashpot = [&](const LinearSpringDashpot& law) {
    h.k_n = law.stiffness;
    h.gamma_n = law.damping.eta(m_eff) / m_eff;
  };
  std::visit(Overloaded{[&](const LinearSpringDashpot& law) { spring_dashpot(law); },
                        [&](const ClippedSpringDashpot& law) {
                          spring_dashpot(law);
                          h.clipped = true;
                        }},
             laws.normal);
  std::visit(Overloaded{[](const NoTangential&) {},
                        [&](const DashpotSlider& law) {
                          h.gamma_t = law.damping.eta(m_eff) / m_eff;
                          h.mu = law.mu;
                        },
                        [&](const SpringSlider& law) {
                          h.k_t = law.stiffness;
                          h.gamma_t = law.damping.eta(m_eff) / m_eff;
                          h.mu = law.mu;
                          h.history = true;
                        },
                        [&](const SpringOnlySlider& law) { no_word("slip", law.kName); }},
             laws.tangential);
  constexpr double kMostFriction = 1e4;  // LAMMPS stops at a larger xmu
  if (h.mu > kMostFriction)
    refuse(scene, table + ".mu", fmt::format("{:g} is more than LAMMPS takes, {:g}.", h.mu, kMostFriction));
  return h;
}

/// Everything of a model but its beads: the only place that reads scenes and plans.
Model model_of(const Scene& scene) {
  const Plan plan = make_plan(scene);
  Model m;
  m.bead = hooke_of(plan.bead, scene.mass / 2, scene, "contact");
  m.wall = hooke_of(plan.wall, scene.mass, scene, "contact.wall");
  m.boundary = {scene.periodic_sides ? Boundary::periodic : Boundary::wall, Boundary::open, Boundary::wall};
  m.lower = Vec3(0, -scene.radius, -scene.drive.amplitude);
  m.upper = Vec3(scene.width, scene.radius, 0);
  m.walls.push_back({"plate", Axis::z, 0.0, std::nullopt, true});
  if (!scene.periodic_sides) m.walls.push_back({"sides", Axis::x, 0.0, scene.width, scene.side_walls_move});
  const double tilt = scene.tilt * std::numbers::pi / 180;
  m.gravity = scene.gravity * Vec3(std::sin(tilt), 0, -std::cos(tilt));
  m.radius = scene.radius;
  m.mass = scene.mass;
  m.disc = scene.inertia_factor == 0.5;
  m.rotation = plan.rotation;
  m.drive = scene.drive;
  m.dt = plan.dt;
  m.steps_per_period = plan.steps_per_period;
  m.discard = scene.discard;
  m.cycles = scene.cycles;
  m.phases = scene.phases;
  m.resolved = scene.resolved;
  if (m.drive.amplitude > 0 && m.steps_per_period % 4 != 0)
    refuse(
        scene, "time.phases",
        fmt::format("the cycle's {} steps have no whole quarter, by which LAMMPS's cosine is shifted to our "
                    "sine; make the phases, {}, a multiple of 4.",
                    m.steps_per_period, m.phases));
  constexpr std::int64_t kLongestRun = 2'000'000'000;  // steps; LAMMPS counts those of a run in 32 bits
  if (m.steps_per_period > kLongestRun / (m.discard + m.cycles))
    refuse(scene, "time.cycles",
           fmt::format("{} cycles of {} steps are more than the {:.0e} steps that LAMMPS does in a run.",
                       m.discard + m.cycles, m.steps_per_period, static_cast<double>(kLongestRun)));
  return m;
}

/// The bed as the drive finds it.
std::vector<DeckBead> beads_at_start(const Simulation& settled) {
  const Vec3 lift(0, 0, settled.scene().comoving ? settled.scene().drive.peak_velocity() : 0);
  const TrajectoryInfo info = settled.trajectory_info();
  std::vector<DeckBead> beads;
  for (const Bead& b : settled.system().beads)
    beads.push_back({Vec3(b.x, 0, b.z), Vec3(b.vx, 0, b.vz) + lift, Vec3(0, -b.spin, 0),
                     info.tracer.at(beads.size()) != 0});
  return beads;
}

std::vector<DeckBead> beads_of_frame(const Scene& scene, const TrajectoryInfo& info, const Frame& frame,
                                     bool rotation, const std::string& name) {
  if (!info.columns.velocity) refuse(scene, "", name + " has no velocities, from which a run could go on.");
  if (rotation && !info.columns.spin)
    refuse(scene, "", name + " has no spins, but in this scene friction turns beads.");
  std::vector<DeckBead> beads;
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    if (!frame.present(i)) continue;
    if (!info.radius.empty() && info.radius[i] != scene.radius)
      refuse(scene, "beads.radius",
             fmt::format("{:g}, but bead {} of {} has {:g}.", scene.radius, i, name, info.radius[i]));
    beads.push_back({frame.position[i] - Vec3(info.box.lower.x(), 0, 0), frame.velocity[i],
                     frame.spin.empty() ? Vec3(0, 0, 0) : frame.spin[i],
                     !info.tracer.empty() && info.tracer[i] != 0});
  }
  if (scene.n_beads && *scene.n_beads != beads.size())
    refuse(scene, "beads.count",
           fmt::format("{} beads were announced, the frame of {} holds {}.", *scene.n_beads, name,
                       beads.size()));
  return beads;
}

/// Our axes in LAMMPS's: it wants the plane of a 2D system to be (x, y), so there our z is its y and our y
/// its -z.
Vec3 to_lammps(const Model& m, const Vec3& v) {
  return m.dimension == 2 ? Vec3(v.x(), v.z(), -v.y()) : v;
}

char axis_name(const Model& m, Axis axis) {
  return m.dimension == 2 ? (axis == Axis::z ? 'y' : 'x') : "xyz"[static_cast<int>(axis)];
}

std::string triple(const Vec3& v) {
  // + 0.0 makes -0 a plain 0.
  return fmt::format("{} {} {}", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
}

std::string data_text(const Model& m) {
  const Vec3 a = to_lammps(m, m.lower), b = to_lammps(m, m.upper);
  std::string text = fmt::format(
      "Beads for in.twincell. Type 2 marks tracers. Masses are set there, not by these densities.\n\n"
      "{} atoms\n2 atom types\n",
      m.beads.size());
  for (int k = 0; k < 3; ++k)
    text += fmt::format("{} {} {}lo {}hi\n", std::min(a[k], b[k]), std::max(a[k], b[k]), "xyz"[k], "xyz"[k]);
  text += "\nAtoms # sphere\n\n";
  for (std::size_t i = 0; i < m.beads.size(); ++i)
    text += fmt::format("{} {} {} 1 {}\n", i + 1, m.beads[i].tracer ? 2 : 1, 2 * m.radius,
                        triple(to_lammps(m, m.beads[i].position)));
  text += "\nVelocities\n\n";
  for (std::size_t i = 0; i < m.beads.size(); ++i)
    text += fmt::format("{} {} {}\n", i + 1, triple(to_lammps(m, m.beads[i].velocity)),
                        triple(to_lammps(m, m.beads[i].spin)));
  return text;
}

std::string hooke_words(const Hooke& h, bool friction) {
  return fmt::format("{} {} {} {} {} {}{}", h.k_n, h.k_t, h.gamma_n, h.gamma_t, h.mu, friction ? 1 : 0,
                     h.clipped ? " limit_damping" : "");
}

std::string boundary_words(const Model& m) {
  const auto word = [&](Axis axis) {
    if (m.boundary[static_cast<std::size_t>(axis)] == Boundary::periodic) return "p";
    return axis == Axis::z ? "fm" : "f";
  };
  return m.dimension == 2 ? fmt::format("{} {} p", word(Axis::x), word(Axis::z))
                          : fmt::format("{} {} {}", word(Axis::x), word(Axis::y), word(Axis::z));
}

/// fix wall/gran of each pair of walls. `wiggle` displaces a wall by A - A cos(omega t) from where it is
/// defined, so the mean of a wall that is driven along its normal lies A above that.
std::string wall_fixes(const Model& m) {
  const char axis_up = axis_name(m, m.drive.axis);
  std::string text;
  for (const FlatWalls& w : m.walls) {
    const bool driven = w.move && m.drive.amplitude > 0;
    const auto place = [&](const std::optional<double>& at) {
      return at ? fmt::format("{}", *at - (driven && w.axis == m.drive.axis ? m.drive.amplitude : 0))
                : "NULL";
    };
    text += fmt::format("fix             {} all wall/gran {} {} {}plane {} {}", w.name,
                        m.bead.history ? "hooke/history" : "hooke", hooke_words(m.wall, m.rotation),
                        axis_name(m, w.axis), place(w.lower), place(w.upper));
    if (driven) text += fmt::format(" wiggle {} {} {}", axis_up, m.drive.amplitude, m.drive.period());
    text += "\n";
  }
  return text;
}

std::string import_command(const Model& m) {
  return fmt::format(
      "twincell import dump.lammpstrj -o lammps.h5 --dimension {} --timestep {} --drive-amplitude {} "
      "--drive-omega {} --frames-per-cycle {} --tracer-type 2",
      m.dimension, m.dt, m.drive.amplitude, m.drive.omega, m.phases);
}

std::string commented(const std::string& text) {
  std::istringstream lines(text);
  std::string out;
  for (std::string line; std::getline(lines, line);) out += line.empty() ? "#\n" : "# " + line + "\n";
  return out;
}

std::string input_text(const Model& m) {
  const std::int64_t per_phase = m.steps_per_period / m.phases;
  std::string text = fmt::format(
      "# {}: a scene for LAMMPS; docs/lammps.md says what is the same in both programs.\n"
      "# Reduced units: bead diameter, bead mass, gravity.{}\n"
      "# Then: {}\n\n",
      version_line(), m.dimension == 2 ? " The height is y." : "", import_command(m));
  text += fmt::format(
      "units           lj\n"
      "dimension       {}\n"
      "atom_style      sphere\n"
      "boundary        {}\n"
      "newton          off\n"
      "comm_modify     vel yes\n"
      "read_data       {}\n"
      "set             group all mass {}\n\n",
      m.dimension, boundary_words(m), LammpsDeck::kDataName, m.mass);
  text += fmt::format(
      "# k_n k_t gamma_n gamma_t mu; LAMMPS multiplies the rates gamma by m_eff, which at a wall is the "
      "bead's "
      "mass.\n"
      "pair_style      gran/{} {}\n"
      "pair_coeff      * *\n"
      "neighbor        {} bin\n"
      "neigh_modify    delay 0 every 1 check yes\n"
      "timestep        {}\n\n",
      m.bead.history ? "hooke/history" : "hooke", hooke_words(m.bead, m.rotation), 0.4 * m.radius, m.dt);
  if (m.drive.amplitude > 0)
    text += fmt::format(
        "# wiggle moves a wall by A - A cos(w t), t from the step at which its fix is defined. Defined A "
        "lower "
        "and three\n"
        "# quarters of a period after phase 0, it is at A sin(w t), t from phase 0.\n"
        "reset_timestep  {}\n",
        3 * m.steps_per_period / 4);
  text += wall_fixes(m);
  text += fmt::format("reset_timestep  {}\n", m.first_step);
  if (m.gravity.norm() > 0)
    text += fmt::format("fix             weight all gravity {} vector {}\n", m.gravity.norm(),
                        triple(to_lammps(m, m.gravity)));
  text += fmt::format("fix             motion all {}\n\n", !m.rotation ? "nve"
                                                           : m.disc    ? "nve/sphere disc"
                                                                       : "nve/sphere");
  // Unwrapped where there are periods, so that displacements are differences.
  const bool periods =
      m.boundary[0] == Boundary::periodic || (m.dimension == 3 && m.boundary[1] == Boundary::periodic);
  text += fmt::format(
      "dump            frames all custom {} dump.lammpstrj id type radius {} vx vy vz omegax omegay omegaz\n"
      "dump_modify     frames delay {} sort id format float %.17g\n"
      "thermo          {}\n"
      "run             {}\n\n",
      per_phase, periods ? "xu yu zu" : "x y z", m.first_step + m.discard * m.steps_per_period,
      m.steps_per_period, (m.discard + m.cycles) * m.steps_per_period - per_phase);
  return text + "# The scene:\n#\n" + commented(m.resolved);
}

LammpsDeck deck_of(Model& m, const Scene& scene) {
  if (m.beads.empty()) refuse(scene, "beads.count", "LAMMPS does not read a system without beads.");
  for (const DeckBead& b : m.beads) m.upper.z() = std::max(m.upper.z(), b.position.z() + 2 * m.radius);
  return {input_text(m), data_text(m), import_command(m)};
}

}  // namespace

LammpsDeck lammps_deck(const Scene& scene, Progress& progress) {
  Model m = model_of(scene);
  m.beads = beads_at_start(Simulation(scene, progress));
  return deck_of(m, scene);
}

LammpsDeck lammps_deck(const Scene& scene, const TrajectorySource& trajectory, std::size_t index) {
  Model m = model_of(scene);
  const TrajectoryInfo& info = trajectory.info();
  if (index >= trajectory.n_frames())
    refuse(
        scene, "",
        fmt::format("frame {} was asked for, {} has {}.", index, trajectory.name(), trajectory.n_frames()));
  Frame frame;
  trajectory.read(index, frame);
  const std::string name = fmt::format("frame {} of {}", index, trajectory.name());
  if (frame.phase < 0 || info.phases_per_cycle <= 0)
    refuse(scene, "", name + " has no drive phase, so the plate's place in it is unknown.");
  const std::int64_t steps = m.steps_per_period * frame.phase;
  if (steps % info.phases_per_cycle != 0)
    refuse(scene, "time.phases",
           fmt::format("phase {}/{} of {} falls between two of the cycle's {} steps.", frame.phase,
                       info.phases_per_cycle, name, m.steps_per_period));
  m.first_step = steps / info.phases_per_cycle;
  constexpr double kSamePlate = 1e-9;
  const double ours =
      m.drive.displacement(static_cast<double>(m.first_step) / static_cast<double>(m.steps_per_period));
  if (!std::isnan(frame.plate_height) && std::abs(frame.plate_height - ours) > kSamePlate)
    refuse(scene, "drive",
           fmt::format("the plate of {} is at {:g}, this drive puts it at {:g}.", name, frame.plate_height,
                       ours));
  m.beads = beads_of_frame(scene, info, frame, m.rotation, name);
  return deck_of(m, scene);
}

}  // namespace twincell::sim
