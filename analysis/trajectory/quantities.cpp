#include "analysis/trajectory/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/trajectory/units.hpp"

namespace twincell {
namespace {

/// What a number is divided by to be reduced.
enum class Unit { one, per_mille, length_mm, rate_per_s, velocity_mm_s, acceleration_m_s2 };

struct Spelling {
  const char *section, *plain, *written;
  Unit unit;
  bool positive;
};

constexpr std::array kSpellings = {
    // The scale comes first: the others are converted with it.
    Spelling{"scale", "sigma_m", "sigma_mm", Unit::per_mille, true},
    Spelling{"drive", "amplitude", "amplitude_sigma", Unit::one, false},
    Spelling{"drive", "amplitude", "amplitude_mm", Unit::length_mm, false},
    Spelling{"drive", "frequency", "frequency_per_t0", Unit::one, true},
    Spelling{"drive", "frequency", "frequency_hz", Unit::rate_per_s, true},
    Spelling{"drive", "omega", "omega_per_t0", Unit::one, true},
    Spelling{"drive", "omega", "omega_rad_s", Unit::rate_per_s, true},
    Spelling{"drive", "peak_velocity", "peak_velocity_v0", Unit::one, false},
    Spelling{"drive", "peak_velocity", "peak_velocity_mm_s", Unit::velocity_mm_s, false},
    Spelling{"drive", "gamma", "peak_acceleration_g", Unit::one, false},
    Spelling{"drive", "gamma", "peak_acceleration_m_s2", Unit::acceleration_m_s2, false},
    Spelling{"cell", "width", "width_sigma", Unit::one, true},
    Spelling{"cell", "width", "width_mm", Unit::length_mm, true},
    Spelling{"cell", "height", "height_sigma", Unit::one, true},
    Spelling{"cell", "height", "height_mm", Unit::length_mm, true},
    Spelling{"cell", "depth", "depth_sigma", Unit::one, true},
    Spelling{"cell", "depth", "depth_mm", Unit::length_mm, true},
};

/// Words of the drive that have a dimension, with their reduced and their laboratory's spelling.
struct Dimensional {
  const char *plain, *reduced, *physical;
};
constexpr std::array kDimensional = {
    Dimensional{"amplitude", "amplitude_sigma", "amplitude_mm"},
    Dimensional{"frequency", "frequency_per_t0", "frequency_hz"},
    Dimensional{"omega", "omega_per_t0", "omega_rad_s"},
    Dimensional{"peak_velocity", "peak_velocity_v0", "peak_velocity_mm_s"},
};

std::string path_of(const Spelling& s, const char* key) {
  return std::string(s.section) + "." + key;
}

/// The number in reduced units. \throws ConfigError if the scale does not say what converts it
double reduced(const Spelling& s, double value, const Scale& scale, const Where& where) {
  constexpr double kMillimetres = 1000;
  const auto needs = [&](const char* what) {
    throw ConfigError(
        where, fmt::format("is {:g} in laboratory units, which need {} to be converted.", value, what));
  };
  const bool length = s.unit == Unit::length_mm, gravity = s.unit == Unit::acceleration_m_s2,
             both = s.unit == Unit::rate_per_s || s.unit == Unit::velocity_mm_s;
  if ((length || both) && !scale.sigma_m) needs("scale.sigma_mm (or scale.sigma_m)");
  if ((gravity || both) && !scale.gravity_m_s2) needs("scale.gravity_m_s2");
  switch (s.unit) {
    case Unit::one:
      return value;
    case Unit::per_mille:
      return value / kMillimetres;
    case Unit::length_mm:
      return value / kMillimetres / *scale.sigma_m;
    case Unit::rate_per_s:
      return value * *scale.t0_s();
    case Unit::velocity_mm_s:
      return value / kMillimetres / *scale.v0_m_s();
    case Unit::acceleration_m_s2:
      break;
  }
  return value / *scale.gravity_m_s2;
}

/// The sections of the configuration that hold a spelling, so that asking makes no other one known.
bool has_table(const Config& config, const char* section) {
  return config.root().has(section);
}

}  // namespace

void reduce_units(Config& config) {
  constexpr double kAgree = 1e-9;
  if (has_table(config, "drive") && has_table(config, "scale")) {
    const ConfigSection drive = config.root().section("drive"), scale = config.root().section("scale");
    for (const char* sigma : {"sigma_mm", "sigma_m"}) {
      if (!scale.has(sigma)) continue;
      for (const Dimensional& d : kDimensional)
        if (drive.has(d.plain))
          throw ConfigError(
              drive.where(d.plain),
              fmt::format("is {} without a unit where scale.{} says the laboratory's scale; say "
                          "drive.{} for reduced units or drive.{} for the laboratory's.",
                          drive.number(d.plain).value_or(0), sigma, d.reduced, d.physical));
    }
  }
  Scale scale;
  for (const Spelling& s : kSpellings) {
    if (!has_table(config, s.section)) continue;
    const ConfigSection table = config.root().section(s.section);
    if (std::string_view(s.section) != "scale" && has_table(config, "scale")) {
      const ConfigSection of_scale = config.root().section("scale");
      scale.sigma_m = of_scale.number_in("sigma_m", 0, std::nullopt, true);
      scale.gravity_m_s2 = of_scale.number_in("gravity_m_s2", 0, std::nullopt, true);
    }
    if (!table.has(s.written)) continue;
    const Where where = table.where(s.written);
    const double value = *table.number_in(s.written, 0, std::nullopt, s.positive);
    const double here = reduced(s, value, scale, where);
    require_range(where, here, 0, std::nullopt, s.positive);
    if (table.has(s.plain)) {
      const double there = *table.number(s.plain);
      if (!(std::abs(here - there) <= kAgree * std::max(std::abs(here), std::abs(there))))
        throw ConfigError(where, fmt::format("is {:g}, that is {} = {:.10g}, but {} says {:.10g}; say one of "
                                             "the two.",
                                             value, s.plain, here, table.where(s.plain).text(), there));
      config.erase(path_of(s, s.written));
    } else {
      config.restate(path_of(s, s.written), path_of(s, s.plain), here);
    }
  }
}

void displace_spellings(Config& config, const std::string& assignment) {
  static const std::vector<std::vector<std::string>> groups = {
      {"drive.omega", "drive.frequency"}, {"drive.gamma", "drive.k_m", "drive.peak_velocity"}};
  const std::string path = assignment.substr(0, assignment.find('='));
  std::string plain = path;
  for (const Spelling& s : kSpellings)
    if (path == path_of(s, s.written)) plain = path_of(s, s.plain);
  std::vector<std::string> said = {plain};
  for (const auto& group : groups)
    if (std::find(group.begin(), group.end(), plain) != group.end()) said = group;
  for (const Spelling& s : kSpellings) {
    if (std::find(said.begin(), said.end(), path_of(s, s.plain)) == said.end()) continue;
    config.erase(path_of(s, s.written));
    config.erase(path_of(s, s.plain));
  }
  if (path != plain && said.size() > 1)
    for (const auto& other : said) config.erase(other);
}

std::string resolved_text(Config& config) {
  if (!has_table(config, "scale") || !config.root().section("scale").has("sigma_m") ||
      !has_table(config, "drive"))
    return config.text();
  const ConfigSection drive = config.root().section("drive");
  std::vector<const Dimensional*> renamed;
  for (const Dimensional& d : kDimensional)
    if (drive.has(d.plain)) {
      config.restate(std::string("drive.") + d.plain, std::string("drive.") + d.reduced,
                     *drive.number(d.plain));
      renamed.push_back(&d);
    }
  std::string text = config.text();
  for (const Dimensional* d : renamed)
    config.restate(std::string("drive.") + d->reduced, std::string("drive.") + d->plain,
                   *drive.number(d->reduced));
  return text;
}

}  // namespace twincell
