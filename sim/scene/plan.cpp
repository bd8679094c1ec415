#include "sim/scene/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "sim/kernels/kernels.hpp"
#include "sim/scene/drive_tables.hpp"
#include "sim/scene/recorded_drive.hpp"

namespace twincell::sim {

namespace {

template <class Axis>
std::string name_of(const Axis& law) {
  return std::visit([](const auto& l) { return std::string(l.kName); }, law);
}

double mu_of(const ContactTable& t) {
  return t.number("mu", 0, 1e12).value_or(0.6);
}
double k_t_of(const ContactTable& t) {
  return t.number("k_t", 0, 1e12).value_or(1e4);
}

/// Whether the named tangential law reads its stiffness from k_t.
bool reads_k_t(const std::string& tangential) {
  const std::vector<std::string> readers = readers_of("k_t").laws;
  return std::find(readers.begin(), readers.end(), tangential) != readers.end();
}
/// "k_t = 10000", or a note that the stiffness follows the overlap.
std::string stiffness_text(const ContactChoice& contact) {
  return reads_k_t(contact.tangential) ? fmt::format("k_t = {:g}", k_t_of(contact.bead))
                                       : "stiffness from the overlap";
}

/// The laws of the plan, by their words: those of the scene, reduced to what has an influence.
struct Chosen {
  std::string normal, tangential, rolling;
  bool frictional = false;  ///< mu > 0 somewhere
  bool springy = false;     ///< k_t > 0 somewhere
};

Chosen choose(const Scene& s, const std::vector<Wall>& walls) {
  const ContactChoice& c = s.contact;
  Chosen chosen{c.normal, c.tangential, c.rolling};
  std::vector<const ContactTable*> tables = {&c.bead};
  for (const Wall& w : walls) tables.push_back(&c.wall.at(w.name));
  for (const ContactTable* t : tables) {
    chosen.frictional = chosen.frictional || mu_of(*t) > 0;
    chosen.springy = chosen.springy || (mu_of(*t) > 0 && !(reads_k_t(c.tangential) && k_t_of(*t) == 0));
  }
  // All kinds of contact share the laws. If one has friction, friction is computed for all; where mu = 0 the
  // force is exactly 0.
  if (!chosen.frictional) chosen.tangential = "none";
  if (has_history(chosen.tangential) && !chosen.springy) chosen.tangential = "dashpot";
  if (chosen.tangential == "none") chosen.rolling = "none";
  return chosen;
}

ContactLaws read_laws(const Chosen& chosen, const ContactTable& table) {
  return {read_law<NormalAxis>(chosen.normal, table), read_law<TangentialAxis>(chosen.tangential, table),
          read_law<RollingAxis>(chosen.rolling, table)};
}

/// PairScale of two equal beads, and of a bead and a wall.
PairScale pair_of(double radius, double mass, double inertia_factor) {
  const double one = 1 / mass + 1 / (inertia_factor * mass);  // 1/m + R^2/I
  return {mass / 2, radius / 2, 2 * one};
}
PairScale wall_of(double radius, double mass, double inertia_factor) {
  return {mass, radius, 1 / mass + 1 / (inertia_factor * mass)};
}

void list_effects(const Scene& s, const Chosen& chosen, Plan& plan) {
  using State = Effect::State;
  const auto add = [&](const std::string& name, State state, const std::string& reason) {
    plan.effects.push_back({name, state, reason});
  };
  const ContactChoice& asked = s.contact;
  // Dimension and normal force.
  add("dimensions", State::on, s.dimension == 2 ? "2: plane (x, z), one axis of rotation" : "3");
  add("normal force", State::on, name_of(plan.bead.normal));
  if (const auto* clipped = std::get_if<NoTensionSpringDashpot>(&plan.bead.normal)) {
    const PairScale pair = pair_of(s.radius, s.mass, s.inertia_factor);
    add("tension", State::off_by_scene,
        fmt::format("contact.normal = \"{}\": a contact ends where its force is zero; two beads part with "
                    "e = {:.4g}, with tension e = {:.4g}",
                    clipped->kWord, clipped->collision(pair).restitution,
                    clipped->oscillator(pair).with_pull().restitution));
  }
  // Friction and the effects that depend on it: rotation, tangential history, rolling resistance.
  const bool friction = chosen.tangential != "none";
  const bool spring_asked = has_history(asked.tangential);
  if (asked.tangential == "none")
    add("friction", State::off_by_scene, "contact.tangential = \"none\"");
  else if (!friction)
    add("friction", State::off_by_proof, "mu = 0 everywhere: the Coulomb limit is zero, dashpot included");
  else
    add("friction", State::on,
        fmt::format("{}, mu = {:g}", name_of(plan.bead.tangential), mu_of(asked.bead)));
  const auto unasked = [](bool wanted, const char* key) {
    return wanted ? "" : fmt::format("; effects.{} = false drops nothing", key);
  };
  if (friction)
    add("rotation", State::on, "friction turns beads; it may not be dropped while mu > 0");
  else
    add("rotation", State::off_by_proof,
        "without friction there is no torque: spins stay what they were" + unasked(s.rotation, "rotation"));
  if (plan.history)
    add("tangential history", State::on,
        fmt::format("{}; one {} per contact; it may not be dropped: a bed held by dashpots alone creeps",
                    stiffness_text(asked), s.dimension == 2 ? "number" : "vector in the tangent plane"));
  else if (!spring_asked)
    add("tangential history", State::off_by_scene,
        "the tangential law has no spring" + unasked(s.history, "history"));
  else
    add("tangential history", State::off_by_proof,
        (friction ? "k_t = 0: the force depends on the present alone"
                  : "mu = 0: there is no tangential force") +
            unasked(s.history, "history"));
  if (asked.rolling == "none")
    add("rolling resistance", State::off_by_scene, "contact.rolling = \"none\"");
  else if (!friction)
    add("rolling resistance", State::off_by_proof, "beads do not turn");
  else
    add("rolling resistance", State::on, name_of(plan.bead.rolling));

  // Sizes of beads: equal beads share one set of constants.
  if (s.spread != SizeSpread::none)
    add("unequal beads", State::on, fmt::format("radii spread by {:g} of {:g}", s.spread_width, s.radius));
  else if (s.intruder)
    add("unequal beads", State::on, fmt::format("an intruder of radius {:g}", s.intruder->radius));
  else if (start_row(s.start).from_file)
    add("unequal beads", State::on,
        "if the file contains unequal beads; equal beads share one set of constants");
  else
    add("unequal beads", State::off_by_scene,
        "equal beads: masses and radii are folded into one set of constants");

  // Cell: gravity, walls, plates, lid.
  if (s.g() > 0)
    add("gravity", State::on,
        s.dimension == 2 ? fmt::format("({:g}, {:g})", s.gravity.x(), s.gravity.z())
                         : fmt::format("({:g}, {:g}, {:g})", s.gravity.x(), s.gravity.y(), s.gravity.z()));
  else
    add("gravity", State::off_by_scene, "cell.gravity = 0");
  const auto has = [&](const char* name) {
    return std::any_of(plan.walls.begin(), plan.walls.end(), [&](const Wall& w) { return w.name == name; });
  };
  const auto edge = [&](const char* name, const char* wall, Edge kind, bool moves) {
    if (kind == Edge::periodic)
      add(name, State::off_by_scene, "periodic");
    else if (has(wall))
      add(name, State::on, moves ? "hard, riding with the drive" : "hard, at rest");
    else
      add(name, State::off_by_scene, "absent");
  };
  edge("bottom", "bottom", s.bottom, s.bottom_moves);
  edge("side walls", "left", s.sides, s.side_walls_move);
  if (s.sides == Edge::wall && (s.left_tilt != 0 || s.right_tilt != 0))
    add("tilt of the side walls", State::on,
        fmt::format("{:g} and {:g} degrees outward", s.left_tilt, s.right_tilt));
  if (s.dimension == 3) edge("front and back plates", "front", s.plates, s.plates_move);
  if (s.plate_drag > 0)
    add("front and back plates", State::approximated,
        fmt::format(
            "2D substitute: a drag of rate {:g} against the cell; the plates' Coulomb friction and the third "
            "coordinate are missing, no bound on the error is known",
            s.plate_drag));
  if (s.lid)
    add("lid", State::on,
        fmt::format("hard at {:g}, {}", s.height.value_or(0),
                    s.lid_moves ? "riding with the drive" : "at rest"));
  else
    add("lid", State::off_by_scene,
        s.height ? "the run stops with an error if a bead reaches cell.height"
                 : "open top; the height that beads reach is monitored");
  // Drive, settling and time integration.
  if (s.drive.moves())
    add("drive", State::on,
        fmt::format("{} along {}, Gamma = {:.6g}{}, {}", s.drive.formula(),
                    "xyz"[static_cast<int>(s.drive.axis)], s.drive.gamma(), beyond_the_sine(s.drive, s.g()),
                    !s.envelope.points.empty()
                        ? fmt::format("amplitude schedule over {:g} cycles", s.envelope.duration())
                    : s.in_motion ? "from the phase of the frame at which the start continues"
                    : s.phase.value_or(0) > 0
                        ? fmt::format("{} start at phase {:g}", s.comoving ? "co-moving" : "abrupt", *s.phase)
                    : s.comoving ? "co-moving start"
                                 : "abrupt start: the plate hits a bed at rest"));
  else
    add("drive", State::off_by_scene, "amplitude 0");
  if (s.g() == 0)
    add("settling", State::off_by_proof, "without gravity there is no state of rest");
  else if (s.in_motion)
    add("settling", State::off_by_scene,
        "start.in_motion = true: the bed continues in the state of its file");
  else if (s.settle_limit > 0)
    add("settling", State::on,
        fmt::format("on the resting plate to {:g} m g sigma a bead, for {:g} t0 at most", s.rest_energy,
                    s.settle_limit));
  else
    add("settling", State::off_by_scene, "start.settle_limit = 0");
  // The resulting error of a collision is measured only on request (step_error.hpp).
  add(kTimeIntegration, State::approximated,
      fmt::format(
          "{:g} steps per contact, {}{}", s.steps_per_contact, integrator_named(s.integrator).explain,
          s.integrator_stated ? "" : " (the default; time.integrator = \"verlet\" steps as LAMMPS does)"));
}

/// Reason why a plan does not allow event-driven motion; empty if it does.
std::string why_not_event_driven(const Scene& scene, const Plan& plan) {
  const std::string alone =
      "does not allow a contact to be integrated separately: the normal force has memory, attracts or is not "
      "smooth, the tangential force reads the overlap, or beads resist rolling";
  if (!integrable_alone(plan.bead)) return "the contact law of beads " + alone;
  for (const ContactLaws& laws : plan.wall_laws)
    if (!integrable_alone(laws)) return "the contact law of a wall " + alone;
  if (scene.plate_drag > 0) return "cell.plate_drag slows beads between contacts";
  if (!scene.envelope.points.empty()) return "the drive's amplitude changes";
  if (!scene.drive.harmonics.empty()) return "the drive has harmonics";
  if (scene.drive.recorded) return "the drive is recorded";
  if (scene.drive.ramp) return "the drive changes during the run (drive.ramp)";
  if (scene.drive.horizontal) return "the plate also moves along x (drive.horizontal)";
  return "";
}

/// Selects event-driven motion where it is exact, and requested or likely to be faster, as in a dilute bed
/// with not too many beads.
void choose_stepping(const Scene& s, std::size_t beads, Plan& plan) {
  using State = Effect::State;
  // At W = 5.6 event-driven motion took as long as time steps; at W = 50 with 400 beads it took twice as
  // long, because some three beads are nearly always in contact.
  constexpr double kDilute = 10;
  constexpr std::size_t kMost = 200;
  const std::string hindrance = why_not_event_driven(s, plan);
  // Without gravity beads do not come to rest on each other, with or without a drive.
  const double w = s.g() > 0 ? s.drive.k_m() : HUGE_VAL;
  if (s.stepping == Stepping::event_driven && !hindrance.empty())
    throw ConfigError(s.where("time.stepping"),
                      fmt::format("is \"event-driven\", but {}; choose \"auto\" or \"steps\".", hindrance));
  plan.event_driven =
      s.stepping == Stepping::event_driven || (s.stepping == Stepping::automatic && hindrance.empty() &&
                                               !plan.history && w >= kDilute && beads <= kMost);
  const char* name = "free flight";
  if (plan.event_driven)
    plan.effects.push_back(
        {name, State::on,
         "beads fly from contact to contact, contacts of two bodies are integrated to 1e-7; "
         "the time step acts only where three bodies meet"});
  else if (s.stepping == Stepping::steps)
    plan.effects.push_back({name, State::off_by_scene, "time.stepping = \"steps\""});
  else
    plan.effects.push_back(
        {name, State::off_by_proof,
         !hindrance.empty() ? hindrance
         : plan.history
             ? "a contact with a history spring is faster in time steps than integrated separately; "
               "time.stepping = \"event-driven\" integrates it exactly"
         : w < kDilute ? fmt::format("W = {:.3g} is below {:g}: in a dense bed steps are faster", w, kDilute)
                       : fmt::format("{} beads are more than {}: steps are faster", beads, kMost)});
}

/// Refuses to omit an effect that has an influence.
void refuse_to_drop(const Scene& s, const Plan& plan) {
  const double mu = mu_of(s.contact.bead);
  if (!s.rotation && plan.rotation)
    throw ConfigError(
        s.where("effects.rotation"),
        fmt::format(
            "is false, but friction turns beads (contact.tangential = \"{}\", mu = {:g}); set mu = 0 at "
            "all contacts or contact.tangential = \"none\" to turn off both.",
            s.contact.tangential, mu));
  if (s.springs && remembered_numbers(plan) == 0)
    throw ConfigError(s.where("time.springs"), "is true, but no contact law of this scene has memory.");
  if (!s.history && plan.history)
    throw ConfigError(
        s.where("effects.history"),
        fmt::format("is false, but contact.tangential = \"{}\" with {} is a spring with history; "
                    "choose \"dashpot\" for a law without history.",
                    s.contact.tangential, stiffness_text(s.contact)));
}

/// A wall acts on beads along x by its normal or by friction.
void refuse_void_horizontal(const Scene& s, const Plan& plan) {
  if (!s.drive.horizontal) return;
  const bool friction = std::visit([](const auto& law) { return law.kActs; }, plan.bead.tangential);
  for (const Wall& wall : plan.walls)
    if (wall.moves && (wall.n.x() != 0 || (friction && mu_of(s.contact.wall.at(wall.name)) > 0))) return;
  throw ConfigError(
      s.where("drive.horizontal"),
      "moves no bead: of the walls that ride with the plate none is a side wall, and none has friction.");
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

/// Time that the tangential law needs to be resolved, t0; infinite without a limit. Mindlin's stiffness grows
/// with the overlap and is not bounded by that of a normal law with a stiffness k_n of its own: half a period
/// of its spring at the overlap of an elastic impact, v sqrt(m_eff/k_n).
double tangential_time(const ContactLaws& laws, const PairScale& pair, double speed) {
  const double own = std::visit([&](const auto& law) { return law.shortest_time(pair); }, laws.tangential);
  const auto* mindlin = std::get_if<MindlinSlider>(&laws.tangential);
  if (mindlin == nullptr) return own;
  const double overlap = std::visit(
      [&](const auto& law) {
        if constexpr (requires { law.k_n; })
          return speed * std::sqrt(pair.m_eff / law.k_n);
        else
          return 0.0;  // Hertz, whose stiffness grows alike: its own limit resolves both (V2.17)
      },
      laws.normal);
  const double k_t = mindlin->stiffness(pair.r_eff) * std::sqrt(overlap);
  return k_t > 0 ? std::min(own, std::numbers::pi / std::sqrt(k_t * pair.inv_m_t)) : own;
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

struct BeadScale {
  double radius, mass;
};

/// The sizes of beads that the scene states, without those of a file.
std::vector<BeadScale> announced(const Scene& s) {
  const double smallest = s.radius * (1 - largest_deviation(s.spread, s.spread_width));
  std::vector<BeadScale> all = {{smallest, s.mass_of(smallest)}};
  if (s.intruder) all.push_back({s.intruder->radius, s.intruder->mass});
  return all;
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

void warn(const Scene& s, Plan& plan) {
  constexpr double kManySteps = 2e6;
  for (const VoidKey& key : s.void_keys) plan.warnings.push_back(key.text());
  for (const std::string& doubt : warnings_of_record(s.drive)) plan.warnings.push_back(doubt);
  for (std::size_t k = 0; k < s.drive.harmonics.size(); ++k)
    if (const double amplitude = s.drive.harmonics[k].amplitude; amplitude > 1)
      plan.warnings.push_back(
          fmt::format("harmonic {} of the drive is {:g} times the first; drive.harmonics states amplitudes "
                      "relative to the first, so that 10 % is 0.1.",
                      k + 2, amplitude));
  const auto slides_freely = [](const ContactLaws& laws) {
    const auto* dashpot = std::get_if<DashpotSlider>(&laws.tangential);
    return dashpot != nullptr && dashpot->damping.eta(1) == 0;
  };
  if (slides_freely(plan.bead) && std::all_of(plan.wall_laws.begin(), plan.wall_laws.end(), slides_freely))
    plan.warnings.push_back(
        "the tangential law is a dashpot without gamma_t, c_t or c_t_over_c_n: no contact has friction, "
        "whatever mu is.");
  if (s.steps_per_contact < kFewSteps)
    plan.warnings.push_back(fmt::format(
        "time.steps_per_contact = {:g} is below {:g}: collisions are coarse and a bed may not rest.",
        s.steps_per_contact, kFewSteps));
  if (static_cast<double>(plan.steps_per_period) > kManySteps) {
    const TimeLimit& why = plan.shortest();
    plan.warnings.push_back(
        fmt::format("a cycle takes {:.3g} steps, because of the {} ({:.3g} t0): the run will be slow.",
                    static_cast<double>(plan.steps_per_period), why.name, why.time));
  }
}

}  // namespace

std::string word_of(Effect::State state) {
  switch (state) {
    case Effect::State::on:
      return "on";
    case Effect::State::off_by_scene:
      return "off (scene)";
    case Effect::State::off_by_proof:
      return "off (proven)";
    case Effect::State::approximated:
      break;
  }
  return "approximated";
}

const TimeLimit& Plan::shortest() const {
  return *std::min_element(limits.begin(), limits.end(),
                           [](const TimeLimit& a, const TimeLimit& b) { return a.time < b.time; });
}

std::size_t remembered_numbers(const Plan& plan) {
  return static_cast<std::size_t>(kScalar.find(plan.key).remembered);
}

std::string Plan::law_names() const {
  std::string name = fmt::format("{}D; normal: {}; tangential: {}", dimension, name_of(bead.normal),
                                 name_of(bead.tangential));
  if (key.rolling > 0) name += "; rolling: " + name_of(bead.rolling);
  if (key.velocity == Velocity::full_step) name += "; predicted velocities";
  if (locate) name += "; steps split at entry and exit";
  return name;
}

namespace {

/// Largest speed of a bead at the start: those of a file state theirs, drawn ones have components up to
/// start.velocity_scale.
double start_speed(const Scene& s, const std::vector<Bead>& beads) {
  double largest = start_row(s.start).draws ? std::numbers::sqrt2 * s.velocity_scale : 0;
  if (start_row(s.start).from_file)
    for (const Bead& b : beads) largest = std::max(largest, std::hypot(b.vx, b.vy, b.vz));
  return largest;
}

}  // namespace

Plan make_plan(const Scene& s, const std::vector<Bead>& beads) {
  // Laws: what the scene selects, reduced to what has an influence.
  Plan plan;
  plan.dimension = s.dimension;
  plan.walls = s.walls();
  const Chosen chosen = choose(s, plan.walls);
  plan.bead = read_laws(chosen, s.contact.bead);
  for (const Wall& w : plan.walls) plan.wall_laws.push_back(read_laws(chosen, s.contact.wall.at(w.name)));
  plan.key = {s.dimension, plan.bead.normal.index(), plan.bead.tangential.index(), plan.bead.rolling.index(),
              integrator_named(s.integrator).velocity};
  plan.locate = integrator_named(s.integrator).locate;
  plan.rotation = std::visit([](const auto& law) { return law.kActs; }, plan.bead.tangential);
  plan.history = std::visit([](const auto& law) { return law.kHistory; }, plan.bead.tangential);

  refuse_to_drop(s, plan);
  refuse_void_horizontal(s, plan);

  // Sizes: only beads from a file can differ from those that the scene states.
  const bool from_file = start_row(s.start).from_file;
  std::vector<BeadScale> sizes;
  if (from_file)
    for (const Bead& b : beads) sizes.push_back({b.radius, b.mass});
  plan.usual_radius = s.radius, plan.usual_mass = s.mass;
  const auto smaller = [](const BeadScale& a, const BeadScale& b) { return a.radius < b.radius; };
  if (sizes.empty()) {
    sizes = announced(s);
  } else {
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end(), smaller);
    plan.usual_radius = middle->radius, plan.usual_mass = middle->mass;
    // A run in motion keeps the step of the run that drew the sizes, which the bounds of the spread set.
    if (s.in_motion && s.spread != SizeSpread::none) {
      const std::vector<BeadScale> drawn_from = announced(s);
      sizes.insert(sizes.end(), drawn_from.begin(), drawn_from.end());
    }
  }
  // Bounds: displacement per step, overlap, and the force at the overlap bound.
  plan.travel_bound = kTravelBound * 2 * std::min_element(sizes.begin(), sizes.end(), smaller)->radius;
  plan.overlap_bound = s.overlap_bound * 2 * plan.usual_radius;
  double strongest = 1;  // largest factor on the amplitude in the schedule
  for (const auto& [cycle, factor] : s.envelope.points) strongest = std::max(strongest, factor);
  const double speed =
      std::max({2 * strongest * s.drive.velocity_bound(), std::sqrt(2 * s.g()), start_speed(s, beads), 1e-3});
  const auto force = [&](const auto& law) { return law.largest_force(plan.overlap_bound); };
  plan.largest_force = std::visit(force, plan.bead.normal);
  for (const ContactLaws& laws : plan.wall_laws)
    plan.largest_force = std::max(plan.largest_force, std::visit(force, laws.normal));
  // Time step: the shortest time of any contact sets the number of steps per period.
  for (const auto& [radius, mass] : fastest(sizes)) {
    add_limits("bead-bead", plan.bead, pair_of(radius, mass, s.inertia_factor), speed, plan.limits);
    for (std::size_t w = 0; w < plan.walls.size(); ++w)
      add_limits("bead-" + plan.walls[w].name, plan.wall_laws[w], wall_of(radius, mass, s.inertia_factor),
                 speed, plan.limits);
  }
  if (s.plate_drag > 0) plan.limits.push_back({"plate drag", 1 / s.plate_drag});
  constexpr double kMostSteps = 1e10, kShortestStep = 1e-12;
  double steps = s.drive.period() / (plan.shortest().time / s.steps_per_contact);
  // While the frequency changes, a frame is at the step nearest to its phase.
  constexpr double kFinePhases = 1000;  // steps of the shortest cycle
  if (s.drive.ramp)
    if (const DriveRamp& ramp = *s.drive.ramp; ramp.changes_frequency())
      steps = std::max({steps, kFinePhases * ramp.to.omega / ramp.from.omega, kFinePhases});
  if (!(steps <= kMostSteps))
    throw ConfigError(
        s.where("drive"),
        fmt::format("a cycle of {:.3g} t0 takes {:.3g} steps of the shortest contact, the bound is {:g}.",
                    s.drive.period(), steps, kMostSteps));
  plan.steps_per_period = static_cast<std::int64_t>(std::ceil(steps));
  // Each phase must be a whole number of steps.
  const std::int64_t rest = plan.steps_per_period % s.phases;
  if (rest != 0) plan.steps_per_period += s.phases - rest;
  plan.dt = s.drive.period() / static_cast<double>(plan.steps_per_period);
  if (!(plan.dt >= kShortestStep))
    throw ConfigError(s.where("drive"),
                      fmt::format("a cycle of {:.3g} t0 makes steps of {:.3g} t0, the bound is {:g}.",
                                  s.drive.period(), plan.dt, kShortestStep));
  if (const double travel = strongest * s.drive.velocity_bound() * plan.dt; !(travel <= plan.travel_bound))
    throw ConfigError(s.where("drive"),
                      fmt::format("the plate moves {:.3g} sigma in one step, the bound is {:g}; raise "
                                  "time.steps_per_contact or contact.k_n.",
                                  travel, plan.travel_bound));
  // Number of cycles: a schedule of the amplitude precedes the cycles that are discarded.
  plan.cycles_before = cycles_before(s.envelope, s.discard);
  plan.steps = (plan.cycles_before + s.cycles) * plan.steps_per_period;
  if (s.drive.ramp && s.drive.ramp->changes_frequency())
    plan.steps = std::llround(s.drive.time_at(static_cast<double>(plan.cycles_before + s.cycles)) / plan.dt);
  require_record_lasts(s.drive, plan.cycles_before + s.cycles, s.where("drive.file"));
  list_effects(s, chosen, plan);
  choose_stepping(s, beads.empty() ? s.n_beads.value_or(0) : beads.size(), plan);
  warn(s, plan);
  return plan;
}

System make_system(const Scene& s, const Plan& plan) {
  System system;
  system.dimension = s.dimension;
  system.period = s.period();
  system.gravity = s.gravity;
  system.walls = plan.walls;
  system.plate_drag = s.plate_drag;
  system.drive = s.drive;
  system.steps_per_period = plan.steps_per_period;
  system.dt = plan.dt;
  return system;
}

std::vector<double> contact_constants(const ContactLaws& laws, const PairScale& pair, double reach,
                                      double inv_radius_i, double inv_radius_j) {
  std::vector<double> set = {
      reach,         reach * reach * (1 + 1e-14), 1 / reach, 1 / (reach * reach), inv_radius_i, inv_radius_j,
      1 / pair.m_eff};
  const auto append = [&](const auto& axis) {
    std::visit(
        [&](const auto& law) {
          const auto own = law.constants(pair);
          set.insert(set.end(), own.begin(), own.end());
        },
        axis);
  };
  append(laws.normal);
  append(laws.tangential);
  append(laws.rolling);
  return set;
}

}  // namespace twincell::sim
