#include "sim/lammps/export_lammps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <sstream>
#include <variant>
#include <vector>

#include "core/provenance.hpp"
#include "sim/laws/cell_laws.hpp"
#include "sim/laws/lammps_contact.hpp"
#include "sim/laws/law_words.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/start/start.hpp"

namespace twincell::sim {

namespace {

/// Flat walls perpendicular to one axis, at their positions for the mean position of the plate.
struct FlatWalls {
  std::string name;
  Axis axis;
  std::optional<double> lower, upper;
  bool move;  ///< with the plate
  LammpsContact law;
};

struct DeckBead {
  Vec3 position, velocity, spin;
  double radius, mass;
  bool tracer;
};

/// The content of a scene that LAMMPS can represent. The functions after beads_at_start() use only this, not
/// the simulator.
struct Model {
  int dimension = 2;
  std::array<std::string, 3> boundary;  ///< LAMMPS's words, for each of our axes
  Vec3 lower, upper;                    ///< corners of LAMMPS's box, which grows where there are no walls
  LammpsContact bead;
  std::vector<FlatWalls> walls;
  Vec3 gravity;
  double skin = 0.2;
  bool disc = true, rotation = true;
  Drive drive;
  double width = 0, dt = 0;
  std::int64_t steps_per_period = 1, discard = 0, cycles = 1, first_step = 0;
  int phases = 1;
  std::vector<DeckBead> beads;
  std::string resolved;  ///< the scene's TOML
};

[[noreturn]] void refuse(const Scene& scene, const std::string& key, const std::string& why) {
  throw ConfigError(scene.where(key), why);
}

/// Converts contact laws. \param table the table of the scene with the keys for this kind of contact
LammpsContact lammps_contact(const ContactLaws& laws, double m_eff, const Scene& scene,
                             const std::string& table) {
  LammpsContact contact;
  const auto write = [&](const char* axis, const auto& laws_of_axis) {
    std::visit(
        [&]<class Law>(const Law& law) {
          if constexpr (InLammps<Law>)
            law.write_lammps(contact, m_eff);
          else
            refuse(scene, std::string("contact.") + axis,
                   fmt::format("LAMMPS's gran/hooke styles do not support the law '{}'.", law.kName));
        },
        laws_of_axis);
  };
  write("normal", laws.normal);
  write("tangential", laws.tangential);
  write("rolling", laws.rolling);
  if (contact.history && contact.k_t == 0)
    refuse(scene, table + ".k_t",
           "LAMMPS's history style divides by it; set 0 for all contacts or for none.");
  constexpr double kMaxFriction = 1e4;  // LAMMPS stops at a larger xmu
  if (contact.mu > kMaxFriction)
    refuse(scene, table + ".mu", fmt::format("{:g} exceeds LAMMPS's limit, {:g}.", contact.mu, kMaxFriction));
  return contact;
}

/// The walls of a plan. Opposite walls with the same law share one fix, which then visits each bead only
/// once.
std::vector<FlatWalls> flat_walls(const Scene& scene, const Plan& plan) {
  const std::map<std::string, std::string> table = {
      {"left", "sides"}, {"right", "sides"}, {"front", "plates"}, {"back", "plates"}};
  std::vector<FlatWalls> all;
  for (std::size_t w = 0; w < plan.walls.size(); ++w) {
    const Wall& wall = plan.walls[w];
    int axis = 0;
    wall.n.cwiseAbs().maxCoeff(&axis);
    if (std::abs(wall.n[axis]) != 1)
      refuse(scene, "cell.side_tilt", "LAMMPS's fix wall/gran supports only walls along the axes.");
    const auto known = table.find(wall.name);
    const LammpsContact law = lammps_contact(plan.laws->walls[w], scene.mass, scene,
                                             "contact." + (known == table.end() ? wall.name : known->second));
    const double at = wall.n[axis] * wall.offset;
    const bool lower = wall.n[axis] > 0;
    // A fix has one history per bead: in a narrow gap the history would pass from one wall to the other.
    const auto opposite = std::find_if(all.begin(), all.end(), [&](const FlatWalls& o) {
      return o.axis == static_cast<Axis>(axis) && o.move == wall.moves && o.law == law && !lower &&
             !o.upper && o.lower && at - *o.lower > 4 * scene.radius;
    });
    if (opposite != all.end()) {
      opposite->upper = at;
      opposite->name += "_" + wall.name;
    } else {
      all.push_back({wall.name, static_cast<Axis>(axis), lower ? std::optional(at) : std::nullopt,
                     lower ? std::nullopt : std::optional(at), wall.moves, law});
    }
  }
  return all;
}

/// LAMMPS's damping coefficients are rates, the same for all masses; damping constants and restitutions
/// require equal masses.
void refuse_different_masses(const Scene& scene, const Model& m) {
  if (m.bead.for_all_masses &&
      std::all_of(m.walls.begin(), m.walls.end(), [](const FlatWalls& w) { return w.law.for_all_masses; }))
    return;
  refuse(
      scene, "contact",
      "beads of unequal masses need their damping as rates, gamma_n and gamma_t: LAMMPS has one rate for all "
      "of them.");
}

/// A model without its beads.
Model model_of(const Scene& scene, const Plan& plan) {
  // Features without an equivalent in LAMMPS.
  if (!integrator_named(scene.integrator).lammps)
    refuse(scene, "time.integrator",
           fmt::format("LAMMPS integrates as \"verlet\", not as \"{}\".", scene.integrator));
  if (!scene.envelope.points.empty()) refuse(scene, "drive", "LAMMPS's walls have no ramp and no schedule.");
  if (scene.drive.recorded) refuse(scene, "drive.file", "LAMMPS's walls move as a sine, not as a record.");
  if (!scene.drive.harmonics.empty())
    refuse(scene, "drive.harmonics", "LAMMPS's walls move as a sine, without harmonics.");
  if (scene.drive.ramp) refuse(scene, "drive.ramp", "LAMMPS's walls move as a sine that does not change.");
  if (scene.drive.horizontal) refuse(scene, "drive.horizontal", "LAMMPS's walls move along one axis.");
  if (scene.plate_drag > 0) refuse(scene, "cell.plate_drag", "LAMMPS has no drag against a moving cell.");
  Model m;
  m.dimension = plan.dimension;
  m.bead = lammps_contact(plan.laws->bead, scene.mass / 2, scene, "contact");
  m.walls = flat_walls(scene, plan);
  if (scene.spread != SizeSpread::none || scene.intruder) refuse_different_masses(scene, m);
  m.gravity = scene.gravity;
  m.skin = 0.4 * scene.radius;
  m.disc = scene.inertia_factor == 0.5;
  m.rotation = plan.rotation;
  m.drive = scene.drive;
  m.width = scene.width;
  m.dt = plan.dt;
  m.steps_per_period = plan.steps_per_period;
  m.discard = scene.discard;
  m.cycles = scene.cycles;
  m.phases = scene.phases;
  m.resolved = scene.resolved;

  // With walls the box is fixed and includes their stroke; elsewhere it grows with the bed.
  m.lower = Vec3(0, plan.dimension == 3 ? 0 : -scene.radius, 0);
  m.upper = Vec3(scene.width, plan.dimension == 3 ? scene.depth : scene.radius, scene.height.value_or(0));
  const std::array<double, 3> period = scene.period();
  for (int k = 0; k < 3; ++k) {
    std::string& word = m.boundary[static_cast<std::size_t>(k)];
    if (period[static_cast<std::size_t>(k)] > 0 || (k == 1 && plan.dimension == 2)) {
      word = "p";
      continue;
    }
    const auto has = [&](bool lower) {
      return std::any_of(m.walls.begin(), m.walls.end(), [&](const FlatWalls& w) {
        return w.axis == static_cast<Axis>(k) && (lower ? w.lower : w.upper).has_value();
      });
    };
    word = std::string(has(true) ? "f" : "m") + (has(false) ? "f" : "m");
    if (static_cast<Axis>(k) == m.drive.axis) {
      m.lower[k] -= m.drive.amplitude;
      m.upper[k] += m.drive.amplitude;
    }
  }

  // Limits of LAMMPS: the quarter period of `wiggle`, and the number of steps of a run.
  if (m.drive.amplitude > 0 && m.steps_per_period % 4 != 0)
    refuse(scene, "time.phases",
           fmt::format("the cycle's {} steps are not divisible by 4, as the shift of LAMMPS's cosine to our "
                       "sine requires; make the phases, {}, a multiple of 4.",
                       m.steps_per_period, m.phases));
  constexpr std::int64_t kLongestRun = 2'000'000'000;  // steps; LAMMPS counts those of a run in 32 bits
  if (m.steps_per_period > kLongestRun / (m.discard + m.cycles))
    refuse(scene, "time.cycles",
           fmt::format("{} cycles of {} steps exceed the {:.0e} steps that LAMMPS can do in a run.",
                       m.discard + m.cycles, m.steps_per_period, static_cast<double>(kLongestRun)));
  return m;
}

std::vector<DeckBead> beads_of_frame(const Scene& scene, const TrajectoryInfo& info, const Frame& frame,
                                     bool rotation, const std::string& name) {
  if (!info.columns.velocity) refuse(scene, "", name + " has no velocities, which a run needs to continue.");
  if (rotation && !info.columns.spin)
    refuse(scene, "", name + " has no spins, but in this scene friction rotates beads.");
  if (info.box.dimension != scene.dimension)
    refuse(scene, "cell.dimension",
           fmt::format("{}, but {} has {}.", scene.dimension, name, info.box.dimension));
  const bool equal = scene.spread == SizeSpread::none && !scene.intruder && !start_row(scene.start).from_file;
  const Vec3 corner(info.box.lower.x(), scene.dimension == 3 ? info.box.lower.y() : 0, 0);
  std::vector<DeckBead> beads;
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    if (!frame.present(i)) continue;
    if (equal && !info.radius.empty() && info.radius[i] != scene.radius)
      refuse(scene, "beads.radius",
             fmt::format("{:g}, but bead {} of {} has {:g}.", scene.radius, i, name, info.radius[i]));
    beads.push_back(
        {frame.position[i] - corner, frame.velocity[i], frame.spin.empty() ? Vec3(0, 0, 0) : frame.spin[i],
         info.radius.empty() ? scene.radius : info.radius[i], info.mass.empty() ? scene.mass : info.mass[i],
         !info.tracer.empty() && info.tracer[i] != 0});
  }
  if (const std::size_t announced = scene.n_beads.value_or(0) + (scene.intruder ? 1 : 0);
      scene.n_beads && announced != beads.size())
    refuse(scene, "beads.count",
           fmt::format("{} beads were specified, but {} contains {}.", announced, name, beads.size()));
  return beads;
}

/// The bed at the start of the drive.
std::vector<DeckBead> beads_at_start(const Simulation& settled) {
  System system = settled.system();
  begin_drive(settled.scene(), settled.plan(), system);
  const TrajectoryInfo info = settled.trajectory_info();
  std::vector<DeckBead> beads;
  for (const Bead& b : system.beads)
    beads.push_back({Vec3(b.x, b.y, b.z), Vec3(b.vx, b.vy, b.vz), Vec3(b.spin_x, -b.spin, b.spin_z), b.radius,
                     b.mass, info.tracer.at(beads.size()) != 0});
  return beads;
}

/// Converts a vector to LAMMPS's axes. LAMMPS requires the plane of a 2D system to be (x, y), so our z is its
/// y and our y is its -z.
Vec3 to_lammps(const Model& m, const Vec3& v) {
  return m.dimension == 2 ? Vec3(v.x(), v.z(), -v.y()) : v;
}

char axis_name(const Model& m, Axis axis) {
  return m.dimension == 2 ? (axis == Axis::z ? 'y' : 'x') : "xyz"[static_cast<int>(axis)];
}

std::string triple(const Vec3& v) {
  // The addition of 0.0 converts -0 to 0.
  return fmt::format("{} {} {}", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
}

std::string data_text(const Model& m) {
  const Vec3 a = to_lammps(m, m.lower), b = to_lammps(m, m.upper);
  std::string text = fmt::format("Beads for {}. Type 2 marks tracers.\n\n{} atoms\n2 atom types\n",
                                 LammpsDeck::kInputName, m.beads.size());
  for (int k = 0; k < 3; ++k)
    text += fmt::format("{} {} {}lo {}hi\n", std::min(a[k], b[k]), std::max(a[k], b[k]), "xyz"[k], "xyz"[k]);
  text += "\nAtoms # sphere\n\n";
  for (std::size_t i = 0; i < m.beads.size(); ++i) {
    const DeckBead& bead = m.beads[i];
    const double density = bead.mass / (4 * std::numbers::pi / 3 * std::pow(bead.radius, 3));
    text += fmt::format("{} {} {} {} {}\n", i + 1, bead.tracer ? 2 : 1, 2 * bead.radius, density,
                        triple(to_lammps(m, bead.position)));
  }
  text += "\nVelocities\n\n";
  for (std::size_t i = 0; i < m.beads.size(); ++i)
    text += fmt::format("{} {} {}\n", i + 1, triple(to_lammps(m, m.beads[i].velocity)),
                        triple(to_lammps(m, m.beads[i].spin)));
  return text;
}

std::string hooke_words(const LammpsContact& h) {
  return fmt::format("{} {} {} {} {} {}{}", h.k_n, h.k_t, h.gamma_n, h.gamma_t, h.mu, h.friction ? 1 : 0,
                     h.clipped ? " limit_damping" : "");
}

std::string boundary_words(const Model& m) {
  return m.dimension == 2 ? fmt::format("{} {} p", m.boundary[0], m.boundary[2])
                          : fmt::format("{}", fmt::join(m.boundary, " "));
}

/// fix wall/gran of each pair of walls. `wiggle` displaces a wall by A - A cos(omega t) from the position at
/// which it is defined, so the mean position of a wall driven along its normal is A above the defined
/// position.
std::string wall_fixes(const Model& m) {
  std::string text;
  for (const FlatWalls& w : m.walls) {
    const bool driven = w.move && m.drive.amplitude > 0;
    const auto place = [&](const std::optional<double>& at) {
      return at ? fmt::format("{}", *at - (driven && w.axis == m.drive.axis ? m.drive.amplitude : 0))
                : "NULL";
    };
    text += fmt::format("fix             {} all wall/gran {} {} {}plane {} {}", w.name,
                        w.law.history ? "hooke/history" : "hooke", hooke_words(w.law), axis_name(m, w.axis),
                        place(w.lower), place(w.upper));
    if (driven)
      text +=
          fmt::format(" wiggle {} {} {}", axis_name(m, m.drive.axis), m.drive.amplitude, m.drive.period());
    text += "\n";
  }
  return text;
}

std::string import_command(const Model& m) {
  return fmt::format(
      "twincell import dump.lammpstrj -o lammps.h5 --dimension {} --timestep {} --cell-width {} --drive-axis "
      "{} --drive-amplitude {} --drive-omega {} --frames-per-cycle {} --tracer-type 2 --bead-mass 1",
      m.dimension, m.dt, m.width, "xyz"[static_cast<int>(m.drive.axis)], m.drive.amplitude, m.drive.omega,
      m.phases);
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
      "# {}: a scene for LAMMPS; docs/lammps.md lists the features that both programs share.\n"
      "# Reduced units: bead diameter, bead mass, gravity.{}\n"
      "# Then: {}\n\n",
      version_line(), m.dimension == 2 ? " The height is y." : "", import_command(m));
  // Box and beads.
  text += fmt::format(
      "units           lj\n"
      "dimension       {}\n"
      "atom_style      sphere\n"
      "boundary        {}\n"
      "newton          off\n"
      "comm_modify     vel yes\n"
      "read_data       {}\n",
      m.dimension, boundary_words(m), LammpsDeck::kDataName);
  // The exact mass, if all masses are equal; densities give masses only to rounding.
  const double mass = m.beads.front().mass;
  if (std::all_of(m.beads.begin(), m.beads.end(), [&](const DeckBead& b) { return b.mass == mass; }))
    text += fmt::format("set             group all mass {}\n", mass);
  // Contact law of the beads and time step.
  text += fmt::format(
      "\n# k_n k_t gamma_n gamma_t mu; LAMMPS multiplies the rates gamma by m_eff, which at a wall is the "
      "bead's mass.\n"
      "pair_style      gran/{} {}\n"
      "pair_coeff      * *\n"
      "neighbor        {} bin\n"
      "neigh_modify    delay 0 every 1 check yes\n"
      "timestep        {}\n\n",
      m.bead.history ? "hooke/history" : "hooke", hooke_words(m.bead), m.skin, m.dt);
  // Walls, gravity and integration. The step counter is set so that `wiggle` gives the phase of the drive.
  if (m.drive.amplitude > 0)
    text += fmt::format(
        "# wiggle moves a wall by A - A cos(w t), t from the step at which its fix is defined. Defined A "
        "lower and three\n"
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
  // Output and run. Unwrapped coordinates in periodic boxes, so that displacements are differences of
  // positions.
  const bool periods =
      m.boundary[0] == "p" || (m.dimension == 3 && m.boundary[1] == "p") || m.boundary[2] == "p";
  text += fmt::format(
      "dump            frames all custom {} dump.lammpstrj id type radius mass {} vx vy vz omegax omegay "
      "omegaz\n"
      "dump_modify     frames delay {} sort id format float %.17g\n"
      "thermo          {}\n"
      "run             {}\n\n",
      per_phase, periods ? "xu yu zu" : "x y z", m.discard * m.steps_per_period, m.steps_per_period,
      std::max<std::int64_t>(0, (m.discard + m.cycles) * m.steps_per_period - per_phase - m.first_step));
  return text + "# The scene:\n#\n" + commented(m.resolved);
}

LammpsDeck deck_of(Model& m, const Scene& scene) {
  if (m.beads.empty()) refuse(scene, "beads.count", "LAMMPS does not read a system without beads.");
  if (std::any_of(m.beads.begin(), m.beads.end(), [&](const DeckBead& b) { return b.mass != scene.mass; }))
    refuse_different_masses(scene, m);
  if (m.boundary[2] != "p")
    for (const DeckBead& b : m.beads) m.upper.z() = std::max(m.upper.z(), b.position.z() + 2 * b.radius);
  return {input_text(m), data_text(m), import_command(m)};
}

}  // namespace

LammpsDeck lammps_deck(const Scene& scene, Progress& progress) {
  // Unsupported features are refused before the bed settles.
  static_cast<void>(model_of(scene, make_plan(scene)));
  if (scene.in_motion)
    refuse(scene, "start.in_motion",
           "refers to a start in another file; export the frame of that file (--frame).");
  const Simulation start(scene, progress);
  Model m = model_of(scene, start.plan());
  m.first_step = first_step(start.plan(), scene.phase.value_or(0));
  m.beads = beads_at_start(start);
  return deck_of(m, scene);
}

LammpsDeck lammps_deck(const Scene& scene, const TrajectorySource& trajectory, std::size_t index) {
  const Plan announced = make_plan(scene);
  static_cast<void>(model_of(scene, announced));  // refuses unsupported features first
  const TrajectoryInfo& info = trajectory.info();
  if (index >= trajectory.n_frames())
    refuse(scene, "",
           fmt::format("frame {} was requested, but {} has {} frames.", index, trajectory.name(),
                       trajectory.n_frames()));
  Frame frame;
  trajectory.read(index, frame);
  const std::string name = fmt::format("frame {} of {}", index, trajectory.name());
  if (frame.phase < 0 || info.phases_per_cycle <= 0)
    refuse(scene, "", name + " has no drive phase, so the position of its plate is unknown.");
  const std::vector<DeckBead> beads = beads_of_frame(scene, info, frame, announced.rotation, name);
  std::vector<Bead> sizes;  // those of a file set the step, as in `simulate`
  for (const DeckBead& b : beads)
    sizes.push_back({.vx = b.velocity.x(),
                     .vz = b.velocity.z(),
                     .radius = b.radius,
                     .mass = b.mass,
                     .vy = b.velocity.y()});
  const Plan plan = make_plan(scene, sizes);
  Model m = model_of(scene, plan);
  const std::int64_t steps = m.steps_per_period * frame.phase;
  if (steps % info.phases_per_cycle != 0)
    refuse(scene, "time.phases",
           fmt::format("phase {}/{} of {} falls between two of the cycle's {} steps.", frame.phase,
                       info.phases_per_cycle, name, m.steps_per_period));
  m.first_step = steps / info.phases_per_cycle;
  const double phase = static_cast<double>(m.first_step) / static_cast<double>(m.steps_per_period);
  if (const std::string complaint = displaced_wall(scene, info, frame, phase); !complaint.empty())
    refuse(scene, "drive", name + complaint);
  m.beads = beads;
  return deck_of(m, scene);
}

}  // namespace twincell::sim
