#pragma once
/// \file
/// Geometry of a filmed cell from its edges in many frames: positions and tilts of the walls, position of the
/// plate, rotation and radial distortion of the picture.
///
/// In the ideal picture (imaging/geometry/lens.hpp undone) the plate is level, at row y_p + its motion, and
/// the walls are the lines
///     x = x_l - tan(tilt_l) (y_p - y),    x = x_r + tan(tilt_r) (y_p - y).
/// Tilts count outward, as cell.side_tilt of a scene, and the feet of the walls move with the plate. The
/// rotation is that of the plate. All three edges contribute to the distortion k1.

#include <optional>
#include <string>
#include <vector>

#include "calibration/camera/stack_edges.hpp"
#include "calibration/fit/fit.hpp"
#include "imaging/geometry/pixel_point.hpp"

namespace twincell::calibration {

/// Systematic error of edges in px, from the model of light and blur; no number of points or frames averages
/// it away. Measured over synthetic stacks with uneven light and with blur, rotation and distortion of many
/// sizes (recovery.CellGeometry.FilmedCellsOfManyKindsComeBack). In even light and without distortion it is
/// 0.001 px.
inline constexpr double kEdgeModelError_px = 0.002;
/// Systematic error of the plate's heights in px. It is larger because beads leave the plate and land on it
/// at the same phases of every cycle.
inline constexpr double kHeightModelError_px = 0.004;

/// Distance of an edge point from the fitted edge, for the residual map.
struct EdgeResidual {
  imaging::PixelPoint at;
  double distance_px = 0;
};

/// Measured height of the plate in one frame.
struct PlateSighting {
  double height_px = 0;  ///< upward from the mean plate row, in the ideal picture; NaN: not detected
  double sigma_px = 0;   ///< standard error from the scatter of the edge points
  std::size_t points = 0;
};

/// Fitted geometry of the cell.
struct CellGeometry {
  cv::Size size;
  bool has_plate = false, has_left = false, has_right = false;
  /// Contains the parameters that were fitted, out of "x_left", "tilt_left", "x_right", "tilt_right" (px,
  /// degrees), "rotation" (degrees), "distortion".
  FitReport fit;
  double plate_row = 0;                     ///< y_p, ideal picture, mean over the frames, px
  double plate_row_error = 0;               ///< its standard error if the frames cover whole cycles
  double plate_row_error_of_map = 0;        ///< share of it from rotation and distortion, equal in all frames
  double stretch_error = 0;                 ///< relative error of height differences, from the same two
  double rotation_deg = 0, distortion = 0;  ///< distortion is 0 unless it exceeds three standard errors
  std::optional<double> distortion_found, distortion_error;  ///< as fitted, used or not
  std::vector<PlateSighting> heights;                        ///< [frames]
  std::vector<EdgeResidual> residuals;
  double blur_px = 0;

  /// Plate height of each frame, px; NaN: not detected. Input of fit_drive.
  [[nodiscard]] std::vector<double> heights_px() const;
  /// Cell width x_right - x_left at the plate's mean height, and its standard error.
  /// \pre both walls were fitted
  [[nodiscard]] double width_px() const;
  [[nodiscard]] double width_error_px() const;
};

/// Fits walls, plate, rotation and distortion together. Points on beads and other outliers are always inside
/// the cell, so the edge is the outermost line that enough points share. Points of a wall in the same row are
/// averaged over the frames first, so that an error that is equal in every frame (dust) does not count as
/// many measurements. Standard errors come from the scatter of the points, with blocks one bead wide: within
/// a block the errors are correlated where a bead or dust obscures the light.
/// \throws InputError if neither the plate nor a wall is detected
CellGeometry fit_cell_geometry(const StackEdges& edges, bool with_distortion = true);

}  // namespace twincell::calibration
