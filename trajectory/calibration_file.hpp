#pragma once
/// \file
/// Measurement numbers with their errors: the small TOML that `calibrate` writes and that scenes and cells
/// include.
///
///     [camera.pixels_per_sigma]
///     value = 15.0012
///     standard_error = 0.0016
///     unit = "px"
///     method = "distance of the side walls over cell.width"
///     data = "sha256:9f2c..."
///
/// A quantity is called as the key of a CELL.toml or a scene that it speaks for. To add one: a line in the
/// list of calibration_file.cpp.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config.hpp"

namespace twincell {

/// What can be measured.
struct Quantity {
  std::string name;       ///< "camera.pixels_per_sigma"
  std::string unit;       ///< "px"; "1" for a ratio or a count
  std::size_t count = 1;  ///< numbers: 1, or 2 for a list
  bool whole = false;     ///< a whole number
  bool in_cell = false;   ///< a CELL.toml takes it
  bool in_scene = false;  ///< a scene takes it
};
const std::vector<Quantity>& quantities();

/// One of them, measured.
struct Measurement {
  std::string name;
  std::vector<double> value;
  std::vector<double> standard_error;  ///< as many; NaN: the data give none
  std::string method;                  ///< how, in a few words
  std::string data;                    ///< "sha256:..." of the stack or file it was measured on
};

/// Covariance of several numbers; of camera: pixels_per_sigma, origin_px x and y, rotation_deg, distortion.
struct MeasuredCovariance {
  std::vector<std::string> names;
  std::vector<double> matrix;  ///< [names x names], row by row
};

/// What a calibration file holds.
struct Calibration {
  std::vector<Measurement> measured;  ///< in the order of quantities()
  std::optional<MeasuredCovariance> camera;

  /// The quantity of that name; nullptr if it was not measured.
  [[nodiscard]] const Measurement* find(const std::string& name) const;
  /// Puts it in, in place of an earlier one of its name. \pre its name is one of quantities()
  void put(Measurement fresh);
};

/// \throws InputError if the file cannot be read; ConfigError naming file, line and key for unknown keys,
/// types, a negative error, or as many errors as values are not there
Calibration read_calibration(const std::filesystem::path& file);
/// The file as text. \param head a comment: what made it
std::string calibration_text(const Calibration& calibration, const std::string& head);

/// What came of an inclusion.
struct Included {
  std::filesystem::path file;                ///< empty: the configuration includes none
  std::vector<std::string> taken;            ///< quantities that now stand in the configuration
  std::vector<std::string> overridden;       ///< quantities that the configuration states itself
  std::optional<MeasuredCovariance> camera;  ///< only if every number of it was taken, or stands for none
};

enum class Includer { cell, scene };

/// Resolves `[calibration] from = "FILE"` (relative to the folder of `config_file`): each quantity that a
/// cell or a scene knows takes its place unless the configuration states that key itself. Of the drive's six
/// words, and of the three that damp a contact, those stated displace those measured as far as they say the
/// same. The table [calibration] is gone afterwards. Complaints about an included number name the calibration
/// file and its line. \throws as read_calibration
Included include_calibration(Config& config, const std::filesystem::path& config_file, Includer includer);

}  // namespace twincell
