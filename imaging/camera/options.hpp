#pragma once
/// \file
/// All options of the synthetic camera, in one list.
///
/// Grey levels are those of an 8-bit picture, whatever the depth of the output: with `bits` = 12 the same
/// scene gives the same light, resolved sixteen times finer.

#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "trajectory/units.hpp"

namespace twincell::imaging {

/// Unit in which a length or a time is given.
enum class CameraUnit {
  reduced,   ///< sigma, t0
  physical,  ///< mm, us
  bare       ///< no unit: reduced; an error if the trajectory has a laboratory scale
};

/// The camera. All callers use check(); callers that have the trajectory also use reduced().
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

  std::uint64_t seed = 1;  ///< of all random numbers

  /// \throws ConfigError naming the option and its bound
  void check() const;
  /// The same options with every length and time in sigma and t0.
  /// \throws ConfigError for a laboratory unit if the scale lacks the value that converts it, and for a
  ///   nonzero number without a unit if the scale states sigma
  [[nodiscard]] CameraOptions reduced(const Scale& scale) const;
};

/// One option: its name on the command line (with underscores in a CAMERA.toml), unit, an example, its
/// meaning, the variable that stores it, and its bounds or allowed words.
struct CameraOption {
  std::string key;
  std::string symbol;   ///< of its unit: "px"; "1" for a ratio; empty for words, switches and counts
  std::string example;  ///< a TOML value
  std::string help;
  std::variant<double*, int*, bool*, std::string*> value;
  double lower = 0, upper = 0;
  std::vector<std::string> words;
  CameraUnit* stated_in = nullptr;        ///< for a length or time: the variable that stores its unit
  CameraUnit unit = CameraUnit::reduced;  ///< for a length or time: the unit that this spelling implies

  /// Whether this spelling is the one in use. Of the spellings of a length or time, exactly one is in use.
  [[nodiscard]] bool kept() const { return stated_in == nullptr || *stated_in == unit; }
  /// The help, and the unit unless the value is a ratio or has none.
  [[nodiscard]] std::string help_with_unit() const;
  /// The key in a CAMERA.toml, and its present value there.
  [[nodiscard]] std::string toml_key() const;
  [[nodiscard]] std::string toml_value() const;
};

/// The list from which the command line, CAMERA.toml, check() and the documentation are made. To add an
/// option, add a member to CameraOptions and a line to this list.
std::vector<CameraOption> camera_option_list(CameraOptions& options);

/// Reads a CAMERA.toml; absent keys keep their defaults.
/// \throws InputError, ConfigError
CameraOptions read_camera(const std::filesystem::path& file);
/// The same from text.
/// \param name for messages
CameraOptions read_camera_text(const std::string& text, const std::string& name);

/// All options as the text of a CAMERA.toml.
std::string camera_text(const CameraOptions& options);

}  // namespace twincell::imaging
