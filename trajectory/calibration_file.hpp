#pragma once
/// \file
/// Calibration results with their standard errors: the TOML file that `calibrate` writes and that scenes and
/// cells include.
///
///     [camera.pixels_per_sigma]
///     value = 15.0012
///     standard_error = 0.0016
///     unit = "px"
///     method = "distance of the side walls over cell.width"
///     data = "sha256:9f2c..."
///
/// Each quantity has the same name as the key of a CELL.toml or a scene that it sets. To add a quantity, add
/// a line to the list in calibration_file.cpp.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config.hpp"

namespace twincell {

/// A quantity that can be measured.
struct Quantity {
  std::string name;       ///< "camera.pixels_per_sigma"
  std::string unit;       ///< "px"; "1" for a ratio or a count
  std::size_t count = 1;  ///< number of values: 1, or 2 for a list
  bool whole = false;     ///< the value is an integer
  bool in_cell = false;   ///< a CELL.toml accepts it
  bool in_scene = false;  ///< a scene accepts it
};
/// All quantities, in the order in which a calibration file lists them.
const std::vector<Quantity>& quantities();

/// A measured quantity.
struct Measurement {
  std::string name;
  std::vector<double> value;
  std::vector<double> standard_error;  ///< as many as values; NaN: the data give no error
  std::string method;                  ///< method of the measurement, in a few words
  std::string data;                    ///< "sha256:..." of the stack or file it was measured on
};

/// Covariance matrix of several numbers. The camera's are pixels_per_sigma, origin_px x and y, rotation_deg
/// and distortion.
struct MeasuredCovariance {
  std::vector<std::string> names;
  std::vector<double> matrix;  ///< [names x names], row-major
};

/// Content of a calibration file.
struct Calibration {
  std::vector<Measurement> measured;  ///< in the order of quantities()
  std::optional<MeasuredCovariance> camera;

  /// The measurement of quantity `name`; nullptr if it was not measured.
  [[nodiscard]] const Measurement* find(const std::string& name) const;
  /// Inserts a measurement, or replaces an earlier one of the same name.
  /// \pre its name is one of quantities()
  void put(Measurement fresh);
};

/// Reads a calibration file.
/// \throws InputError if the file cannot be read; ConfigError naming file, line and key for an unknown key, a
/// wrong type or unit, a negative error, a number of errors that differs from the number of values, or an
/// invalid covariance matrix
Calibration read_calibration(const std::filesystem::path& file);
/// The calibration as the text of a file.
/// \param head comment in the first line: what created the file
std::string calibration_text(const Calibration& calibration, const std::string& head);

/// Result of include_calibration.
struct Included {
  std::filesystem::path file;                ///< empty: the configuration includes no file
  std::vector<std::string> taken;            ///< quantities that were copied into the configuration
  std::vector<std::string> overridden;       ///< quantities that the configuration sets itself
  std::optional<MeasuredCovariance> camera;  ///< absent if the configuration states one of its quantities
};

/// Kind of configuration that includes a calibration.
enum class Includer { cell, scene };

/// Resolves `[calibration] from = "FILE"` (relative to the folder of `config_file`). Each quantity that a
/// cell or a scene accepts is copied into the configuration, unless the configuration sets that key itself.
/// Two of the six drive keys in the configuration override all measured drive keys. One of the three damping
/// keys of a contact overrides the measured ones, and likewise for contacts with walls. The table
/// [calibration] is then removed. Error messages about a copied number name its file and line.
/// \throws as read_calibration
Included include_calibration(Config& config, const std::filesystem::path& config_file, Includer includer);

}  // namespace twincell
