#pragma once
/// \file
/// Everything that can be set about the synthetic camera, in one list.
///
/// Grey levels are those of an 8-bit picture whatever the depth of the output: with `bits` = 12 the same
/// scene is the same light, counted sixteen times finer.

#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace twincell {

/// The camera. check() is called by all users.
struct CameraOptions {
  // Geometry
  double pixels_per_sigma = 15;
  double margin_px = 20;
  double max_height = 0;
  double rotation_deg = 0;
  double distortion = 0;
  double left_tilt = 0, right_tilt = 0;
  // Optics and light
  double blur_px = 0.8;
  double backlight = 215;
  double vignetting = 0.1;
  double lamp_drift = 0;
  double lamp_flicker = 0;
  bool bright = false;
  // Sensor
  double electrons_per_level = 40;
  double read_noise = 1;
  double black_level = 0;
  int bits = 8;
  // Beads and dirt
  double tracer_darkness = 0.6;
  double glare = 0;
  double glare_share = 1;
  std::string glare_kind = "reflected";
  int dust = 0;
  int scratches = 0;
  // Shutter
  double exposure = 0;
  double trigger_offset = 0;
  double trigger_jitter = 0;
  double drop = 0;
  double doubled = 0;

  std::uint64_t seed = 1;  ///< of everything that chance decides

  /// \throws ConfigError naming the option and its bound
  void check() const;
};

/// One option: its name on the command line (in a CAMERA.toml with underscores), what it means, where it is
/// kept and its bounds or words.
struct CameraOption {
  std::string key, help;
  std::variant<double*, int*, bool*, std::string*> value;
  double lower = 0, upper = 0;
  std::vector<std::string> words;
};

/// The list: command line, CAMERA.toml, check and documentation are made from it. To add an option: a member
/// above and a line there.
std::vector<CameraOption> camera_option_list(CameraOptions& options);

/// Reads a CAMERA.toml; absent keys keep their defaults. \throws InputError, ConfigError
CameraOptions read_camera(const std::filesystem::path& file);

/// All options as a CAMERA.toml.
std::string camera_text(const CameraOptions& options);

}  // namespace twincell
