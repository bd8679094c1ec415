#pragma once
/// \file
/// Synthetic camera: renders a trajectory to frames with known truth.
///
/// The scene consists of back-lit opaque discs, walls and plate. The light of a pixel is
///     lamp B(x, y) glass(x, y) walls(x, y) max(0, 1 - sum_k a_k D_k) + glare,
/// with D_k a disc convolved exactly with the Gaussian of the optics, averaged over the pixel's square
/// (camera/disc_image.hpp) and over the disc's path during the exposure (camera/shutter.hpp). In three
/// dimensions discs hide each other, and the factor max(...) is prod_k (1 - a_k D_k). The sensor
/// (camera/sensor.hpp) follows. No formula is shared with the fit of picture_fit.hpp, which approximates the
/// edge as straight.
///
/// Rotation and distortion (geometry/lens.hpp) act on the scene; blur, pixels and dirt belong to the picture.
/// The truth is the image of the disc's centre. Under distortion the centre of the disc's image differs from
/// it by 3 k1 R^2 v/u^2, with v the position relative to the centre of the picture and u half the diagonal:
/// 0.006 px for 15 px discs, k1 = 0.01 and u = 300 px, at the corner.

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

namespace twincell::imaging {

/// True position and size of a bead in a picture, px.
struct TrueBead {
  std::size_t slot = 0;
  double x = 0, y = 0, radius = 0;
  double visible = 1;  ///< share of its rim that is inside the picture and not covered by another bead
  bool tracer = false;
};

/// Renders frames as wide as the trajectory's box plus the margin on both sides.
class SyntheticCamera {
 public:
  /// \throws ConfigError as CameraOptions::check, if the frame would be empty or larger than 20000 px, or if
  ///   the shutter needs paths that the trajectory does not provide
  SyntheticCamera(const CameraOptions& options, const TrajectoryInfo& info);
  /// One frame, CV_8U or CV_16U. The noise depends only on the seed and the frame's step. Slots without a
  /// bead are not drawn.
  [[nodiscard]] cv::Mat expose(const Exposure& exposure) const;
  [[nodiscard]] cv::Mat expose(const Frame& frame) const { return expose(Exposure{.now = &frame}); }
  /// Expected grey levels before the sensor.
  [[nodiscard]] cv::Mat1f light(const Exposure& exposure) const;
  /// The visible beads: those with their centres inside the picture, at the middle of the exposure.
  [[nodiscard]] std::vector<TrueBead> truth(const Exposure& exposure) const;
  /// Size of a frame, px.
  [[nodiscard]] cv::Size size() const { return size_; }
  /// The map of the ideal picture, without rotation and distortion.
  [[nodiscard]] const PixelFrame& pixel_frame() const { return map_; }
  [[nodiscard]] const Lens& lens() const { return *lens_; }
  /// Outward tilt of the left and the right wall, degrees: from the options, or if 0 from the trajectory.
  [[nodiscard]] const std::array<double, 2>& side_tilt() const { return info_.box.side_tilt; }
  [[nodiscard]] const Shutter& shutter() const { return shutter_; }
  /// Radius of a bead in the ideal picture, px.
  [[nodiscard]] double radius_px(std::size_t slot) const;

 private:
  class Discs;
  struct Stamp;
  /// Darkens the area of tilted walls, whose feet move with the plate.
  void draw_leaning_walls(const Exposure& exposure, cv::Mat1f& share) const;
  void draw_plate(const Exposure& exposure, cv::Mat1f& share) const;
  [[nodiscard]] Vec3 place(const Exposure& exposure, std::size_t slot, double tau) const;
  /// Length of a bead's path during the exposure, px.
  [[nodiscard]] double path_length_px(const Exposure& exposure, std::size_t slot) const;
  [[nodiscard]] bool has_bright_spot(std::size_t slot) const;
  /// Multiplies the share of light of each pixel by what the bead transmits, and adds its bright spot to the
  /// glow.
  /// \param stamp reused memory
  void draw_bead(const Exposure& exposure, std::size_t slot, Stamp& stamp, cv::Mat1f& share,
                 cv::Mat1f& glow) const;
  /// Adds the disc at one position of its path, with a weight, to the stamp, and its bright spot to the glow.
  void add_to_stamp(const Vec3& at, float weight, Stamp& stamp, cv::Mat1f& glow) const;
  /// \param depth share of the light that the disc absorbs
  void block_light(const Stamp& stamp, float depth, cv::Mat1f& share) const;
  /// Turns the share of light that the beads transmit into grey levels: walls, plate, glow, lamp.
  void add_cell_and_lamp(const Exposure& exposure, const cv::Mat1f& glow, cv::Mat1f& share) const;

  CameraOptions options_;
  TrajectoryInfo info_;
  PixelFrame map_;
  cv::Size size_;
  Shutter shutter_;
  std::shared_ptr<const Lens> lens_;
  std::shared_ptr<const Discs> discs_;  // images of all radii
  cv::Mat1f backlight_;                 // grey levels; dirt included
  cv::Mat1f walls_;  // share of light that passes the upright side walls; empty: no upright walls
  cv::Mat2d ideal_;  // (x, y) of each pixel in the ideal picture; empty: the pixel's own (x, y)
};

/// Output kind of a folder of rendered frames.
inline Product rendered_stack() {
  return Product::whole_folder("a rendered stack");
}

/// The outputs of a rendering.
struct RenderJob {
  std::filesystem::path
      folder;  ///< frame_00000.png ..., truth.csv, frames.csv, CELL.toml, CAMERA.toml; empty: no folder
  std::filesystem::path movie;    ///< .mp4 or .avi, 8-bit; empty: no movie
  double frames_per_second = 25;  ///< of the movie
  int threads = 1;                ///< the output is byte-identical for any number
};

/// Frame counts of a finished rendering.
struct Rendered {
  std::size_t frames = 0;   ///< written
  std::size_t dropped = 0;  ///< left out on purpose
  std::size_t doubled = 0;  ///< written twice on purpose
};

/// Films a trajectory. The outputs appear complete or not at all.
/// \throws ConfigError, RunError
Rendered render(const TrajectorySource& trajectory, const CameraOptions& options, const RenderJob& job,
                Progress& progress = Progress::none());

/// The same into a folder, with one thread.
/// \returns number of frames
std::size_t render(const TrajectorySource& trajectory, const CameraOptions& options,
                   const std::filesystem::path& folder, Progress& progress = Progress::none());

}  // namespace twincell::imaging
