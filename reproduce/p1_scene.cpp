#include "reproduce/p1_scene.hpp"

#include <fmt/format.h>

#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/scene.hpp"

namespace twincell::reproduce {

namespace {

constexpr double kPerturbation = 1e-9;  ///< perturbation of crystals, sigma

}  // namespace

std::string p1_scene(const P1Run& run) {
  std::string start;
  if (!run.start.empty()) start = fmt::format("start.kind = \"{}\"\n", run.start);
  if (run.start.starts_with("crystal")) start += fmt::format("start.perturbation = {:g}\n", kPerturbation);
  return fmt::format(R"([scene]
preset = "fortini-huang-2015"
beads.layers = {}
{}time.integrator = "split"
time.steps_per_contact = 6.37
time.discard = {}
time.cycles = {}
{})",
                     run.layers, start, run.discard, run.cycles, run.keys);
}

namespace {

/// What happens at the Coulomb limit under a law of contact.tangential.
std::string slip_rule(const std::string& law) {
  if (law == "spring")
    return "at the Coulomb limit the spring is shortened so that spring and dashpot give exactly the limit";
  if (law == "spring-limited") return "the limit acts on the spring, the dashpot is dropped";
  return fmt::format("that of contact.tangential = \"{}\"", law);
}

/// Scene of a run. The strength of the drive is arbitrary, because no condition depends on it.
sim::Scene read(const P1Run& run) {
  std::string text = p1_scene(run);
  text.erase(0, text.find('\n') + 1);
  return sim::read_scene_text(text + "drive.gamma = 1.0\n", "paper 1");
}

}  // namespace

std::vector<std::string> p1_contact_conditions(const std::string& keys) {
  const sim::Scene scene = read({20, "crystal_a", 1, 10, keys});
  const auto& bead = scene.contact.bead;
  const double gamma_n = bead.required("gamma_n"), gamma_t = bead.required("gamma_t");
  return {fmt::format("cell {:g} sigma wide, omega = {:g}, side walls {} with the plate", scene.width,
                      scene.drive.omega, scene.side_walls_move ? "ride" : "do not ride"),
          fmt::format(
              "contacts: k_n = {:g}, k_t = {:g}, gamma_n = {:g}, gamma_t = {:g} (c_t/c_n = {:g}), mu = {:g}",
              bead.required("k_n"), bead.required("k_t"), gamma_n, gamma_t, gamma_t / gamma_n,
              bead.required("mu")),
          fmt::format("tension {} at the end of a contact",
                      scene.contact.normal == "linear" ? "allowed" : "clipped"),
          "slip rule: " + slip_rule(scene.contact.tangential)};
}

std::string p1_step_condition(const P1Run& run) {
  const sim::Scene scene = read(run);
  return fmt::format("integrator {}, n = {:g} steps per contact, {} steps a period", scene.integrator,
                     scene.steps_per_contact, sim::make_plan(scene).steps_per_period);
}

std::vector<std::string> p1_conditions(const P1Run& run) {
  const sim::Scene scene = read(run);
  std::vector<std::string> all = p1_contact_conditions(run.keys);
  all.push_back(p1_step_condition(run));
  all.push_back(fmt::format("drive starts {}; crystals perturbed by {:g} sigma",
                            scene.comoving ? "co-moving" : "abruptly", kPerturbation));
  all.push_back(fmt::format("{} cycles discarded, {} analysed, {} phases a cycle", scene.discard,
                            scene.cycles, scene.phases));
  all.emplace_back(
      "conventions: s_b variance over phases, T_g of both components about the instantaneous centre of mass, "
      "neighbours within 1.2 sigma, slip as a vector change above 0.2 sigma of two bonds");
  return all;
}

std::string p1_cheaper_steps() {
  return "integrator split at n = 6.37 steps per contact: as accurate as Verlet at n = 50 in every measured "
         "quantity except e averaged over entry phases, with 7.9 times fewer steps (docs/accuracy.md)";
}

}  // namespace twincell::reproduce
