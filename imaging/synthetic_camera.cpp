#include "imaging/synthetic_camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <vector>

#include "analysis/trajectory/atomic_file.hpp"
#include "analysis/trajectory/error.hpp"

namespace twincell {

namespace {

constexpr double kTableStep_px = 1.0 / 64;

// Disc * Gaussian as a function of the distance from the centre: across the line of sight the Gaussian
// integrates to an error function, along it the midpoint rule converges exponentially.
class DiscProfile {
 public:
  DiscProfile(double radius, double s) {
    const double end = radius + 5 * s;
    const int n = 400;
    const int steps = static_cast<int>(end / kTableStep_px);
    for (int k = 0; k <= steps; ++k) {
      const double r = k * kTableStep_px;
      double sum = 0;
      for (int i = 0; i < n; ++i) {
        const double angle = std::numbers::pi * (i + 0.5) / n, u = -radius * std::cos(angle);
        const double du = std::numbers::pi / n * radius * std::sin(angle);
        sum += du * std::exp(-0.5 * (u - r) * (u - r) / (s * s)) / (std::sqrt(2 * std::numbers::pi) * s) *
               std::erf(radius * std::sin(angle) / (std::numbers::sqrt2 * s));
      }
      values_.push_back(sum);
    }
  }
  [[nodiscard]] double at(double r) const {
    const double t = r / kTableStep_px;
    const auto i = static_cast<std::size_t>(t);
    if (i + 1 >= values_.size()) return 0;
    const double f = t - static_cast<double>(i);
    return (1 - f) * values_[i] + f * values_[i + 1];
  }

 private:
  std::vector<double> values_;
};

double smooth_step(double distance, double s) {
  return 0.5 * std::erfc(distance / (std::numbers::sqrt2 * s));
}

}  // namespace

void CameraOptions::check() const {
  auto range = [](const char* key, double v, double a, double b) {
    require_range(Where{.file = {}, .key = key}, v, a, b);
  };
  range("pixels-per-sigma", pixels_per_sigma, 3, 400);
  range("margin", margin_px, 0, 1000);
  range("blur", blur_px, 0.2, 5);
  range("backlight", backlight, 1, 255);
  range("vignetting", vignetting, 0, 0.9);
  range("electrons-per-level", electrons_per_level, 0, 1e9);
  range("read-noise", read_noise, 0, 50);
  range("tracer-darkness", tracer_darkness, 0.4, 1);
  range("exposure", exposure, 0, 1e6);
  range("max-height", max_height, 0, 1e6);
}

SyntheticCamera::SyntheticCamera(const CameraOptions& options, const TrajectoryInfo& info)
    : options_(options), info_(info) {
  options.check();
  if (options.exposure > 0 && !info.columns.velocity)
    throw ConfigError(Where{.file = {}, .key = "exposure"},
                      "is above 0, but the trajectory has no velocities.");
  const double height = options.max_height > 0 ? options.max_height : info.box.size().z();
  const double amplitude = info.drive ? info.drive->amplitude : 0;
  const double w = info.box.size().x() * options.pixels_per_sigma + 2 * options.margin_px;
  const double h = (height + 2 * amplitude) * options.pixels_per_sigma + 2 * options.margin_px;
  if (!(w >= 1 && h >= 1 && w <= 20000 && h <= 20000))
    throw ConfigError(
        Where{.file = {}, .key = "pixels-per-sigma"},
        fmt::format("makes a frame of {:.0f} x {:.0f} pixels; at most 20000 a side are drawn.", w, h));
  size_ = {cvCeil(w), cvCeil(h)};
  map_.pixels_per_sigma = options.pixels_per_sigma;
  map_.origin = {options.margin_px - info.box.lower.x() * options.pixels_per_sigma,
                 size_.height - 1 - options.margin_px - amplitude * options.pixels_per_sigma};
}

double SyntheticCamera::radius_px(std::size_t slot) const {
  return (info_.radius.empty() ? 0.5 : info_.radius[slot]) * options_.pixels_per_sigma;
}

cv::Mat1b SyntheticCamera::expose(const Frame& frame) const {
  const double s = std::sqrt(options_.blur_px * options_.blur_px + 1.0 / 12);
  cv::Mat1d dark = cv::Mat1d::zeros(size_);
  std::map<double, DiscProfile> profiles;
  for (std::size_t k = 0; k < info_.n_beads; ++k) {
    if (!frame.present(k) || !std::isfinite(frame.position[k].x())) continue;
    const double radius = radius_px(k);
    const DiscProfile& profile = profiles.try_emplace(radius, radius, s).first->second;
    const double depth = !info_.tracer.empty() && info_.tracer[k] != 0 ? options_.tracer_darkness : 1;
    const Vec3 path =
        options_.exposure > 0 ? Vec3(frame.velocity[k] * options_.exposure) : Vec3(Vec3::Zero());
    const int exposures = 1 + std::clamp(cvCeil(4 * path.norm() * options_.pixels_per_sigma), 0, 64);
    for (int e = 0; e < exposures; ++e) {
      const PixelPoint c = map_.pixel_from_cell(frame.position[k] + ((e + 0.5) / exposures - 0.5) * path);
      const double reach = radius + 5 * s;
      for (int y = std::max(0, cvFloor(c.y_px - reach));
           y <= std::min(size_.height - 1, cvCeil(c.y_px + reach)); ++y)
        for (int x = std::max(0, cvFloor(c.x_px - reach));
             x <= std::min(size_.width - 1, cvCeil(c.x_px + reach)); ++x)
          dark(y, x) += depth / exposures * profile.at(std::hypot(x - c.x_px, y - c.y_px));
    }
  }
  const double plate = std::isfinite(frame.plate_height) ? frame.plate_height : 0;
  const bool walls = info_.box.boundary[0] == Boundary::wall;
  const double left = map_.pixel_from_cell(info_.box.lower).x_px,
               right = map_.pixel_from_cell(info_.box.upper).x_px;
  const double floor = map_.pixel_from_cell(Vec3(0, 0, plate)).y_px;
  std::mt19937_64 bits(options_.seed * 0x9E3779B97F4A7C15ULL + static_cast<std::uint64_t>(frame.step));
  auto uniform = [&] { return (static_cast<double>(bits() >> 11) + 0.5) * 0x1p-53; };
  cv::Mat1b picture(size_);
  for (int y = 0; y < size_.height; ++y)
    for (int x = 0; x < size_.width; ++x) {
      double light = std::max(0.0, 1 - dark(y, x)) * smooth_step(y - floor, s);
      if (walls) light *= smooth_step(left - x, s) * smooth_step(x - right, s);
      const double u = 2.0 * x / size_.width - 1, v = 2.0 * y / size_.height - 1;
      const double level = options_.backlight * (1 - options_.vignetting * 0.5 * (u * u + v * v)) * light;
      const double shot = options_.electrons_per_level > 0 ? level / options_.electrons_per_level : 0;
      // Box-Muller, spelt out: the library's own normal distribution differs between implementations.
      const double normal = std::sqrt(-2 * std::log(uniform())) * std::cos(2 * std::numbers::pi * uniform());
      picture(y, x) = cv::saturate_cast<std::uint8_t>(
          level + std::sqrt(shot + options_.read_noise * options_.read_noise) * normal);
    }
  return picture;
}

namespace {

// The box of a simulation is tall enough never to be touched, so most of it would be a picture of nothing.
double height_of_beads(const TrajectorySource& trajectory, Progress& progress) {
  constexpr double kHeadroom = 2;
  double top = 0;
  Frame frame;
  for (std::size_t f = 0; f < trajectory.n_frames(); ++f) {
    trajectory.read(f, frame);
    for (std::size_t k = 0; k < frame.position.size(); ++k)
      if (frame.present(k) && std::isfinite(frame.position[k].z()))
        top = std::max(top, frame.position[k].z());
    progress.update(0, static_cast<std::int64_t>(trajectory.n_frames()));
  }
  return std::min(trajectory.info().box.size().z(), top + kHeadroom);
}

}  // namespace

std::size_t render(const TrajectorySource& trajectory, const CameraOptions& options,
                   const std::filesystem::path& folder, Progress& progress) {
  const TrajectoryInfo& info = trajectory.info();
  CameraOptions fitted = options;
  if (fitted.max_height == 0) fitted.max_height = height_of_beads(trajectory, progress);
  const SyntheticCamera camera(fitted, info);
  AtomicPath place(folder, AtomicPath::Kind::folder);
  std::string truth = "frame,id,x_px,y_px,r_px,tracer,phase,cycle\n";
  Frame frame;
  int first_phase = 0;
  for (std::size_t f = 0; f < trajectory.n_frames(); ++f) {
    trajectory.read(f, frame);
    if (f == 0) first_phase = std::max(0, static_cast<int>(frame.phase));
    const auto file = place.part() / fmt::format("frame_{:05}.png", f);
    if (!cv::imwrite(file.string(), camera.expose(frame), {cv::IMWRITE_PNG_COMPRESSION, 9}))
      throw RunError(file.string() + ": cannot be written.");
    for (std::size_t k = 0; k < info.n_beads; ++k) {
      if (!frame.present(k) || !std::isfinite(frame.position[k].x())) continue;
      const PixelPoint p = camera.pixel_frame().pixel_from_cell(frame.position[k]);
      // The truth is of what can be seen: a bead that flies out of the picture is not in it.
      if (p.x_px < -0.5 || p.y_px < -0.5 || p.x_px > camera.size().width - 0.5 ||
          p.y_px > camera.size().height - 0.5)
        continue;
      truth += fmt::format("{},{},{:.5f},{:.5f},{:.5f},{},{},{}\n", f, k, p.x_px, p.y_px, camera.radius_px(k),
                           info.tracer.empty() ? 0 : int{info.tracer[k]}, frame.phase, frame.cycle);
    }
    progress.update(static_cast<std::int64_t>(f + 1), static_cast<std::int64_t>(trajectory.n_frames()));
  }
  const PixelFrame& map = camera.pixel_frame();
  std::string cell = fmt::format(
      "[camera]\npixels_per_sigma = {:.17g}\norigin_px = [{:.17g}, {:.17g}]\nframes_per_cycle = "
      "{}\nfirst_phase = {}\n\n"
      "[cell]\nwidth = {:.17g}\nheight = {:.17g}\nsides = \"{}\"\n",
      map.pixels_per_sigma, map.origin.x_px + info.box.lower.x() * map.pixels_per_sigma, map.origin.y_px,
      info.phases_per_cycle, first_phase, info.box.size().x(), info.box.size().z(),
      info.box.boundary[0] == Boundary::wall ? "walls"
      : info.box.periodic(Axis::x)           ? "periodic"
                                             : "open");
  if (info.drive)
    cell += fmt::format("\n[drive]\namplitude = {:.17g}\nomega = {:.17g}\n", info.drive->amplitude,
                        info.drive->omega);
  if (info.scale.sigma_m || info.scale.gravity_m_s2) cell += "\n[scale]\n";
  if (info.scale.sigma_m) cell += fmt::format("sigma_m = {:.17g}\n", *info.scale.sigma_m);
  if (info.scale.gravity_m_s2) cell += fmt::format("gravity_m_s2 = {:.17g}\n", *info.scale.gravity_m_s2);
  write_text_file(place.part() / "truth.csv", truth);
  write_text_file(place.part() / "CELL.toml", cell);
  place.commit();
  return trajectory.n_frames();
}

}  // namespace twincell
