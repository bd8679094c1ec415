#pragma once
/// \file
/// The experiment's camera, imitated: a trajectory becomes frames with known truth.
///
/// Back-lit opaque discs, walls and plate. A pixel's light is
///     lamp B(x, y) glass(x, y) walls(x, y) max(0, 1 - sum_k a_k D_k) + glare,
/// with D_k a disc convolved exactly with the Gaussian of the optics, averaged over the pixel's square
/// (camera/disc_image.hpp) and over the disc's path during the exposure (camera/shutter.hpp); in three
/// dimensions discs hide each other and the bracket is prod_k (1 - a_k D_k). Then the sensor
/// (camera/sensor.hpp). No formula is shared with the fit of picture_fit.hpp, which takes the edge as
/// straight.
///
/// Turn and distortion (camera/lens.hpp) act on the scene; blur, pixels and dirt belong to the picture. The
/// truth is the picture of the disc's centre; under distortion the centre of the disc's picture leaves it by
/// 3 k1 R^2 v/u^2, with v the place from the middle and u half the diagonal: 0.006 px for 15 px discs, k1 =
/// 0.01 and u = 300 px, at the corner.

#include <array>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "core/output_kind.hpp"
#include "core/progress.hpp"
#include "imaging/camera/options.hpp"
#include "imaging/camera/shutter.hpp"
#include "imaging/geometry/lens.hpp"
#include "imaging/geometry/pixel_frame.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell {

/// A bead as it truly is in a picture, px.
struct TrueBead {
  std::size_t slot = 0;
  double x = 0, y = 0, radius = 0;
  double visible = 1;  ///< share of its rim inside the picture and not behind another bead
  bool tracer = false;
};

/// Frames as wide as the trajectory's box and its margin.
class SyntheticCamera {
 public:
  /// \throws ConfigError as CameraOptions::check, if the box has no size, or if the shutter needs paths that
  /// the trajectory does not give
  SyntheticCamera(const CameraOptions& options, const TrajectoryInfo& info);
  /// One frame, CV_8U or CV_16U; noise depends on seed and the frame's step alone. Slots without a bead are
  /// not drawn.
  [[nodiscard]] cv::Mat expose(const Moment& moment) const;
  [[nodiscard]] cv::Mat expose(const Frame& frame) const { return expose(Moment{.now = &frame}); }
  /// Expected grey levels, before the sensor.
  [[nodiscard]] cv::Mat1f light(const Moment& moment) const;
  /// What can be seen: beads whose centres lie in the picture, at the middle of the exposure.
  [[nodiscard]] std::vector<TrueBead> truth(const Moment& moment) const;
  /// Size of a frame, px.
  [[nodiscard]] cv::Size size() const { return size_; }
  /// The map of the ideal picture, without turn and distortion.
  [[nodiscard]] const PixelFrame& pixel_frame() const { return map_; }
  [[nodiscard]] const Lens& lens() const { return *lens_; }
  /// Degrees by which the side walls lean outward, left and right: the options', or else the trajectory's.
  [[nodiscard]] const std::array<double, 2>& side_tilt() const { return info_.box.side_tilt; }
  [[nodiscard]] const Shutter& shutter() const { return shutter_; }
  /// Radius in the ideal picture, px.
  [[nodiscard]] double radius_px(std::size_t slot) const;

 private:
  class Discs;
  /// Darkens what lies behind leaning walls, whose feet ride on the plate.
  void draw_leaning_walls(const Moment& moment, cv::Mat1f& share) const;
  void draw_plate(const Moment& moment, cv::Mat1f& share) const;
  [[nodiscard]] Vec3 place(const Moment& moment, std::size_t slot, double tau) const;

  CameraOptions options_;
  TrajectoryInfo info_;
  PixelFrame map_;
  cv::Size size_;
  Shutter shutter_;
  std::shared_ptr<const Lens> lens_;
  std::shared_ptr<const Discs> discs_;  // images of all radii
  cv::Mat1f backlight_;                 // grey levels; dirt included
  cv::Mat1f walls_;                     // share of light that side walls leave; empty: all
  cv::Mat2d ideal_;                     // (x, y) of a pixel in the ideal picture; empty: its own
};

/// The kind of output that a folder of rendered frames is.
inline Product rendered_stack() {
  return Product::whole_folder("a rendered stack");
}

/// What to write and how.
struct RenderJob {
  std::filesystem::path
      folder;  ///< frame_00000.png ..., truth.csv, frames.csv, CELL.toml, CAMERA.toml; empty: none
  std::filesystem::path movie;    ///< .mp4 or .avi, 8 bit; empty: none
  double frames_per_second = 25;  ///< of the movie
  int threads = 1;                ///< the same bytes for any number
};

/// What was done.
struct Rendered {
  std::size_t frames = 0;   ///< written
  std::size_t dropped = 0;  ///< lost on purpose
  std::size_t doubled = 0;  ///< written twice on purpose
};

/// Films a trajectory; outputs appear whole or not at all. \throws ConfigError, RunError
Rendered render(const TrajectorySource& trajectory, const CameraOptions& options, const RenderJob& job,
                Progress& progress = Progress::none());

/// The same into a folder, in one thread. \returns number of frames
std::size_t render(const TrajectorySource& trajectory, const CameraOptions& options,
                   const std::filesystem::path& folder, Progress& progress = Progress::none());

}  // namespace twincell
