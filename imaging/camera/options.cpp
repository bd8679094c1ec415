#include "imaging/camera/options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/trajectory/config.hpp"
#include "analysis/trajectory/error.hpp"

namespace twincell {

std::vector<CameraOption> camera_option_list(CameraOptions& o) {
  return {
      {"pixels-per-sigma", "Camera pixels per bead diameter", &o.pixels_per_sigma, 3, 400, {}},
      {"margin", "Wall shown around the cell, px", &o.margin_px, 0, 1000, {}},
      {"max-height", "Height shown, sigma; 0: as high as beads get", &o.max_height, 0, 1e6, {}},
      {"rotation",
       "Turn of the picture about its middle, degrees, counter-clockwise",
       &o.rotation_deg,
       -180,
       180,
       {}},
      {"distortion",
       "Radial distortion k1: a point at distance r from the middle, in half diagonals, is seen at r (1 + k1 "
       "r^2)",
       &o.distortion,
       -0.2,
       0.2,
       {}},
      {"left-tilt",
       "Lean of the left wall, degrees outward, about its foot on the plate; 0: as the trajectory says",
       &o.left_tilt,
       -30,
       30,
       {}},
      {"right-tilt", "Lean of the right wall, likewise", &o.right_tilt, -30, 30, {}},
      {"blur", "Blur of the optics, standard deviation, px", &o.blur_px, 0.2, 5, {}},
      {"backlight", "Grey levels of the light in the middle", &o.backlight, 1, 255, {}},
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
      {"bright", "Light from the front: bright beads, walls and plate on black", &o.bright, 0, 0, {}},
      {"electrons-per-level",
       "Shot noise: electrons in one grey level; 0: none",
       &o.electrons_per_level,
       0,
       1e9,
       {}},
      {"read-noise", "Noise of the electronics, grey levels, standard deviation", &o.read_noise, 0, 50, {}},
      {"black-level", "Grey level without light", &o.black_level, 0, 100, {}},
      {"bits", "Depth of the picture: 8, 10, 12, 14 or 16", &o.bits, 8, 16, {}},
      {"tracer-darkness", "Darkness of a tracer disc", &o.tracer_darkness, 0.4, 1, {}},
      {"glare", "Brightest level of a spot of light on a bead, share of the light", &o.glare, 0, 2, {}},
      {"glare-share", "Share of the beads that have one", &o.glare_share, 0, 1, {}},
      {"glare-kind",
       "Where it sits: reflected (upper left, as from a lamp in front) or transmitted (the middle)",
       &o.glare_kind,
       0,
       0,
       {"reflected", "transmitted"}},
      {"dust", "Specks on the glass", &o.dust, 0, 10000, {}},
      {"scratches", "Scratches on the glass", &o.scratches, 0, 1000, {}},
      {"exposure", "Motion blur: exposure, t0, centred on the moment", &o.exposure, 0, 1e6, {}},
      {"trigger-offset", "Every picture is taken this much too late, t0", &o.trigger_offset, -1e6, 1e6, {}},
      {"trigger-jitter", "Scatter of the moment, t0, standard deviation", &o.trigger_jitter, 0, 1e6, {}},
      {"drop", "Probability that a frame is lost", &o.drop, 0, 0.9, {}},
      {"double", "Probability that a frame is stored twice", &o.doubled, 0, 0.9, {}},
  };
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
    check_option(option, Where{.file = {}, .key = option.key});
  if (bits % 2 != 0)
    throw ConfigError(Where{.file = {}, .key = "bits"},
                      fmt::format("is {}; cameras have 8, 10, 12, 14 or 16.", bits));
}

CameraOptions read_camera(const std::filesystem::path& file) {
  const Config config = Config::from_file(file);
  const ConfigSection root = config.root();
  CameraOptions options;
  for (const CameraOption& option : camera_option_list(options)) {
    const std::string key = toml_key(option.key);
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
