#include "trajectory/calibration_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/constants.hpp"
#include "core/escape.hpp"
#include "core/toml_leaves.hpp"

namespace twincell {
namespace {

constexpr bool kWhole = true, kCell = true, kScene = true;

/// Interchangeable keys: a configuration that sets `enough` of them takes none from the calibration.
struct Group {
  std::vector<std::string> words;
  std::size_t enough;
};
const std::array kGroups = {
    Group{{"drive.amplitude", "drive.omega", "drive.frequency", "drive.gamma", "drive.k_m",
           "drive.peak_velocity"},
          2},
    Group{{"contact.restitution", "contact.gamma_n", "contact.c_n"}, 1},
    Group{{"contact.wall.restitution", "contact.wall.gamma_n", "contact.wall.c_n"}, 1},
};

/// The quantities of the camera's covariance.
constexpr std::array kOfCamera = {"camera.pixels_per_sigma", "camera.origin_px", "camera.rotation_deg",
                                  "camera.distortion"};

/// TOML literal "[15, 16]" or "15"; integers without a decimal point, "nan" for a missing number.
std::string literal(const std::vector<double>& v, bool whole) {
  std::vector<std::string> items;
  for (const double x : v) {
    std::string s = whole ? fmt::format("{:.0f}", x) : fmt::format("{:.10g}", x);
    if (!whole && std::isfinite(x) && s.find_first_of(".e") == std::string::npos) s += ".0";
    items.push_back(s);
  }
  return items.size() == 1 ? items.front() : fmt::format("[{}]", fmt::join(items, ", "));
}

std::vector<double> numbers_of(const ConfigSection& s, const std::string& key, const Quantity& q) {
  std::vector<double> v;
  if (q.count > 1)
    v = s.numbers(key, q.count).value_or(std::vector<double>{});
  else if (const auto x = s.number(key))
    v = {*x};
  return v;
}

std::string parent_of(const std::string& path) {
  return path.substr(0, path.rfind('.'));
}

bool states(const Config& config, const std::string& path) {
  const std::size_t dot = path.rfind('.');
  ConfigSection s = config.root();
  for (std::size_t begin = 0; begin < dot;) {
    const std::size_t end = std::min(path.find('.', begin), dot);
    if (!s.has(path.substr(begin, end - begin))) return false;
    s = s.section(path.substr(begin, end - begin));
    begin = end + 1;
  }
  return s.has(path.substr(dot + 1));
}

}  // namespace

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> all = {
      {"camera.pixels_per_sigma", "px", 1, !kWhole, kCell, !kScene},
      {"camera.origin_px", "px", 2, !kWhole, kCell, !kScene},
      {"camera.rotation_deg", "degrees", 1, !kWhole, kCell, !kScene},
      {"camera.distortion", "1", 1, !kWhole, kCell, !kScene},
      {"camera.frames_per_cycle", "1", 1, kWhole, kCell, !kScene},
      {"camera.first_phase", "1", 1, kWhole, kCell, !kScene},
      {"camera.phase_offset", "frames", 1, !kWhole, kCell, !kScene},
      {"camera.period", "frames", 1, !kWhole, !kCell, !kScene},
      {"camera.jitter", "frames", 1, !kWhole, !kCell, !kScene},
      {"cell.width", "sigma", 1, !kWhole, kCell, kScene},
      {"cell.side_tilt", "degrees", 2, !kWhole, kCell, kScene},
      {"drive.amplitude", "sigma", 1, !kWhole, kCell, kScene},
      {"drive.omega", "1/t0", 1, !kWhole, kCell, kScene},
      {"drive.second_harmonic", "1", 1, !kWhole, !kCell, !kScene},
      {"beads.diameter", "px", 1, !kWhole, !kCell, !kScene},
      {"beads.spread", "1", 1, !kWhole, !kCell, !kScene},
      {"beads.mass", "mean mass", 1, !kWhole, !kCell, !kScene},
      {"beads.layers", "1", 1, !kWhole, !kCell, !kScene},
      {"contact.restitution", "1", 1, !kWhole, !kCell, kScene},
      {"contact.mu", "1", 1, !kWhole, !kCell, kScene},
      {"contact.beta_0", "1", 1, !kWhole, !kCell, !kScene},
      {"contact.wall.restitution", "1", 1, !kWhole, !kCell, kScene},
  };
  return all;
}

const Measurement* Calibration::find(const std::string& name) const {
  const auto at =
      std::find_if(measured.begin(), measured.end(), [&](const Measurement& m) { return m.name == name; });
  return at == measured.end() ? nullptr : &*at;
}

void Calibration::put(Measurement fresh) {
  const auto rank = [](const std::string& name) {
    const auto& all = quantities();
    return std::find_if(all.begin(), all.end(), [&](const Quantity& q) { return q.name == name; }) -
           all.begin();
  };
  const auto at = std::lower_bound(
      measured.begin(), measured.end(), fresh,
      [&](const Measurement& a, const Measurement& b) { return rank(a.name) < rank(b.name); });
  if (at != measured.end() && at->name == fresh.name)
    *at = std::move(fresh);
  else
    measured.insert(at, std::move(fresh));
}

Calibration read_calibration(const std::filesystem::path& file) {
  const Config config = Config::from_file(file);
  Calibration out;
  for (const Quantity& q : quantities()) {
    if (!states(config, q.name + ".value")) {
      // A table of that name without a value is an error, unless it contains only other tables.
      if (states(config, q.name + ".standard_error") || states(config, q.name + ".unit"))
        throw ConfigError(config.root().where(q.name), "has no value.");
      continue;
    }
    const ConfigSection s =
        config.root().section(parent_of(q.name)).section(q.name.substr(q.name.rfind('.') + 1));
    Measurement m{
        .name = q.name, .value = numbers_of(s, "value", q), .standard_error = {}, .method = {}, .data = {}};
    m.standard_error = numbers_of(s, "standard_error", q);
    if (m.standard_error.empty()) m.standard_error.assign(q.count, kNaN);
    for (const double e : m.standard_error)
      if (e < 0)
        throw ConfigError(s.where("standard_error"), fmt::format("is {:g}; an error is not negative.", e));
    if (const auto unit = s.text("unit"); unit && *unit != q.unit)
      throw ConfigError(s.where("unit"),
                        fmt::format("is '{}'; {} is measured in '{}'.", *unit, q.name, q.unit));
    if (q.whole && !s.integer("value")) throw ConfigError(s.where("value"), "a whole number is needed.");
    m.method = s.text("method").value_or("");
    m.data = s.text("data").value_or("");
    out.measured.push_back(m);
  }
  // Covariance of the camera: must be symmetric and consistent with its variances.
  if (states(config, "covariance.camera")) {
    constexpr std::size_t kNames = 5;
    const ConfigSection s = config.root().section("covariance").section("camera");
    out.camera = MeasuredCovariance{
        .names = {"pixels_per_sigma", "origin_x_px", "origin_y_px", "rotation_deg", "distortion"},
        .matrix = s.numbers("matrix", kNames * kNames).value_or(std::vector<double>{})};
    if (out.camera->matrix.empty()) throw ConfigError(s.where("matrix"), "is missing.");
    constexpr double kRounding = 1e-5;  // of the seven digits that are written
    const auto& m = out.camera->matrix;
    for (std::size_t r = 0; r < kNames; ++r) {
      const double variance = m[r * kNames + r];
      if (variance < 0)
        throw ConfigError(s.where("matrix"),
                          fmt::format("contains the variance {:g} of {}, which must not be negative.",
                                      variance, out.camera->names[r]));
      for (std::size_t c = 0; c < r; ++c) {
        const double one = m[r * kNames + c], other = m[c * kNames + r];
        if (std::abs(one - other) > kRounding * std::max(std::abs(one), std::abs(other)))
          throw ConfigError(s.where("matrix"),
                            fmt::format("is not symmetric: {:g} and {:g} for {} and {}.", one, other,
                                        out.camera->names[r], out.camera->names[c]));
        if (std::abs(one) > std::sqrt(variance * m[c * kNames + c]) * (1 + kRounding))
          throw ConfigError(
              s.where("matrix"),
              fmt::format(
                  "contains the covariance {:g} of {} and {}, which is too large for their variances.", one,
                  out.camera->names[r], out.camera->names[c]));
      }
    }
  }
  config.refuse_unknown_keys();
  return out;
}

std::string calibration_text(const Calibration& calibration, const std::string& head) {
  std::string text = head.empty() ? "" : "# " + one_line(head) + "\n";
  for (const Measurement& m : calibration.measured) {
    const auto& all = quantities();
    const Quantity& q =
        *std::find_if(all.begin(), all.end(), [&](const Quantity& a) { return a.name == m.name; });
    text += fmt::format("\n[{}]\nvalue = {}\n", m.name, literal(m.value, q.whole));
    if (std::all_of(m.standard_error.begin(), m.standard_error.end(),
                    [](double e) { return std::isfinite(e); }))
      text += fmt::format("standard_error = {}\n", literal(m.standard_error, false));
    text += fmt::format("unit = \"{}\"\nmethod = {}\n", q.unit, toml_quoted(m.method));
    if (!m.data.empty()) text += fmt::format("data = {}\n", toml_quoted(m.data));
  }
  if (calibration.camera) {
    text += fmt::format("\n[covariance.camera] # of {}\nmatrix = [\n",
                        fmt::join(calibration.camera->names, ", "));
    const std::size_t n = calibration.camera->names.size();
    for (std::size_t r = 0; r < n; ++r) {
      text += " ";
      for (std::size_t c = 0; c < n; ++c) {
        std::string s = fmt::format("{:.6e}", calibration.camera->matrix[r * n + c]);
        text += " " + s + ",";
      }
      text += "\n";
    }
    text += "]\n";
  }
  return text;
}

Included include_calibration(Config& config, const std::filesystem::path& config_file, Includer includer) {
  Included out;
  const ConfigSection table = config.root().section("calibration");
  if (!config.root().has("calibration")) return out;
  const auto from = table.text("from");
  if (!from) throw ConfigError(table.where("from"), "is missing; it names the file that calibrate wrote.");
  out.file = std::filesystem::path(*from).is_absolute() ? std::filesystem::path(*from)
                                                        : config_file.parent_path() / *from;
  Calibration measured;
  try {
    measured = read_calibration(out.file);
  } catch (const InputError&) {
    throw InputError(table.where("from"), fmt::format("'{}' cannot be read.", out.file.string()));
  }
  // The covariance is that of the measured camera. It does not apply if the configuration states one of its
  // numbers itself.
  if (std::none_of(kOfCamera.begin(), kOfCamera.end(),
                   [&](const char* name) { return states(config, name); }))
    out.camera = measured.camera;
  Config lower = Config::from_file(out.file);
  for (const Quantity& q : quantities()) {
    if (!measured.find(q.name) || !(includer == Includer::cell ? q.in_cell : q.in_scene)) continue;
    bool stated = states(config, q.name);
    for (const Group& g : kGroups) {
      if (std::find(g.words.begin(), g.words.end(), q.name) == g.words.end()) continue;
      const auto said = static_cast<std::size_t>(
          std::count_if(g.words.begin(), g.words.end(), [&](const auto& w) { return states(config, w); }));
      stated = stated || said >= g.enough;
    }
    if (stated) {
      out.overridden.push_back(q.name);
    } else {
      config.adopt(lower, q.name + ".value", q.name);
      out.taken.push_back(q.name);
    }
  }
  config.erase("calibration");
  return out;
}

}  // namespace twincell
