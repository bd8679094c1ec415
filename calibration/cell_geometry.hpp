#pragma once
/// \file
/// Where walls and plate of a filmed cell lie, how the picture is turned and bent: from the edges of many
/// frames.
///
/// In the ideal picture (camera/lens.hpp undone) the plate is level, at row y_p + its motion, and the walls
/// are the lines
///     x = x_l - tan(tilt_l) (y_p - y),    x = x_r + tan(tilt_r) (y_p - y),
/// tilts outward, as a scene's cell.side_tilt; their feet ride on the plate. The turn is the plate's; the
/// bend k1 shows in all three.

#include <optional>
#include <string>
#include <vector>

#include "analysis/trajectory/progress.hpp"
#include "calibration/fit.hpp"
#include "imaging/cell_edges.hpp"
#include "imaging/frame_source.hpp"

namespace twincell {

/// Edges of a whole stack: the plate's in every frame, the walls' in some forty.
struct StackEdges {
  cv::Size size;
  std::vector<std::vector<EdgePoint>> plate;        ///< [frames]
  std::vector<std::vector<EdgePoint>> left, right;  ///< [frames 0, stride, 2 stride ...]
  std::size_t stride = 1;
  std::vector<double> time_s;  ///< of each frame, by the camera's stamps; empty if it has none
  double blur_px = 0;          ///< median over frames
};
/// Reads the stack once. \throws InputError as FrameSource
StackEdges read_stack_edges(FrameSource& frames, bool bright, double diameter_px, int threads,
                            Progress& progress = Progress::none());

/// Distance of a point from the fitted edge, for the map of residuals.
struct EdgeResidual {
  PixelPoint at;
  double distance_px = 0;
};

/// The plate in one frame.
struct PlateSighting {
  double height_px = 0;  ///< up, in the ideal picture, from the row of its centre's mean; NaN: not seen
  double sigma_px = 0;   ///< standard error from the scatter of its points
  std::size_t points = 0;
};

/// What the edges say.
struct CellGeometry {
  cv::Size size;
  bool has_plate = false, has_left = false, has_right = false;
  /// Of those that were fitted: "x_left", "tilt_left", "x_right", "tilt_right" (px, degrees), "rotation"
  /// (degrees), "distortion".
  FitReport fit;
  double plate_row = 0;                     ///< y_p, ideal picture, mean over the frames, px
  double plate_row_error = 0;               ///< its standard error if the frames cover whole cycles
  double rotation_deg = 0, distortion = 0;  ///< distortion is 0 where the data do not ask for one
  std::optional<double> distortion_found, distortion_error;  ///< as fitted, used or not
  std::vector<PlateSighting> heights;                        ///< [frames]
  std::vector<EdgeResidual> residuals;
  double blur_px = 0;

  /// x_right - x_left at the plate's mean height, and its standard error. \pre both walls are there
  [[nodiscard]] double width_px() const;
  [[nodiscard]] double width_error_px() const;
};

/// Fits them all together. Points on beads and other outliers are told from the edge by lying inside the
/// cell: the outermost line that enough points share is the edge. Points of one wall's row are averaged over
/// the frames before they count, so that what is the same in every frame (dust) is not taken for many
/// measurements. \param floor_px what no number of points can average away, uneven light beside an edge above
/// all: it enters the
///     errors of the walls' places and of the plate's row \throws InputError if neither plate nor a wall is
///     seen
CellGeometry fit_cell_geometry(const StackEdges& edges, bool with_distortion = true, double floor_px = 0.015);

}  // namespace twincell
