#include "sim/scene/plan_stepping.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "core/error.hpp"
#include "sim/laws/cell_laws.hpp"

namespace twincell::sim {

namespace {

/// Reason why a plan does not allow event-driven motion; empty if it does.
std::string why_not_event_driven(const Scene& scene, const Plan& plan) {
  const std::string alone =
      "does not allow a contact to be integrated separately: the normal force has memory, attracts or is not "
      "smooth, the tangential force reads the overlap, or beads resist rolling";
  if (!integrable_alone(plan.laws->bead)) return "the contact law of beads " + alone;
  for (const ContactLaws& laws : plan.laws->walls)
    if (!integrable_alone(laws)) return "the contact law of a wall " + alone;
  if (scene.plate_drag > 0) return "cell.plate_drag slows beads between contacts";
  if (!scene.envelope.points.empty()) return "the drive's amplitude changes";
  if (!scene.drive.harmonics.empty()) return "the drive has harmonics";
  if (scene.drive.recorded) return "the drive is recorded";
  if (scene.drive.ramp) return "the drive changes during the run (drive.ramp)";
  if (scene.drive.horizontal) return "the plate also moves along x (drive.horizontal)";
  return "";
}

}  // namespace

void choose_stepping(const Scene& s, std::size_t beads, Plan& plan) {
  using State = Effect::State;
  // At W = 5.6 event-driven motion took as long as time steps; at W = 50 with 400 beads it took twice as
  // long, because some three beads are nearly always in contact.
  constexpr double kMinDiluteW = 10;
  constexpr std::size_t kMaxEventDrivenBeads = 200;
  const std::string hindrance = why_not_event_driven(s, plan);
  // Without gravity beads do not come to rest on each other, with or without a drive.
  const double w = s.g() > 0 ? s.drive.k_m() : HUGE_VAL;
  if (s.stepping == Stepping::event_driven && !hindrance.empty())
    throw ConfigError(s.where("time.stepping"),
                      fmt::format("is \"event-driven\", but {}; choose \"auto\" or \"steps\".", hindrance));
  plan.event_driven = s.stepping == Stepping::event_driven ||
                      (s.stepping == Stepping::automatic && hindrance.empty() && !plan.history &&
                       w >= kMinDiluteW && beads <= kMaxEventDrivenBeads);
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
         : w < kMinDiluteW
             ? fmt::format("W = {:.3g} is below {:g}: in a dense bed steps are faster", w, kMinDiluteW)
             : fmt::format("{} beads are more than {}: steps are faster", beads, kMaxEventDrivenBeads)});
}

}  // namespace twincell::sim
