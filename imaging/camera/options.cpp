#include "imaging/camera/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

#include "core/config.hpp"
#include "core/error.hpp"
#include "trajectory/unit_keys.hpp"

namespace twincell::imaging {

namespace {

constexpr double kMaxReduced = 1e6, kMaxPhysical = 1e9;

/// Adds the three spellings of a length or time: without a unit, in reduced units, and in laboratory units.
/// \param in_reduced, in_physical examples
void add_quantity(std::vector<CameraOption>& list, const std::string& key, const std::string& help,
                  double& value, CameraUnit& unit, const char* reduced, const char* in_reduced,
                  const char* physical, const char* in_physical, bool both_ways = false) {
  const auto spelling = [&](const std::string& name, const char* symbol, const char* example,
                            const std::string& text, CameraUnit means) {
    const double most = means == CameraUnit::physical ? kMaxPhysical : kMaxReduced;
    list.push_back({name, symbol, example, text, &value, both_ways ? -most : 0, most, {}, &unit, means});
  };
  const bool length = std::string_view(reduced) == "sigma";
  spelling(key, reduced, in_reduced,
           help + "; if the trajectory has a scale, use one of the next two options", CameraUnit::bare);
  spelling(key + "-" + reduced, reduced, in_reduced, help, CameraUnit::reduced);
  spelling(key + "-" + physical, length ? "mm" : "microseconds", in_physical, help, CameraUnit::physical);
}

}  // namespace

std::string CameraOption::help_with_unit() const {
  return symbol.empty() || symbol == "1" ? help : help + ", " + symbol;
}

std::string CameraOption::toml_key() const {
  std::string text = key;
  std::replace(text.begin(), text.end(), '-', '_');
  return text;
}

std::string CameraOption::toml_value() const {
  return std::visit(
      [](auto* v) -> std::string {
        if constexpr (std::is_same_v<decltype(v), std::string*>)
          return fmt::format("\"{}\"", *v);
        else
          return fmt::format("{}", *v);
      },
      value);
}

std::vector<CameraOption> camera_option_list(CameraOptions& o) {
  std::vector<CameraOption> list = {
      {"pixels-per-sigma", "px", "12.0", "Camera pixels per bead diameter", &o.pixels_per_sigma, 3, 400, {}},
      {"margin", "px", "40.0", "Width of the wall shown around the cell", &o.margin_px, 0, 1000, {}},
      {"rotation",
       "degrees",
       "2.0",
       "Rotation of the picture about its centre, counter-clockwise",
       &o.rotation_deg,
       -180,
       180,
       {}},
      {"distortion",
       "1",
       "0.01",
       "Radial distortion k1: a point at distance r from the centre, in half diagonals, appears at r (1 + k1 "
       "r^2)",
       &o.distortion,
       -0.2,
       0.2,
       {}},
      {"left-tilt",
       "degrees",
       "0.5",
       "Outward tilt of the left wall about its foot, which moves with the plate; 0: as in the trajectory",
       &o.left_tilt,
       -30,
       30,
       {}},
      {"right-tilt",
       "degrees",
       "0.5",
       "Outward tilt of the right wall, likewise",
       &o.right_tilt,
       -30,
       30,
       {}},
      {"blur",
       "px",
       "1.2",
       "Blur of the optics, standard deviation; the width of a pixel is added",
       &o.blur_px,
       0.2,
       5,
       {}},
      {"backlight", "grey levels", "180.0", "Light at the centre of the picture", &o.backlight, 1, 255, {}},
      {"vignetting", "1", "0.3", "Relative loss of light in the corners", &o.vignetting, 0, 0.9, {}},
      {"lamp-drift",
       "1",
       "-0.1",
       "Relative change of the light from the first frame to the last",
       &o.lamp_drift,
       -0.9,
       0.9,
       {}},
      {"lamp-flicker",
       "1",
       "0.02",
       "Relative change of the light from frame to frame, standard deviation",
       &o.lamp_flicker,
       0,
       0.5,
       {}},
      {"bright", "", "true", "Front light: bright beads, walls and plate on black", &o.bright, 0, 0, {}},
      {"electrons-per-level",
       "electrons",
       "10.0",
       "Shot noise: electrons per grey level; 0: no shot noise",
       &o.electrons_per_level,
       0,
       1e9,
       {}},
      {"read-noise", "grey levels", "2.0", "Read noise, standard deviation", &o.read_noise, 0, 50, {}},
      {"black-level", "grey levels", "5.0", "Level without light", &o.black_level, 0, 100, {}},
      {"bits",
       "bits",
       "12",
       "Depth of the picture: 8, 10, 12, 14 or 16; above 8 the PNG has 16 bit with values below 2^bits",
       &o.bits,
       8,
       16,
       {}},
      {"tracer-darkness",
       "1",
       "0.8",
       "Share of the light that a tracer disc absorbs",
       &o.tracer_darkness,
       0.4,
       1,
       {}},
      {"glare", "1", "0.5", "Peak level of a bright spot on a bead, share of the light", &o.glare, 0, 2, {}},
      {"glare-share", "1", "0.3", "Share of the beads that have a bright spot", &o.glare_share, 0, 1, {}},
      {"glare-kind",
       "",
       "\"transmitted\"",
       "Position of the spot: reflected (upper left, 0.13 R wide, as from a lamp in front) or transmitted "
       "(the centre, 0.25 R wide)",
       &o.glare_kind,
       0,
       0,
       {"reflected", "transmitted"}},
      {"dust", "", "20", "Specks on the glass, the same in every frame", &o.dust, 0, 10000, {}},
      {"scratches", "", "3", "Scratches on the glass, the same in every frame", &o.scratches, 0, 1000, {}},
      {"drop", "1", "0.01", "Probability that a frame is lost", &o.drop, 0, 0.9, {}},
      {"double", "1", "0.01", "Probability that a frame is stored twice", &o.doubled, 0, 0.9, {}},
  };
  add_quantity(list, "max-height", "Height shown (0: up to the highest bead)", o.max_height,
               o.max_height_unit, "sigma", "30.0", "mm", "60.0");
  add_quantity(list, "exposure", "Motion blur: exposure time, centred on the time of the picture", o.exposure,
               o.exposure_unit, "t0", "0.05", "us", "700.0");
  add_quantity(list, "trigger-offset", "Delay of every picture after the time of its frame", o.trigger_offset,
               o.trigger_offset_unit, "t0", "0.01", "us", "140.0", true);
  add_quantity(list, "trigger-jitter", "Scatter of the trigger time, standard deviation", o.trigger_jitter,
               o.trigger_jitter_unit, "t0", "0.01", "us", "90.0");
  return list;
}

namespace {

void check_option(const CameraOption& option, const Where& where) {
  if (const auto* number = std::get_if<double*>(&option.value))
    require_range(where, **number, option.lower, option.upper);
  else if (const auto* whole = std::get_if<int*>(&option.value))
    require_range(where, **whole, option.lower, option.upper);
  else if (const auto* word = std::get_if<std::string*>(&option.value);
           word && std::find(option.words.begin(), option.words.end(), **word) == option.words.end())
    throw ConfigError(where, fmt::format("is '{}'; it can be {}.", **word, fmt::join(option.words, " or ")));
}

}  // namespace

void CameraOptions::check() const {
  CameraOptions copy = *this;
  for (const CameraOption& option : camera_option_list(copy))
    if (option.kept()) check_option(option, Where{.file = {}, .key = option.key});
  if (bits % 2 != 0)
    throw ConfigError(Where{.file = {}, .key = "bits"},
                      fmt::format("is {}; it must be 8, 10, 12, 14 or 16.", bits));
}

CameraOptions CameraOptions::reduced(const Scale& scale) const {
  CameraOptions out = *this;
  const std::vector<CameraOption> all = camera_option_list(out);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const CameraOption& option = all[i];
    if (option.stated_in == nullptr || !option.kept() || option.unit == CameraUnit::reduced) continue;
    double& value = *std::get<double*>(option.value);
    const Where where{.file = {}, .key = option.key};
    if (option.unit == CameraUnit::physical)
      value = reduced_quantity(value, option.key.ends_with("-mm") ? Unit::length_mm : Unit::time_us, scale,
                               where);
    else if (value != 0 && scale.sigma_m)  // the two other spellings follow it in the list
      refuse_bare(where, value, "the trajectory's scale.sigma_m", all[i + 1].key, all[i + 2].key);
    *option.stated_in = CameraUnit::reduced;
  }
  return out;
}

namespace {

CameraOptions interpret(const Config& config) {
  const ConfigSection root = config.root();
  CameraOptions options;
  std::map<const CameraUnit*, std::string> said;
  for (const CameraOption& option : camera_option_list(options)) {
    const std::string key = option.toml_key();
    if (option.stated_in != nullptr) {
      if (!root.has(key)) continue;
      if (const auto [other, fresh] = said.emplace(option.stated_in, key); !fresh)
        throw ConfigError(root.where(key),
                          fmt::format("and {} set the same quantity; give only one of the two.",
                                      root.where(other->second).text()));
      *option.stated_in = option.unit;
    }
    std::visit(
        [&](auto* value) {
          using T = std::remove_pointer_t<decltype(value)>;
          if constexpr (std::is_same_v<T, double>)
            *value = root.number_in(key, option.lower, option.upper).value_or(*value);
          else if constexpr (std::is_same_v<T, int>)
            *value = static_cast<int>(root.integer_in(key, static_cast<std::int64_t>(option.lower),
                                                      static_cast<std::int64_t>(option.upper))
                                          .value_or(*value));
          else if constexpr (std::is_same_v<T, bool>)
            *value = root.boolean(key).value_or(*value);
          else
            *value = root.word(key, option.words).value_or(*value);
        },
        option.value);
  }
  options.seed = static_cast<std::uint64_t>(
      root.integer_in("seed", 0, INT64_MAX).value_or(static_cast<std::int64_t>(options.seed)));
  config.refuse_unknown_keys();
  options.check();
  return options;
}

}  // namespace

CameraOptions read_camera(const std::filesystem::path& file) {
  return interpret(Config::from_file(file));
}

CameraOptions read_camera_text(const std::string& text, const std::string& name) {
  return interpret(Config::from_text(text, name));
}

std::string camera_text(const CameraOptions& options) {
  CameraOptions copy = options;
  std::string text;
  for (const CameraOption& option : camera_option_list(copy)) {
    if (!option.kept()) continue;
    text += fmt::format("{} = {}  # {}\n", option.toml_key(), option.toml_value(), option.help_with_unit());
  }
  return text + fmt::format("seed = {}\n", options.seed);
}

}  // namespace twincell::imaging
