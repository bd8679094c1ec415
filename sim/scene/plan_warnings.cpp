#include "sim/scene/plan_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "sim/laws/cell_laws.hpp"
#include "sim/laws/rolling/none.hpp"
#include "sim/laws/tangential/none.hpp"
#include "sim/scene/recorded_drive.hpp"

namespace twincell::sim {

namespace {

void warn_of_harmonics(const Drive& drive, std::vector<std::string>& warnings) {
  for (std::size_t k = 0; k < drive.harmonics.size(); ++k)
    if (const double amplitude = drive.harmonics[k].amplitude; amplitude > 1)
      warnings.push_back(
          fmt::format("harmonic {} of the drive is {:g} times the first; drive.harmonics states amplitudes "
                      "relative to the first, so that 10 % is 0.1.",
                      k + 2, amplitude));
}

/// Reason why the tangential law of these contacts exerts no force; empty if it exerts one, or is meant not
/// to.
std::string_view why_no_friction(const ContactLaws& laws) {
  return std::visit(
      []<class Law>(const Law& law) -> std::string_view {
        if constexpr (MayExertNoForce<Law>)
          return law.why_no_force();
        else
          return "";
      },
      laws.tangential);
}

void warn_of_missing_friction(const Plan& plan, std::vector<std::string>& warnings) {
  const std::string_view why = why_no_friction(plan.laws->bead);
  const auto slides_freely = [](const ContactLaws& laws) { return !why_no_friction(laws).empty(); };
  if (!why.empty() && std::all_of(plan.laws->walls.begin(), plan.laws->walls.end(), slides_freely))
    warnings.push_back(fmt::format("the tangential law {}: no contact has friction, whatever mu is.", why));
}

/// Warns of keys that the scene's file states and a value makes void: they are read, but nothing changes with
/// them. They are no error, because a sweep over mu or the amplitude may begin at 0.
class VoidValues {
 public:
  /// \param warnings the sentences are added to these
  VoidValues(const Scene& scene, std::vector<std::string>& warnings) : scene_(scene), warnings_(warnings) {}
  void warn(const char* table, const char* key, const std::string& why) {
    if (is_own(scene_.source->section(table), key))
      warnings_.push_back(fmt::format("{}.{} has no effect: {}.", table, key, why));
  }

 private:
  [[nodiscard]] bool is_own(const ConfigSection& table, const char* key) const {
    return table.has(key) && !table.where(key).file.starts_with("preset ") &&
           table.where(key).file != scene_.calibration.string();
  }

  const Scene& scene_;
  std::vector<std::string>& warnings_;
};

void warn_of_resting_plate(const Scene& s, VoidValues& voids) {
  if (s.drive.amplitude != 0 || s.drive.recorded || s.drive.ramp) return;
  voids.warn("drive", "harmonics", "they are relative to the amplitude of the drive, which is 0");
  if (!s.comoving && !s.drive.moves())
    voids.warn("drive", "start", "the plate rests, because the amplitude of the drive is 0");
}

/// Masses of beads of several sizes depend on whether they are discs or spheres.
void warn_of_void_inertia(const Scene& s, const Plan& plan, VoidValues& voids) {
  const bool one_size = s.spread == SizeSpread::none && !s.intruder && !start_row(s.start).from_file;
  if (!plan.rotation && one_size) voids.warn("beads", "inertia", "no bead turns");
}

void warn_of_void_values(const Scene& s, const Plan& plan, std::vector<std::string>& warnings) {
  if (!s.source) return;
  VoidValues voids(s, warnings);
  warn_of_resting_plate(s, voids);
  warn_of_void_inertia(s, plan, voids);
  const ConfigSection contact = s.source->section("contact");
  const auto warn = [&](const char* key, const std::string& why) { voids.warn("contact", key, why); };
  if (s.contact.tangential != NoTangential::kWord && !plan.rotation)
    for (const char* key : {"k_t", "gamma_t", "c_t", "c_t_over_c_n"}) warn(key, "mu is 0 for all contacts");
  else if (contact.has("restitution") && contact.number("restitution") == 1.0)
    warn("c_t_over_c_n", "with restitution = 1 there is no normal dashpot to take a multiple of");
}

void warn_of_steps(const Scene& s, const Plan& plan, std::vector<std::string>& warnings) {
  constexpr double kManySteps = 2e6;
  if (s.steps_per_contact < kFewSteps)
    warnings.push_back(fmt::format(
        "time.steps_per_contact = {:g} is below {:g}: collisions are coarse and a bed may not rest.",
        s.steps_per_contact, kFewSteps));
  if (static_cast<double>(plan.steps_per_period) > kManySteps) {
    const TimeLimit& why = plan.shortest();
    warnings.push_back(
        fmt::format("a cycle takes {:.3g} steps, because of the {} ({:.3g} t0): the run will be slow.",
                    static_cast<double>(plan.steps_per_period), why.name, why.time));
  }
}

/// Whether these normal contacts give back all energy.
bool is_elastic(const ContactLaws& laws) {
  return std::visit([](const auto& law) { return law.is_elastic(); }, laws.normal);
}

/// The errors of "split" in e have one sign, so that they add up where nothing else takes energy away.
void warn_of_lost_energy(const Scene& s, const Plan& plan, std::vector<std::string>& warnings) {
  constexpr double kManyStepsPerContact = 100;
  const bool conserves = !plan.rotation && s.plate_drag == 0 && is_elastic(plan.laws->bead) &&
                         std::all_of(plan.laws->walls.begin(), plan.laws->walls.end(), is_elastic);
  if (!conserves || plan.event_driven || !plan.locate || s.steps_per_contact >= kManyStepsPerContact) return;
  warnings.push_back(fmt::format(
      "no contact dissipates energy, but the steps of \"{}\" with time.steps_per_contact = {:g} take a "
      "little away in each collision, which adds up in long runs; set time.steps_per_contact = {:g}, "
      "time.integrator = \"verlet\" or, where the scene permits it, time.stepping = \"event-driven\".",
      s.integrator, s.steps_per_contact, kManyStepsPerContact));
}

}  // namespace

std::vector<std::string> warnings_of(const Scene& s, const Plan& plan) {
  std::vector<std::string> warnings;
  for (const VoidKey& key : s.void_keys) warnings.push_back(key.text());
  for (const std::string& doubt : warnings_of_record(s.drive)) warnings.push_back(doubt);
  warn_of_harmonics(s.drive, warnings);
  warn_of_missing_friction(plan, warnings);
  warn_of_void_values(s, plan, warnings);
  if (s.contact.rolling != NoRolling::kWord && !plan.rotation)
    warnings.emplace_back(
        "beads do not turn without friction (contact.mu = 0), so that contact.rolling has no effect.");
  warn_of_steps(s, plan, warnings);
  warn_of_lost_energy(s, plan, warnings);
  return warnings;
}

}  // namespace twincell::sim
