#include "sim/scene/plan_effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/error.hpp"
#include "sim/laws/cell_laws.hpp"
#include "sim/laws/law_words.hpp"

namespace twincell::sim {

namespace {

using State = Effect::State;

/// "k_t = 10000", or a note that the stiffness follows the overlap.
std::string stiffness_text(const ContactChoice& contact) {
  return tangential_reads(contact.tangential, "k_t")
             ? fmt::format("k_t = {:g}", read_tangential_stiffness(contact.bead))
             : "stiffness from the overlap";
}

/// The end of a reason, if the scene states `effects.KEY = false` for an effect that has no influence.
std::string note_if_unwanted(bool wanted, const char* key) {
  return wanted ? "" : fmt::format("; effects.{} = false drops nothing", key);
}

Effect dimensions(const Scene& s) {
  return {"dimensions", State::on, s.dimension == 2 ? "2: plane (x, z), one axis of rotation" : "3"};
}

/// Absent if the normal law includes tension.
std::optional<Effect> tension(const Scene& s, const Plan& plan) {
  const PairScale pair = equal_beads(s.radius, s.mass, s.inertia_factor);
  return std::visit(
      [&]<class Law>(const Law& law) -> std::optional<Effect> {
        if constexpr (OmitsTension<Law>)
          return Effect{
              "tension", State::off_by_scene,
              fmt::format("contact.normal = \"{}\": a contact ends where its force is zero; two beads part "
                          "with e = {:.4g}, with tension e = {:.4g}",
                          law.kWord, law.collision(pair).restitution,
                          law.collision_with_tension(pair).restitution)};
        else
          return std::nullopt;
      },
      plan.laws->bead.normal);
}

// Friction and the effects that depend on it. The tangential law of the plan acts exactly if there is
// friction.

Effect friction(const Scene& s, const Plan& plan) {
  const char* name = "friction";
  if (s.contact.tangential == NoTangential::kWord)
    return {name, State::off_by_scene, fmt::format("contact.tangential = \"{}\"", NoTangential::kWord)};
  if (!plan.rotation)
    return {name, State::off_by_proof, "mu = 0 everywhere: the Coulomb limit is zero, dashpot included"};
  return {name, State::on,
          fmt::format("{}, mu = {:g}", law_name(plan.laws->bead.tangential), read_friction(s.contact.bead))};
}

Effect rotation(const Scene& s, const Plan& plan) {
  if (plan.rotation)
    return {"rotation", State::on, "friction turns beads; it may not be dropped while mu > 0"};
  return {"rotation", State::off_by_proof,
          "without friction there is no torque: spins stay what they were" +
              note_if_unwanted(s.rotation, "rotation")};
}

Effect tangential_history(const Scene& s, const Plan& plan) {
  const char* name = "tangential history";
  if (plan.history)
    return {
        name, State::on,
        fmt::format("{}; one {} per contact; it may not be dropped: a bed held by dashpots alone creeps",
                    stiffness_text(s.contact), s.dimension == 2 ? "number" : "vector in the tangent plane")};
  const std::string note = note_if_unwanted(s.history, "history");
  if (!has_history(s.contact.tangential))
    return {name, State::off_by_scene, "the tangential law has no spring" + note};
  return {name, State::off_by_proof,
          (plan.rotation ? "k_t = 0: the force depends on the present alone"
                         : "mu = 0: there is no tangential force") +
              note};
}

Effect rolling_resistance(const Scene& s, const Plan& plan) {
  const char* name = "rolling resistance";
  if (s.contact.rolling == NoRolling::kWord)
    return {name, State::off_by_scene, fmt::format("contact.rolling = \"{}\"", NoRolling::kWord)};
  if (!plan.rotation) return {name, State::off_by_proof, "beads do not turn"};
  return {name, State::on, law_name(plan.laws->bead.rolling)};
}

/// Equal beads share one set of constants.
Effect unequal_beads(const Scene& s) {
  const char* name = "unequal beads";
  if (s.spread != SizeSpread::none)
    return {name, State::on, fmt::format("radii spread by {:g} of {:g}", s.spread_width, s.radius)};
  if (s.intruder) return {name, State::on, fmt::format("an intruder of radius {:g}", s.intruder->radius)};
  if (start_row(s.start).from_file)
    return {name, State::on, "if the file contains unequal beads; equal beads share one set of constants"};
  return {name, State::off_by_scene, "equal beads: masses and radii are folded into one set of constants"};
}

// The cell: gravity, walls, plates, lid.

Effect gravity(const Scene& s) {
  if (s.g() <= 0) return {"gravity", State::off_by_scene, "cell.gravity = 0"};
  return {"gravity", State::on,
          s.dimension == 2 ? fmt::format("({:g}, {:g})", s.gravity.x(), s.gravity.z())
                           : fmt::format("({:g}, {:g}, {:g})", s.gravity.x(), s.gravity.y(), s.gravity.z())};
}

/// The effect `name` of an edge of the cell, of which `wall` is one wall.
Effect edge(const Plan& plan, const char* name, const char* wall, Edge kind, bool moves) {
  if (kind == Edge::periodic) return {name, State::off_by_scene, "periodic"};
  const bool present =
      std::any_of(plan.walls.begin(), plan.walls.end(), [&](const Wall& w) { return w.name == wall; });
  if (!present) return {name, State::off_by_scene, "absent"};
  return {name, State::on, moves ? "hard, riding with the drive" : "hard, at rest"};
}

void add_walls(const Scene& s, const Plan& plan, std::vector<Effect>& effects) {
  effects.push_back(edge(plan, "bottom", "bottom", s.bottom, s.bottom_moves));
  effects.push_back(edge(plan, "side walls", "left", s.sides, s.side_walls_move));
  if (s.sides == Edge::wall && (s.left_tilt != 0 || s.right_tilt != 0))
    effects.push_back({"tilt of the side walls", State::on,
                       fmt::format("{:g} and {:g} degrees outward", s.left_tilt, s.right_tilt)});
  if (s.dimension == 3)
    effects.push_back(edge(plan, "front and back plates", "front", s.plates, s.plates_move));
  if (s.plate_drag > 0)
    effects.push_back(
        {"front and back plates", State::approximated,
         fmt::format("2D substitute: a drag of rate {:g} against the cell; the plates' Coulomb friction and "
                     "the third coordinate are missing, no bound on the error is known",
                     s.plate_drag)});
}

Effect lid(const Scene& s) {
  if (s.lid)
    return {"lid", State::on,
            fmt::format("hard at {:g}, {}", s.height.value_or(0),
                        s.lid_moves ? "riding with the drive" : "at rest")};
  return {"lid", State::off_by_scene,
          s.height ? "the run stops with an error if a bead reaches cell.height"
                   : "open top; the height that beads reach is monitored"};
}

// Drive, settling and time integration.

std::string start_of_drive(const Scene& s) {
  if (!s.envelope.points.empty())
    return fmt::format("amplitude schedule over {:g} cycles", s.envelope.duration());
  if (s.in_motion) return "from the phase of the frame at which the start continues";
  if (s.phase.value_or(0) > 0)
    return fmt::format("{} start at phase {:g}", s.comoving ? "co-moving" : "abrupt", *s.phase);
  return s.comoving ? "co-moving start" : "abrupt start: the plate hits a bed at rest";
}

Effect drive(const Scene& s) {
  if (!s.drive.moves()) return {"drive", State::off_by_scene, "amplitude 0"};
  return {"drive", State::on,
          fmt::format("{} along {}, Gamma = {:.6g}{}, {}", s.drive.formula(),
                      "xyz"[static_cast<int>(s.drive.axis)], s.drive.gamma(), beyond_the_sine(s.drive, s.g()),
                      start_of_drive(s))};
}

Effect settling(const Scene& s) {
  const char* name = "settling";
  if (s.g() == 0) return {name, State::off_by_proof, "without gravity there is no state of rest"};
  if (s.in_motion)
    return {name, State::off_by_scene, "start.in_motion = true: the bed continues in the state of its file"};
  if (s.settle_limit > 0)
    return {name, State::on,
            fmt::format("on the resting plate to {:g} m g sigma a bead, for {:g} t0 at most", s.rest_energy,
                        s.settle_limit)};
  return {name, State::off_by_scene, "start.settle_limit = 0"};
}

/// The resulting error of a collision is measured only on request (step_error.hpp).
Effect time_integration(const Scene& s) {
  return {
      kTimeIntegration, State::approximated,
      fmt::format(
          "{:g} steps per contact, {}{}", s.steps_per_contact, integrator_named(s.integrator).explain,
          s.integrator_stated ? "" : " (the default; time.integrator = \"verlet\" steps as LAMMPS does)")};
}

/// Refuses to omit an effect that has an influence.
void refuse_to_drop(const Scene& s, const Plan& plan) {
  if (!s.rotation && plan.rotation)
    throw ConfigError(
        s.where("effects.rotation"),
        fmt::format(
            "is false, but friction turns beads (contact.tangential = \"{}\", mu = {:g}); set mu = 0 at "
            "all contacts or contact.tangential = \"{}\" to turn off both.",
            s.contact.tangential, read_friction(s.contact.bead), NoTangential::kWord));
  if (s.springs.value_or(false) && remembered_numbers(plan) == 0)
    throw ConfigError(s.where("time.springs"), "is true, but no contact law of this scene has memory.");
  if (!s.history && plan.history)
    throw ConfigError(s.where("effects.history"),
                      fmt::format("is false, but contact.tangential = \"{}\" with {} is a spring with "
                                  "history; choose \"{}\" for a law without history.",
                                  s.contact.tangential, stiffness_text(s.contact),
                                  law_without_history(s.contact.tangential)));
}

/// A wall acts on beads along x by its normal or by friction.
void refuse_void_horizontal(const Scene& s, const Plan& plan) {
  if (!s.drive.horizontal) return;
  for (const Wall& wall : plan.walls)
    if (wall.moves && (wall.n.x() != 0 || (plan.rotation && read_friction(s.contact.wall.at(wall.name)) > 0)))
      return;
  throw ConfigError(
      s.where("drive.horizontal"),
      "moves no bead: of the walls that ride with the plate none is a side wall, and none has friction.");
}

}  // namespace

std::vector<Effect> list_effects(const Scene& s, const Plan& plan) {
  std::vector<Effect> effects = {dimensions(s),
                                 {"normal force", State::on, law_name(plan.laws->bead.normal)}};
  if (const std::optional<Effect> omitted = tension(s, plan)) effects.push_back(*omitted);
  for (const auto effect : {friction, rotation, tangential_history, rolling_resistance})
    effects.push_back(effect(s, plan));
  effects.push_back(unequal_beads(s));
  effects.push_back(gravity(s));
  add_walls(s, plan, effects);
  for (const auto effect : {lid, drive, settling, time_integration}) effects.push_back(effect(s));
  return effects;
}

void refuse_effects(const Scene& s, const Plan& plan) {
  refuse_to_drop(s, plan);
  refuse_void_horizontal(s, plan);
}

}  // namespace twincell::sim
