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

#include "trajectory/units.hpp"

namespace twincell {

/// How a length or a time is stated.
enum class CameraUnit {
  reduced,   ///< sigma, t0
  physical,  ///< mm, us
  bare       ///< no unit: reduced, unless the trajectory has a laboratory's scale
};

/// The camera. check() is called by all users, reduced() by those who know the trajectory.
struct CameraOptions {
  // Geometry
  double pixels_per_sigma = 15;
  double margin_px = 20;
  double max_height = 0;
  CameraUnit max_height_unit = CameraUnit::reduced;
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
  CameraUnit exposure_unit = CameraUnit::reduced;
  double trigger_offset = 0;
  CameraUnit trigger_offset_unit = CameraUnit::reduced;
  double trigger_jitter = 0;
  CameraUnit trigger_jitter_unit = CameraUnit::reduced;
  double drop = 0;
  double doubled = 0;

  std::uint64_t seed = 1;  ///< of everything that chance decides

  /// \throws ConfigError naming the option and its bound
  void check() const;
  /// The same with every length and time in sigma and t0.
  /// \throws ConfigError for laboratory units without the part of the scale that converts them, and for a
  ///         number without a unit, not 0, where the scale says sigma
  [[nodiscard]] CameraOptions reduced(const Scale& scale) const;
};

/// One option: its name on the command line (in a CAMERA.toml with underscores), what it means, where it is
/// kept and its bounds or words.
struct CameraOption {
  std::string key, help;
  std::variant<double*, int*, bool*, std::string*> value;
  double lower = 0, upper = 0;
  std::vector<std::string> words;
  CameraUnit* stated_in = nullptr;        ///< of a length or time: where its unit is kept,
  CameraUnit unit = CameraUnit::reduced;  ///< and the one that this spelling means

  /// Whether its value is the one that is kept: of the spellings of a length or time one is.
  [[nodiscard]] bool kept() const { return stated_in == nullptr || *stated_in == unit; }
};

/// The list: command line, CAMERA.toml, check and documentation are made from it. To add an option: a member
/// above and a line there.
std::vector<CameraOption> camera_option_list(CameraOptions& options);

/// Reads a CAMERA.toml; absent keys keep their defaults. \throws InputError, ConfigError
CameraOptions read_camera(const std::filesystem::path& file);

/// All options as a CAMERA.toml.
std::string camera_text(const CameraOptions& options);

}  // namespace twincell
