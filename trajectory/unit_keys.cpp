#include "trajectory/unit_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace twincell {
namespace {

enum class Sign { any, not_negative, positive };

/// A quantity of a table: its plain key, and the keys that state its unit.
struct Quantity {
  const char *plain, *reduced, *physical;
  Unit unit;  ///< of `physical`
  Sign sign;
  bool has_dimension = true;  ///< the plain key needs a unit where the laboratory scale is stated
  double per_plain = 1;       ///< 2 for a diameter, which is two radii
};

constexpr std::array kDrive = {
    Quantity{"amplitude", "amplitude_sigma", "amplitude_mm", Unit::length_mm, Sign::not_negative},
    Quantity{"frequency", "frequency_per_t0", "frequency_hz", Unit::rate_per_s, Sign::positive},
    Quantity{"omega", "omega_per_t0", "omega_rad_s", Unit::rate_per_s, Sign::positive},
    Quantity{"peak_velocity", "peak_velocity_v0", "peak_velocity_mm_s", Unit::velocity_mm_s,
             Sign::not_negative},
    Quantity{"gamma", "peak_acceleration_g", "peak_acceleration_m_s2", Unit::acceleration_m_s2,
             Sign::not_negative, false}};
constexpr std::array kRecord = {
    Quantity{"cutoff", "cutoff_per_t0", "cutoff_hz", Unit::rate_per_s, Sign::positive}};
constexpr std::array kHorizontal = {kDrive[0]};
constexpr std::array kCellSize = {
    Quantity{"width", "width_sigma", "width_mm", Unit::length_mm, Sign::positive},
    Quantity{"height", "height_sigma", "height_mm", Unit::length_mm, Sign::positive},
    Quantity{"depth", "depth_sigma", "depth_mm", Unit::length_mm, Sign::positive}};
constexpr std::array kBead = {
    Quantity{"radius", "radius_sigma", "radius_mm", Unit::length_mm, Sign::positive},
    Quantity{"radius", "diameter_sigma", "diameter_mm", Unit::length_mm, Sign::positive, false, 2}};
constexpr std::array kPlace = {Quantity{"x", "x_sigma", "x_mm", Unit::length_mm, Sign::any},
                               Quantity{"y", "y_sigma", "y_mm", Unit::length_mm, Sign::any},
                               Quantity{"z", "z_sigma", "z_mm", Unit::length_mm, Sign::any}};

/// The tables of a configuration that have such quantities.
struct Table {
  const char* section;
  std::span<const Quantity> quantities;
};
constexpr std::array kTables = {Table{"drive", kDrive},         Table{"drive", kRecord},
                                Table{"drive.ramp", kDrive},    Table{"drive.horizontal", kHorizontal},
                                Table{"cell", kCellSize},       Table{"beads", kBead},
                                Table{"beads.intruder", kBead}, Table{"beads.intruder", kPlace}};

/// A key with a unit, and the plain reduced key that it sets.
struct Spelling {
  const char *section, *plain, *written;
  Unit unit;
  Sign sign;
  double per_plain;
};

/// All keys with a unit. The scale comes first, because the other keys are converted with it.
const std::vector<Spelling>& spellings() {
  static const std::vector<Spelling> all = [] {
    std::vector<Spelling> list = {{"scale", "sigma_m", "sigma_mm", Unit::per_mille, Sign::positive, 1}};
    for (const Table& table : kTables)
      for (const Quantity& q : table.quantities) {
        list.push_back({table.section, q.plain, q.reduced, Unit::one, q.sign, q.per_plain});
        list.push_back({table.section, q.plain, q.physical, q.unit, q.sign, q.per_plain});
      }
    return list;
  }();
  return all;
}

/// A plain key that needs a unit where the laboratory scale is stated.
struct BareKey {
  const char* section;
  const Quantity* quantity;
};

/// All such keys.
std::vector<BareKey> bare_keys() {
  std::vector<BareKey> all;
  for (const Table& table : kTables)
    for (const Quantity& q : table.quantities)
      if (q.has_dimension) all.push_back({table.section, &q});
  return all;
}

std::string path_of(const char* section, const char* key) {
  return std::string(section) + "." + key;
}

/// The table at a dotted path, if present. Stops at the first absent table, so that no key below it is marked
/// as known.
std::optional<ConfigSection> table_at(const Config& config, std::string_view path) {
  ConfigSection at = config.root();
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const std::string word(path.substr(begin, end - begin));
    if (!at.has(word)) return std::nullopt;
    at = at.section(word);
    begin = end + 1;
  }
  return at;
}

/// The bounds of a sign, as number_in() and require_range() take them.
std::optional<double> lower_of(Sign sign) {
  return sign == Sign::any ? std::nullopt : std::optional(0.0);
}

/// The key of [scale] beside which the plain key of a quantity has no clear unit; empty if there is none.
/// Gravity alone sets no unit of length, but one who states it thinks in seconds.
std::string ambiguous_beside(const Quantity& q, const ConfigSection& scale) {
  if (!q.has_dimension) return {};
  for (const char* sigma : {"sigma_mm", "sigma_m"})
    if (scale.has(sigma)) return std::string("scale.") + sigma;
  return q.unit != Unit::length_mm && scale.has("gravity_m_s2") ? "scale.gravity_m_s2" : "";
}

void refuse_bare_numbers(const Config& config) {
  const auto scale = table_at(config, "scale");
  if (!scale) return;
  for (const auto& [section, q] : bare_keys())
    if (const std::string key = ambiguous_beside(*q, *scale); !key.empty())
      if (const auto table = table_at(config, section); table && table->has(q->plain))
        refuse_bare(table->where(q->plain), table->number(q->plain).value_or(0), key,
                    path_of(section, q->reduced), path_of(section, q->physical));
}

}  // namespace

double reduced_quantity(double value, Unit unit, const Scale& scale, const Where& where) {
  constexpr double kMillimetres = 1000, kMicroseconds = 1e6;
  const auto needs = [&](const char* what) {
    throw ConfigError(
        where, fmt::format("is {:g} in laboratory units, which need {} to be converted.", value, what));
  };
  const bool length = unit == Unit::length_mm, gravity = unit == Unit::acceleration_m_s2,
             both = unit == Unit::rate_per_s || unit == Unit::velocity_mm_s || unit == Unit::time_us;
  if ((length || both) && !scale.sigma_m) needs("scale.sigma_mm (or scale.sigma_m)");
  if ((gravity || both) && !scale.gravity_m_s2) needs("scale.gravity_m_s2");
  switch (unit) {
    case Unit::one:
      return value;
    case Unit::per_mille:
      return value / kMillimetres;
    case Unit::length_mm:
      return value / kMillimetres / *scale.sigma_m;
    case Unit::time_us:
      return value / kMicroseconds / *scale.t0_s();
    case Unit::rate_per_s:
      return value * *scale.t0_s();
    case Unit::velocity_mm_s:
      return value / kMillimetres / *scale.v0_m_s();
    case Unit::acceleration_m_s2:
      break;
  }
  return value / *scale.gravity_m_s2;
}

void refuse_bare(const Where& where, double value, const std::string& scale, const std::string& reduced,
                 const std::string& physical) {
  throw ConfigError(where, fmt::format("is {:g} without a unit although {} sets the laboratory scale; write "
                                       "{} for reduced units or {} for laboratory units.",
                                       value, scale, reduced, physical));
}

void reduce_units(Config& config) {
  refuse_bare_numbers(config);
  Scale scale;
  for (const Spelling& s : spellings()) {
    const auto table = table_at(config, s.section);
    if (!table) continue;
    const auto of_scale = table_at(config, "scale");
    if (std::string_view(s.section) != "scale" && of_scale) {
      scale.sigma_m = of_scale->number_in("sigma_m", 0, std::nullopt, true);
      scale.gravity_m_s2 = of_scale->number_in("gravity_m_s2", 0, std::nullopt, true);
    }
    if (!table->has(s.written)) continue;
    const Where where = table->where(s.written);
    const bool open = s.sign == Sign::positive;
    const double value = *table->number_in(s.written, lower_of(s.sign), std::nullopt, open);
    const double here = reduced_quantity(value, s.unit, scale, where) / s.per_plain;
    require_range(where, here, lower_of(s.sign), std::nullopt, open);  // it may underflow
    // The user must decide which of two spellings is meant, even if their values agree now.
    if (table->has(s.plain))
      throw ConfigError(
          where, fmt::format("is {:g}, but {} sets the same quantity; give only one of the two.", value,
                             table->where(s.plain).text()));
    config.restate(path_of(s.section, s.written), path_of(s.section, s.plain), here);
  }
}

void displace_spellings(Config& config, const std::string& assignment) {
  static const std::vector<std::vector<std::string>> groups = {
      {"drive.omega", "drive.frequency"},
      {"drive.gamma", "drive.k_m", "drive.peak_velocity"},
      {"drive.ramp.omega", "drive.ramp.frequency"},
      {"drive.ramp.amplitude", "drive.ramp.gamma", "drive.ramp.k_m", "drive.ramp.peak_velocity"}};
  const std::string path = assignment.substr(0, assignment.find('='));
  std::string plain = path;
  for (const Spelling& s : spellings())
    if (path == path_of(s.section, s.written)) plain = path_of(s.section, s.plain);
  std::vector<std::string> said = {plain};
  for (const auto& group : groups)
    if (std::find(group.begin(), group.end(), plain) != group.end()) said = group;
  for (const Spelling& s : spellings()) {
    if (std::find(said.begin(), said.end(), path_of(s.section, s.plain)) == said.end()) continue;
    config.erase(path_of(s.section, s.written));
    config.erase(path_of(s.section, s.plain));
  }
  if (path != plain && said.size() > 1)
    for (const auto& other : said) config.erase(other);
}

void displace_third_quantity(Config& config, const std::vector<std::string>& assignments) {
  using Keys = std::vector<std::string>;
  const std::array<Keys, 3> quantities = {
      {{"frequency", "omega"}, {"amplitude"}, {"gamma", "k_m", "peak_velocity"}}};
  const auto spelled = [](const Keys& plain) {
    Keys keys = plain;
    for (const Spelling& s : spellings())
      if (s.section == std::string("drive") && std::find(plain.begin(), plain.end(), s.plain) != plain.end())
        keys.emplace_back(s.written);
    return keys;
  };
  const bool of_drive = std::any_of(assignments.begin(), assignments.end(),
                                    [](const std::string& a) { return a.starts_with("drive."); });
  const auto drive = of_drive ? table_at(config, "drive") : std::nullopt;
  if (!drive) return;
  std::vector<Keys> others;  // stated in the configuration and not assigned
  std::size_t assigned = 0;
  for (const Keys& plain : quantities) {
    const Keys keys = spelled(plain);
    const bool is_assigned = std::any_of(assignments.begin(), assignments.end(), [&](const std::string& a) {
      return std::any_of(keys.begin(), keys.end(),
                         [&](const std::string& key) { return a.starts_with("drive." + key + "="); });
    });
    if (is_assigned)
      ++assigned;
    else if (std::any_of(keys.begin(), keys.end(), [&](const std::string& key) { return drive->has(key); }))
      others.push_back(keys);
  }
  if (assigned == 0 || others.empty() || assigned + others.size() < 3) return;
  const bool has_frequency = others.front().front() == "frequency";
  if (assigned == 1 && !has_frequency) return;
  for (std::size_t i = assigned == 1 ? 1 : 0; i < others.size(); ++i)
    for (const std::string& key : others[i]) config.erase("drive." + key);
}

std::string resolved_text(Config& config) {
  const auto scale = table_at(config, "scale");
  if (!scale) return config.text();
  std::vector<BareKey> renamed;
  for (const BareKey& key : bare_keys()) {
    if (ambiguous_beside(*key.quantity, *scale).empty()) continue;
    if (const auto table = table_at(config, key.section); table && table->has(key.quantity->plain)) {
      config.restate(path_of(key.section, key.quantity->plain), path_of(key.section, key.quantity->reduced),
                     *table->number(key.quantity->plain));
      renamed.push_back(key);
    }
  }
  std::string text = config.text();
  for (const auto& [section, q] : renamed)
    config.restate(path_of(section, q->reduced), path_of(section, q->plain),
                   *table_at(config, section)->number(q->reduced));
  return text;
}

}  // namespace twincell
