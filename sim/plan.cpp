#include "sim/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace twincell::sim {

namespace {

ViscousDamping normal_damping(const ContactSpec& c, double m_eff) {
  if (c.c_n) return {0, *c.c_n};
  if (c.restitution) return {0, eta_of_restitution(*c.restitution, c.k_n, m_eff)};
  return {c.gamma_n.value_or(0), 0};
}

ViscousDamping tangential_damping(const ContactSpec& c, double m_eff) {
  if (c.c_t) return {0, *c.c_t};
  if (c.c_t_over_c_n) return {0, *c.c_t_over_c_n * normal_damping(c, m_eff).eta(m_eff)};
  return {c.gamma_t.value_or(0), 0};
}

Plan::Contact contact_laws(const ContactSpec& c, double m_eff, bool friction) {
  Plan::Contact laws;
  const LinearSpringDashpot normal{c.k_n, normal_damping(c, m_eff)};
  if (c.tension)
    laws.normal = normal;
  else
    laws.normal = ClippedSpringDashpot{normal};
  const ViscousDamping damping = tangential_damping(c, m_eff);
  if (!friction)
    laws.tangential = NoTangential{};
  else if (c.tangential == ContactSpec::Tangential::dashpot || c.k_t == 0)
    laws.tangential = DashpotSlider{damping, c.mu};
  else if (c.slip_rescales)
    laws.tangential = SpringSlider{c.k_t, damping, c.mu};
  else
    laws.tangential = SpringOnlySlider{{c.k_t, damping, c.mu}};
  return laws;
}

void list_effects(const Scene& s, Plan& plan) {
  using State = Effect::State;
  auto add = [&](const char* name, State state, const std::string& reason) {
    plan.effects.push_back({name, state, reason});
  };
  const bool asked = s.bead.tangential != ContactSpec::Tangential::none;
  const bool spring = asked && s.bead.tangential == ContactSpec::Tangential::spring;
  const bool frictional = s.bead.mu > 0 || s.wall.mu > 0;
  add("normal force", State::on,
      std::visit([](const auto& law) { return std::string(law.kName); }, plan.bead.normal));
  if (!asked)
    add("friction", State::off_by_scene, "contact.tangential = \"none\"");
  else if (!frictional)
    add("friction", State::off_by_proof, "mu = 0: the Coulomb limit is zero");
  else
    add("friction", State::on, fmt::format("mu = {:g} (beads), {:g} (walls)", s.bead.mu, s.wall.mu));
  if (plan.rotation)
    add("rotation", State::on, "friction turns beads");
  else
    add("rotation", State::off_by_proof, "without friction there is no torque");
  if (plan.history)
    add("tangential history", State::on, fmt::format("k_t = {:g}", s.bead.k_t));
  else if (spring && frictional)
    add("tangential history", State::off_by_proof, "k_t = 0: the force depends on the present alone");
  else
    add("tangential history", spring ? State::off_by_proof : State::off_by_scene,
        spring ? "mu = 0" : "no tangential spring");
  if (s.gravity > 0)
    add("gravity", State::on,
        s.tilt == 0 ? fmt::format("g = {:g}", s.gravity)
                    : fmt::format("g = {:g}, cell tilted by {:g} degrees", s.gravity, s.tilt));
  else
    add("gravity", State::off_by_scene, "cell.gravity = 0");
  if (s.periodic_sides)
    add("side walls", State::off_by_scene, "cell.sides = \"periodic\"");
  else
    add("side walls", State::on, s.side_walls_move ? "they ride with the plate" : "at rest");
  add("lid", State::off_by_scene, "it must not act: a run in which a bead reaches it stops and says so");
  if (s.drive.amplitude > 0)
    add("drive", State::on,
        fmt::format("Gamma = {:.6g}, {} start", s.drive.gamma(s.gravity > 0 ? s.gravity : 1),
                    s.comoving ? "co-moving" : "abrupt"));
  else
    add("drive", State::off_by_scene, "amplitude 0");
}

void add_limits(const std::string& kind, const Plan::Contact& laws, double m_eff, double inverse_m_t,
                std::vector<TimeLimit>& limits) {
  limits.push_back({kind + ", normal contact",
                    std::visit([&](const auto& law) { return law.shortest_time(m_eff); }, laws.normal)});
  const double tangential =
      std::visit([&](const auto& law) { return law.shortest_time(m_eff, 1 / inverse_m_t); }, laws.tangential);
  if (std::isfinite(tangential)) limits.push_back({kind + ", tangential contact", tangential});
}

}  // namespace

std::string Plan::kernel_name() const {
  auto name = [](const auto& law) { return std::string(law.kName); };
  return fmt::format("2D; normal: {}; tangential: {}; {}", std::visit(name, bead.normal),
                     std::visit(name, bead.tangential), std::visit(name, side));
}

Plan make_plan(const Scene& s) {
  Plan plan;
  // Friction of one kind of contact keeps the machinery for both; the other's mu = 0 then gives exactly no
  // force.
  const bool friction =
      s.bead.tangential != ContactSpec::Tangential::none && (s.bead.mu > 0 || s.wall.mu > 0);
  const double m_pair = s.mass / 2, m_wall = s.mass;
  plan.bead = contact_laws(s.bead, m_pair, friction);
  plan.wall = contact_laws(s.wall, m_wall, friction);
  // One k_t decides for both kinds whether there is history.
  if (plan.bead.tangential.index() != plan.wall.tangential.index())
    throw ConfigError({s.file, 0, 0, "contact.wall.k_t"},
                      "k_t must be zero for beads and walls alike, or for neither.");
  if (s.periodic_sides)
    plan.side = PeriodicSides{s.width};
  else
    plan.side = SideWalls{s.width};
  plan.rotation = std::visit([](const auto& law) { return law.kNeedsSpin; }, plan.bead.tangential);
  plan.history = std::visit([](const auto& law) { return law.kNeedsHistory; }, plan.bead.tangential);
  plan.largest_diameter = 2 * s.radius;

  const double inverse_one = 1 / s.mass + 1 / (s.inertia_factor * s.mass);  // 1/m + R^2/I
  add_limits("bead-bead", plan.bead, m_pair, 2 * inverse_one, plan.limits);
  add_limits("bead-wall", plan.wall, m_wall, inverse_one, plan.limits);
  double shortest = HUGE_VAL;
  for (const TimeLimit& limit : plan.limits) shortest = std::min(shortest, limit.time);
  constexpr double kMostSteps = 1e10, kMostTravel = 0.05;
  const double steps = s.drive.period() / (shortest / s.steps_per_contact);
  if (!(steps <= kMostSteps))
    throw ConfigError(
        {s.file, 0, 0, "drive"},
        fmt::format("a cycle of {:.3g} t0 takes {:.3g} steps of the shortest contact, the bound is {:g}.",
                    s.drive.period(), steps, kMostSteps));
  plan.steps_per_period = static_cast<std::int64_t>(std::ceil(steps));
  // Phases divide the period into whole numbers of steps.
  const std::int64_t rest = plan.steps_per_period % s.phases;
  if (rest != 0) plan.steps_per_period += s.phases - rest;
  plan.dt = s.drive.period() / static_cast<double>(plan.steps_per_period);
  if (const double travel = s.drive.peak_velocity() * plan.dt; travel > kMostTravel)
    throw ConfigError({s.file, 0, 0, "drive"},
                      fmt::format("the plate moves {:.3g} sigma in one step, the bound is {:g}; raise "
                                  "time.steps_per_contact or contact.k_n.",
                                  travel, kMostTravel));
  list_effects(s, plan);
  return plan;
}

}  // namespace twincell::sim
