#pragma once
/// \file
/// The experiment's camera, imitated: a trajectory becomes frames with known truth.
///
/// Back-lit opaque discs, walls and plate. The light that reaches a pixel is B(x, y) (1 - sum P), with P a
/// disc convolved exactly (by quadrature) with a Gaussian of variance blur^2 + 1/12 (the pixel's own area).
/// It shares no formula with the fit of refine.hpp, which takes the edge as straight.

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>

#include "analysis/trajectory/progress.hpp"
#include "analysis/trajectory/trajectory.hpp"
#include "imaging/pixel_frame.hpp"

namespace twincell {

/// The camera. Check() is called by all users.
struct CameraOptions {
  double pixels_per_sigma = 15;     ///< 3 .. 400
  double margin_px = 20;            ///< around the cell, shows walls and plate, 0 .. 1000
  double blur_px = 0.8;             ///< standard deviation of the optics, 0.2 .. 5
  double backlight = 215;           ///< grey levels in the middle, 1 .. 255
  double vignetting = 0.1;          ///< relative loss of light in the corners, 0 .. 0.9
  double electrons_per_level = 40;  ///< shot noise: variance = I / this; 0: none
  double read_noise = 1;            ///< grey levels, standard deviation, 0 .. 50
  double tracer_darkness = 0.6;     ///< darkness of a tracer disc, 0.4 .. 1
  double exposure = 0;              ///< t0; > 0 needs velocities, and smears along them
  double max_height = 0;            ///< sigma shown above the plate; 0: the box's height, in render() the
                                    ///< highest bead of the trajectory and two more
  std::uint64_t seed = 1;           ///< of the noise
  void check() const;               ///< \throws ConfigError
};

/// Frames as wide as the trajectory's box and its margin.
class SyntheticCamera {
 public:
  /// \throws ConfigError as CameraOptions::check, or if the box has no size
  SyntheticCamera(const CameraOptions& options, const TrajectoryInfo& info);
  /// One frame; noise depends on seed and frame.step alone. Slots without a bead are not drawn.
  [[nodiscard]] cv::Mat1b expose(const Frame& frame) const;
  /// Size of a frame, px.
  [[nodiscard]] cv::Size size() const { return size_; }
  [[nodiscard]] const PixelFrame& pixel_frame() const { return map_; }
  [[nodiscard]] double radius_px(std::size_t slot) const;

 private:
  CameraOptions options_;
  TrajectoryInfo info_;
  PixelFrame map_;
  cv::Size size_;
};

/// Writes frame_00000.png ..., truth.csv and CELL.toml into a folder, whole or not at all. \returns number of
/// frames
std::size_t render(const TrajectorySource& trajectory, const CameraOptions& options,
                   const std::filesystem::path& folder, Progress& progress = Progress::none());

}  // namespace twincell
