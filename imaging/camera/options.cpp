#include "imaging/camera/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

#include "core/config.hpp"
#include "core/error.hpp"
#include "trajectory/unit_keys.hpp"

namespace twincell {

namespace {

constexpr double kMostReduced = 1e6, kMostPhysical = 1e9;

/// Adds the three spellings of a length or time: without a unit, in reduced units, and in laboratory units.
void add_quantity(std::vector<CameraOption>& list, const std::string& key, const std::string& help,
                  double& value, CameraUnit& unit, const char* reduced, const char* physical,
                  bool both_ways = false) {
  const auto spelling = [&](const std::string& name, const std::string& text, CameraUnit means) {
    const double most = means == CameraUnit::physical ? kMostPhysical : kMostReduced;
    list.push_back({name, text, &value, both_ways ? -most : 0, most, {}, &unit, means});
  };
  const bool length = std::string_view(reduced) == "sigma";
  spelling(
      key,
      fmt::format("{}, {}; if the trajectory has a scale, use one of the next two options", help, reduced),
      CameraUnit::bare);
  spelling(key + "-" + reduced, fmt::format("{}, {}", help, reduced), CameraUnit::reduced);
  spelling(key + "-" + physical, fmt::format("{}, {}", help, length ? "mm" : "microseconds"),
           CameraUnit::physical);
}

}  // namespace

std::vector<CameraOption> camera_option_list(CameraOptions& o) {
  std::vector<CameraOption> list = {
      {"pixels-per-sigma", "Camera pixels per bead diameter", &o.pixels_per_sigma, 3, 400, {}},
      {"margin", "Width of the wall shown around the cell, px", &o.margin_px, 0, 1000, {}},
      {"rotation",
       "Rotation of the picture about its centre, degrees, counter-clockwise",
       &o.rotation_deg,
       -180,
       180,
       {}},
      {"distortion",
       "Radial distortion k1: a point at distance r from the centre, in half diagonals, appears at r (1 + k1 "
       "r^2)",
       &o.distortion,
       -0.2,
       0.2,
       {}},
      {"left-tilt",
       "Outward tilt of the left wall, degrees, about its foot on the plate; 0: as in the trajectory",
       &o.left_tilt,
       -30,
       30,
       {}},
      {"right-tilt", "Outward tilt of the right wall, likewise", &o.right_tilt, -30, 30, {}},
      {"blur", "Blur of the optics, standard deviation, px", &o.blur_px, 0.2, 5, {}},
      {"backlight", "Grey level of the light at the centre of the picture", &o.backlight, 1, 255, {}},
      {"vignetting", "Relative loss of light in the corners", &o.vignetting, 0, 0.9, {}},
      {"lamp-drift",
       "Relative change of the light from the first frame to the last",
       &o.lamp_drift,
       -0.9,
       0.9,
       {}},
      {"lamp-flicker",
       "Relative change of the light from frame to frame, standard deviation",
       &o.lamp_flicker,
       0,
       0.5,
       {}},
      {"bright", "Front light: bright beads, walls and plate on black", &o.bright, 0, 0, {}},
      {"electrons-per-level",
       "Shot noise: electrons per grey level; 0: no shot noise",
       &o.electrons_per_level,
       0,
       1e9,
       {}},
      {"read-noise", "Read noise, grey levels, standard deviation", &o.read_noise, 0, 50, {}},
      {"black-level", "Grey level without light", &o.black_level, 0, 100, {}},
      {"bits", "Bit depth of the picture: 8, 10, 12, 14 or 16", &o.bits, 8, 16, {}},
      {"tracer-darkness", "Darkness of a tracer disc", &o.tracer_darkness, 0.4, 1, {}},
      {"glare", "Peak level of a bright spot on a bead, share of the light", &o.glare, 0, 2, {}},
      {"glare-share", "Share of the beads that have a bright spot", &o.glare_share, 0, 1, {}},
      {"glare-kind",
       "Position of the spot: reflected (upper left, as from a lamp in front) or transmitted (the centre)",
       &o.glare_kind,
       0,
       0,
       {"reflected", "transmitted"}},
      {"dust", "Specks on the glass", &o.dust, 0, 10000, {}},
      {"scratches", "Scratches on the glass", &o.scratches, 0, 1000, {}},
      {"drop", "Probability that a frame is lost", &o.drop, 0, 0.9, {}},
      {"double", "Probability that a frame is stored twice", &o.doubled, 0, 0.9, {}},
  };
  add_quantity(list, "max-height", "Height shown (0: up to the highest bead)", o.max_height,
               o.max_height_unit, "sigma", "mm");
  add_quantity(list, "exposure", "Motion blur: exposure time, centred on the time of the picture", o.exposure,
               o.exposure_unit, "t0", "us");
  add_quantity(list, "trigger-offset", "Delay of every picture after the time of its frame", o.trigger_offset,
               o.trigger_offset_unit, "t0", "us", true);
  add_quantity(list, "trigger-jitter", "Scatter of the trigger time, standard deviation", o.trigger_jitter,
               o.trigger_jitter_unit, "t0", "us");
  return list;
}

namespace {

std::string toml_key(std::string key) {
  std::replace(key.begin(), key.end(), '-', '_');
  return key;
}

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

CameraOptions read_camera(const std::filesystem::path& file) {
  const Config config = Config::from_file(file);
  const ConfigSection root = config.root();
  CameraOptions options;
  std::map<const CameraUnit*, std::string> said;
  for (const CameraOption& option : camera_option_list(options)) {
    const std::string key = toml_key(option.key);
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

std::string camera_text(const CameraOptions& options) {
  CameraOptions copy = options;
  std::string text;
  for (const CameraOption& option : camera_option_list(copy)) {
    if (!option.kept()) continue;
    const std::string value = std::visit(
        [](auto* v) -> std::string {
          if constexpr (std::is_same_v<decltype(v), std::string*>)
            return fmt::format("\"{}\"", *v);
          else
            return fmt::format("{}", *v);
        },
        option.value);
    text += fmt::format("{} = {}  # {}\n", toml_key(option.key), value, option.help);
  }
  return text + fmt::format("seed = {}\n", options.seed);
}

}  // namespace twincell
