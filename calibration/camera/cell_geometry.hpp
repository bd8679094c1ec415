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

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/fit/fit.hpp"
#include "core/progress.hpp"
#include "imaging/cell/cell_edges.hpp"
#include "imaging/stack/frame_source.hpp"

namespace twincell {

/// What edges may be off by in a way that no number of points or frames averages away, px: the model of light
/// and blur. Measured over synthetic stacks with uneven light, blur, turn and bend of many sizes
/// (recovery.CellGeometry.FilmedCellsOfManyKindsComeBack); in even light and without a bend it is 0.001 px.
inline constexpr double kEdgeModelError_px = 0.002;
/// Likewise of the plate's heights, beside which beads leave and land at the same phases of every cycle.
inline constexpr double kHeightModelError_px = 0.004;

/// Edges of a whole stack: the plate's in every frame, the walls' in some forty.
struct StackEdges {
  cv::Size size;
  std::vector<std::vector<EdgePoint>> plate;        ///< [frames]
  std::vector<std::vector<EdgePoint>> left, right;  ///< [frames 0, stride, 2 stride ...]
  std::size_t stride = 1;
  std::vector<double> time_s;  ///< of each frame, by the camera's stamps; empty if it has none
  double blur_px = 0;          ///< median over frames
  double diameter_px = 15;     ///< of a bead: so far along an edge its points may err together
};
/// Diameter to read edges with: the known one, else that of the first frame's beads, else a usual one, px.
double diameter_for_edges(const std::filesystem::path& stack, bool bright, double known_px);
/// Frames per second: as the user states them, else by the camera's stamps, else as the stack says; nothing
/// where none does.
std::optional<double> frame_rate_of(std::optional<double> stated, const StackEdges& edges,
                                    const std::filesystem::path& stack);
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
  double plate_row = 0;               ///< y_p, ideal picture, mean over the frames, px
  double plate_row_error = 0;         ///< its standard error if the frames cover whole cycles
  double plate_row_error_of_map = 0;  ///< the part of it that turn and bend leave, the same in all frames
  double stretch_error = 0;           ///< relative error of differences of heights that they leave
  double rotation_deg = 0, distortion = 0;  ///< distortion is 0 where the data do not ask for one
  std::optional<double> distortion_found, distortion_error;  ///< as fitted, used or not
  std::vector<PlateSighting> heights;                        ///< [frames]
  std::vector<EdgeResidual> residuals;
  double blur_px = 0;

  /// Of each frame; NaN: not seen. What fit_drive takes.
  [[nodiscard]] std::vector<double> heights_px() const;
  /// x_right - x_left at the plate's mean height, and its standard error. \pre both walls are there
  [[nodiscard]] double width_px() const;
  [[nodiscard]] double width_error_px() const;
};

/// Fits them all together. Points on beads and other outliers are told from the edge by lying inside the
/// cell: the outermost line that enough points share is the edge. Points of one wall's row are averaged over
/// the frames before they count, so that what is the same in every frame (dust) is not taken for many
/// measurements. Errors are measured: from the scatter of the points, and of blocks one bead wide, which err
/// together where a bead or dust stands in the light. \throws InputError if neither plate nor a wall is seen
CellGeometry fit_cell_geometry(const StackEdges& edges, bool with_distortion = true);

}  // namespace twincell
