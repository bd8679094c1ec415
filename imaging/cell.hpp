#pragma once
/// \file
/// CELL.toml: what is known of a filmed cell.
///
///     [camera]
///     pixels_per_sigma = 15.0      # camera pixels per bead diameter
///     origin_px = [40.0, 560.0]    # lower-left inside corner, plate at its mean height
///     frames_per_cycle = 20        # 0 or absent: not phase-locked
///     first_phase = 0              # phase of the first frame
///     bright = false               # discs brighter than their surroundings
///     [cell]
///     width = 20.0                 # sigma, between the side walls
///     height = 40.0                # sigma
///     sides = "walls"              # "walls", "periodic" or "open"
///     [drive]                      # any two that determine A and omega, as in a scene
///     gamma = 2.0
///     amplitude = 1.0
///     [scale]
///     sigma_m = 0.002
///     gravity_m_s2 = 9.81
///
/// Every key may be absent; an unknown one is an error.

#include <filesystem>
#include <optional>
#include <string>

#include "analysis/trajectory/box.hpp"
#include "analysis/trajectory/drive.hpp"
#include "analysis/trajectory/units.hpp"
#include "imaging/phase_lock.hpp"
#include "imaging/pixel_frame.hpp"

namespace twincell {

/// The cell as far as it is known.
struct CellDescription {
  std::optional<double> pixels_per_sigma;  ///< > 0
  std::optional<PixelPoint> origin;        ///< px
  PhaseLock phase_lock;
  bool bright = false;
  std::optional<double> width, height;  ///< sigma, > 0
  Boundary sides = Boundary::wall;
  DriveSpec drive_spec;  ///< empty: unknown
  Scale scale;           ///< pixels_per_sigma is not repeated here
  std::string text;      ///< the file's own text, for provenance

  /// A and omega, if the drive is stated. \throws ConfigError as solve_drive
  [[nodiscard]] std::optional<Drive> drive() const;
};

/// Reads a CELL.toml. \throws InputError if it cannot be read, ConfigError for syntax, unknown keys, types
/// and bounds
CellDescription read_cell(const std::filesystem::path& file);

}  // namespace twincell
