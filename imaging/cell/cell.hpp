#pragma once
/// \file
/// CELL.toml: description of a filmed cell.
///
///     [camera]
///     pixels_per_sigma = 15.0      # camera pixels per bead diameter
///     scale_error_px = 0.002       # standard error of pixels_per_sigma
///     disc_width_px = 15.2         # width of the discs of beads of one sigma, if glare or exposure moves
///     their rims origin_px = [40.0, 560.0]    # lower-left inside corner, plate at its mean height
///     frames_per_cycle = 20        # 0 or absent: not phase-locked
///     first_phase = 0              # phase of the first frame
///     phase_offset = 0.0           # delay of every frame after its nominal phase, in frames
///     rotation_deg = 0.0           # rotation of the picture about its centre, counter-clockwise
///     distortion = 0.0             # k1: a point at r, in half diagonals, appears at r (1 + k1 r^2)
///     bright = false               # discs brighter than their surroundings
///     refine = "profile"           # method that suits these discs
///     frame_rate_hz = 1000.0       # overrides the rate that the stack states
///     [cell]
///     width_mm = 40.0              # between the side walls; or width_sigma
///     height_mm = 80.0             # or height_sigma
///     sides = "walls"              # "walls", "periodic" or "open"
///     side_tilt = [0.0, 0.0]       # outward tilt of the left and the right wall, degrees
///     [drive]                      # any two that determine A and omega, as in a scene
///     gamma = 2.0
///     amplitude_mm = 2.0
///     [scale]                      # without it, width, height and amplitude are in sigma
///     sigma_mm = 2.0
///     gravity_m_s2 = 9.81
///
///     [calibration]
///     from = "cell.calibration.toml"  # result of calibrate (calibration_file.hpp); keys above override it
///
/// Every key may be absent; an unknown key is an error. If there is a rotation or a distortion, origin_px
/// refers to the ideal picture without them.

#include <array>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "imaging/geometry/pixel_frame.hpp"
#include "imaging/phase/phase_lock.hpp"
#include "trajectory/box.hpp"
#include "trajectory/calibration_file.hpp"
#include "trajectory/drive.hpp"
#include "trajectory/unit_checks.hpp"
#include "trajectory/units.hpp"

namespace twincell::imaging {

/// Description of a cell. Absent values are unknown.
struct CellDescription {
  std::optional<double> pixels_per_sigma;  ///< > 0
  std::optional<double> scale_error_px;    ///< standard error of pixels_per_sigma, >= 0
  std::optional<double> disc_width_px;     ///< of beads of one sigma; absent: pixels_per_sigma
  std::optional<PixelPoint> origin;        ///< px
  double rotation_deg = 0;                 ///< of the picture, counter-clockwise
  double distortion = 0;                   ///< k1 (geometry/lens.hpp)
  PhaseLock phase_lock;
  bool bright = false;
  std::optional<std::string> refine;               ///< one of refiner_names()
  std::optional<double> frame_rate_hz;             ///< > 0
  std::optional<double> width, height;             ///< sigma, > 0
  std::optional<std::array<double, 2>> side_tilt;  ///< degrees outward, left and right
  Boundary sides = Boundary::wall;
  DriveSpec drive_spec;             ///< empty: unknown
  std::vector<Harmonic> harmonics;  ///< of the drive; empty: a sine
  Scale scale;                      ///< pixels_per_sigma is not repeated here
  Included included;                ///< values taken from a calibration
  std::string text;                 ///< the resolved configuration as TOML, for provenance

  /// Width in the picture of a bead of one sigma, if it is stated.
  [[nodiscard]] std::optional<double> disc_px() const {
    return disc_width_px ? disc_width_px : pixels_per_sigma;
  }
  /// Map between a picture of this size and the cell.
  /// \pre origin and pixels_per_sigma are known
  [[nodiscard]] PixelFrame pixel_frame(cv::Size picture) const {
    return pixel_frame(picture, *pixels_per_sigma, *origin);
  }
  /// The same with scale and origin given.
  [[nodiscard]] PixelFrame pixel_frame(cv::Size picture, double scale_px, PixelPoint zero) const;
  /// A, omega and the harmonics; absent if no drive is stated.
  /// \throws ConfigError as solve_drive
  [[nodiscard]] std::optional<Drive> drive() const;
  /// The numbers whose units can be checked, as far as they are stated (trajectory/unit_checks.hpp).
  [[nodiscard]] ShakenCell shaken_cell() const;
};

/// Reads a CELL.toml and applies the assignments "section.key=value" to it. Without a file, only the
/// assignments are read.
/// \throws InputError if the file cannot be read, ConfigError for syntax, unknown keys, types and bounds
CellDescription read_cell(const std::filesystem::path& file,
                          const std::vector<std::string>& assignments = {});

}  // namespace twincell::imaging
