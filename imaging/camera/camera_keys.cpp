#include "imaging/camera/camera_keys.hpp"

#include <fmt/format.h>

#include "imaging/camera/options.hpp"

namespace twincell::imaging {

namespace {

std::vector<KeyRow> rows() {
  std::vector<KeyRow> all;
  CameraOptions defaults;
  for (const CameraOption& option : camera_option_list(defaults))
    all.push_back({option.toml_key(), option.symbol == "sigma" ? "σ" : option.symbol,
                   option.unit == CameraUnit::physical ? "" : option.toml_value(), option.example,
                   option.help});
  all.push_back({"seed", "", fmt::format("{}", defaults.seed), "7",
                 "Seed of all random numbers; --seed on the command line"});
  return all;
}

}  // namespace

const KeyTable& camera_keys() {
  static const KeyTable table{
      .name = "camera",
      .title = "CAMERA.toml",
      .intro =
          "The synthetic camera of `render --camera` (docs/camera.md). On the command line each key is an "
          "option: `trigger_jitter_us = 90` is `--trigger-jitter-us 90`. Grey levels are those of an 8-bit "
          "picture, whatever `bits` is.",
      .notes = {},
      .rows = rows(),
      .read = [](const std::vector<std::string>& assignments) {
        std::string text;
        for (const std::string& assignment : assignments) text += assignment + "\n";
        (void)read_camera_text(text, "an example");
      }};
  return table;
}

}  // namespace twincell::imaging
