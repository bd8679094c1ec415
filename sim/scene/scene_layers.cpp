#include "sim/scene/scene_layers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "sim/scene/scene.hpp"
#include "trajectory/unit_keys.hpp"

namespace twincell::sim {

namespace {

using Section = ConfigSection;

}  // namespace

const std::vector<std::string>& drive_words() {
  static const std::vector<std::string> words = {"amplitude", "omega", "frequency",
                                                 "gamma",     "k_m",   "peak_velocity"};
  return words;
}

std::size_t count_drive_words(const Config& config) {
  const Section drive = config.root().section("drive");
  return static_cast<std::size_t>(std::count_if(drive_words().begin(), drive_words().end(),
                                                [&](const std::string& word) { return drive.has(word); }));
}

namespace {

bool states_amplitude_or_frequency(const Config& config) {
  const Section drive = config.root().section("drive");
  return drive.has("amplitude") || drive.has("omega") || drive.has("frequency");
}

/// Whether Gamma and K_m, or Gamma and V_p, determine the drive. A new value of one then replaces that one,
/// because without the other the drive would not be determined.
bool is_stated_by_strengths(const Config& config) {
  const Section drive = config.root().section("drive");
  return !states_amplitude_or_frequency(config) && drive.has("gamma") &&
         (drive.has("k_m") || drive.has("peak_velocity"));
}

}  // namespace

void yield_to_record(Config& lower, const Config& upper) {
  if (!upper.root().section("drive").has("file")) return;
  for (const char* key :
       {"file_sha256", "repeat", "cutoff", "cutoff_per_t0", "cutoff_hz", "harmonics", "amplitude",
        "amplitude_sigma", "amplitude_mm", "gamma", "peak_acceleration_g", "peak_acceleration_m_s2", "k_m",
        "peak_velocity", "peak_velocity_v0", "peak_velocity_mm_s"})
    lower.erase(std::string("drive.") + key);
}

void displace(Config& lower, const Config& upper) {
  for (const char* section : {"contact", "contact.wall"})
    for (const auto& group : {normal_damping_keys(), tangential_damping_keys()})
      lower.yield_to(upper, section, group);
  lower.yield_to(upper, "beads", {"count", "layers"});
  lower.yield_to(upper, "drive", {"omega", "frequency"});
}

void assign(Config& config, const std::vector<std::string>& assignments) {
  // Before the strengths give way to an assigned one, of which each is taken for the only one.
  std::map<std::string, double> strengths;
  if (is_stated_by_strengths(config))
    for (const char* word : {"gamma", "k_m", "peak_velocity"})
      if (const auto value = config.root().section("drive").number(word)) strengths[word] = *value;
  Config upper = Config::from_text("", "--set");
  for (const auto& assignment : assignments) {
    upper.assign(assignment);
    displace_spellings(config, assignment);
  }
  displace(config, upper);
  yield_to_record(config, upper);
  config.yield_to(upper, "drive", {"gamma", "k_m", "peak_velocity"});
  config.yield_to(upper, "drive.ramp", {"amplitude", "gamma", "k_m", "peak_velocity"});
  config.yield_to(upper, "drive.ramp", {"omega", "frequency"});
  displace_third_quantity(config, assignments);
  const Section assigned = upper.root().section("drive");
  const bool gamma = assigned.has("gamma"), k_m = assigned.has("k_m") || assigned.has("peak_velocity");
  if (gamma != k_m && !states_amplitude_or_frequency(upper))
    for (const auto& [word, value] : strengths)
      if ((word == "gamma") == k_m) config.assign(fmt::format("drive.{}={:.17g}", word, value));
  for (const auto& assignment : assignments) config.assign(assignment);
}

namespace {

/// Magnitude of `cell.gravity`, in units of scale.gravity_m_s2; 1 if it is not stated.
double stated_gravity(const Config& config) {
  const Section root = config.root();
  if (!root.has("cell") || !root.section("cell").has("gravity")) return 1;
  const Section cell = root.section("cell");
  if (!cell.is_list("gravity")) return cell.number("gravity").value_or(1);
  const bool planar = cell.integer("dimension").value_or(2) == 2;
  double squares = 0;
  const std::vector<double> components = cell.numbers("gravity", planar ? 2 : 3).value();
  for (const double g : components) squares += g * g;
  return std::sqrt(squares);
}

}  // namespace

void refer_to_gravity(Config& config) {
  for (const std::string table : {"drive", "drive.ramp"}) {
    const std::string key = table + ".peak_acceleration_m_s2";
    Section at = config.root();
    bool stated = at.has("drive");
    if (stated) at = at.section("drive");
    if (stated && table != "drive") {
      stated = at.has("ramp");
      if (stated) at = at.section("ramp");
    }
    if (!stated || !at.has("peak_acceleration_m_s2")) continue;
    const double gravity = stated_gravity(config);
    if (gravity > 0 && gravity != 1)
      config.restate(key, key, at.number_in("peak_acceleration_m_s2", 0).value() / gravity);
  }
}

}  // namespace twincell::sim
