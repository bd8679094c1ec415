#include "calibration/accuracy/calibration_cost.hpp"

#include <cmath>
#include <numbers>

#include "calibration/camera/cell_geometry.hpp"
#include "calibration/camera/size_statistics.hpp"
#include "calibration/contact/bounce.hpp"
#include "calibration/drive/drive_fit.hpp"
#include "core/cpu_clock.hpp"
#include "imaging/camera/random.hpp"
#include "imaging/camera/synthetic_camera.hpp"

namespace twincell::calibration {
namespace {

constexpr int kPhases = 20, kColumns = 12, kRows = 6;
constexpr double kScale = 14.3, kGamma = 0.9, kRestitution = 0.85;

TrajectoryInfo cell() {
  TrajectoryInfo info;
  info.box.upper = Vec3(kColumns, 0.5, kRows + 10);
  info.n_beads = kColumns * kRows - kRows / 2;
  info.drive = Drive{.axis = Axis::z, .amplitude = kGamma, .omega = 1};
  info.phases_per_cycle = kPhases;
  return info;
}

Frame frame_at(int f, const TrajectoryInfo& info) {
  Frame frame;
  frame.step = f;
  frame.phase = f % kPhases;
  frame.cycle = f / kPhases;
  const double fraction = static_cast<double>(frame.phase) / kPhases;
  frame.time = info.drive->period() * f / kPhases;
  frame.plate_height = info.drive->displacement(fraction);
  for (int row = 0; row < kRows; ++row)
    for (int c = 0; c < kColumns - row % 2; ++c)
      frame.position.emplace_back(0.5 + c + 0.5 * (row % 2), 0,
                                  frame.plate_height + 0.5 + row * std::sqrt(0.75));
  return frame;
}

/// The first n pictures of a film.
class Pictures : public imaging::FrameSource {
 public:
  Pictures(const std::vector<cv::Mat>& all, int n) : all_(all), n_(static_cast<std::size_t>(n)) {}
  bool next(cv::Mat& frame) override {
    if (at_ == n_) return false;
    frame = all_[at_++];
    return true;
  }
  [[nodiscard]] std::size_t announced() const override { return n_; }
  [[nodiscard]] std::string current() const override { return "film"; }

 private:
  const std::vector<cv::Mat>& all_;
  std::size_t n_, at_ = 0;
};

/// Heights of a bead that is dropped from 4 sigma onto a plate at rest; noise 0.005 sigma, 50 frames per t0.
std::vector<BounceSample> bouncing_bead(int n) {
  constexpr double kDrop = 4, kStep = 0.02, kNoise = 0.005;
  imaging::RandomStream noise(1, imaging::Chance::noise, n);
  std::vector<BounceSample> samples;
  double begin = 0, v = 0;
  for (int i = 0; i < n; ++i) {
    const double t = i * kStep, first = std::sqrt(2 * kDrop);
    if (begin == 0 && t > first) begin = first, v = kRestitution * first;
    while (begin > 0 && t > begin + 2 * v && v > 0.05) begin += 2 * v, v *= kRestitution;
    const double s = t - begin, z = begin == 0 ? kDrop - 0.5 * t * t : std::max(0.0, v * s - 0.5 * s * s);
    samples.push_back({t, z + kNoise * noise.normal()});
  }
  return samples;
}

}  // namespace

CalibrationCost measure_calibration(const std::vector<int>& frames, Progress& progress) {
  const TrajectoryInfo info = cell();
  const imaging::CameraOptions options{.pixels_per_sigma = kScale, .max_height = kRows + 3};
  const imaging::SyntheticCamera camera(options, info);
  std::vector<cv::Mat> film;
  for (int f = 0; f < frames.back(); ++f) {
    film.push_back(camera.expose(frame_at(f, info)));
    progress.update(f, 2 * frames.back());
  }
  CalibrationCost cost{
      .width_px = camera.size().width, .height_px = camera.size().height, .numbers = {}, .times = {}};
  for (const int n : frames) {
    CalibrationTime time{.frames = n};
    const auto add = [&](const char* name, const char* unit, double stated, double actual) {
      cost.numbers.push_back({.name = name, .unit = unit, .frames = n, .stated = stated, .actual = actual});
    };
    Pictures pictures(film, n);
    double start = thread_cpu_seconds();
    const StackEdges edges = read_stack_edges(pictures, {.diameter_px = kScale}, 1);
    time.edges_s = thread_cpu_seconds() - start;
    start = thread_cpu_seconds();
    const CellGeometry g = fit_cell_geometry(edges);
    const DriveFit lock = fit_drive(g.heights_px(), {.model_error = kHeightModelError_px});
    time.fit_s = thread_cpu_seconds() - start;
    start = thread_cpu_seconds();
    Pictures again(film, n);
    imaging::LocatorOptions locator;
    locator.diameter_px = kScale;
    const SizeStatistics census = count_beads(locate_beads(again, locator, std::nullopt, 12, 1));
    time.beads_s = thread_cpu_seconds() - start;
    cost.times.push_back(time);

    const imaging::PixelFrame& map = camera.pixel_frame();
    add("camera.pixels_per_sigma", "px", g.width_error_px() / kColumns, g.width_px() / kColumns - kScale);
    add("camera.origin_px", "px", g.fit.standard_error("x_left"), g.fit.value("x_left") - map.origin.x_px);
    add("camera.rotation_deg", "degrees", g.fit.standard_error("rotation"), g.rotation_deg);
    add("cell.side_tilt", "degrees", g.fit.standard_error("tilt_left"), g.fit.value("tilt_left"));
    add("drive.amplitude", "sigma", lock.amplitude_error / kScale, lock.amplitude / kScale - kGamma);
    add("camera.period", "frames", lock.period_error, lock.period - kPhases);
    add("camera.phase_offset", "frames", lock.phase_offset_error, lock.phase_offset);
    add("beads.diameter", "px", census.diameter.error, census.diameter.value - kScale);
    // The first impact occurs after 141 frames; shorter films do not show enough impacts for a restitution.
    if (n >= 300) {
      const BounceFit bounce = fit_bounces(bouncing_bead(n));
      add("contact.wall.restitution", "1", bounce.restitution_error, bounce.restitution - kRestitution);
    }
    progress.update(frames.back() + n, 2 * frames.back());
  }
  return cost;
}

}  // namespace twincell::calibration
