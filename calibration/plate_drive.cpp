#include "calibration/plate_drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "analysis/trajectory/error.hpp"
#include "calibration/cell_geometry.hpp"
#include "calibration/plate_lock.hpp"
#include "imaging/frame_source.hpp"

namespace twincell {
namespace {

/// Numbers of the drive that are stated, amplitude apart.
int stated(const DriveSpec& s) {
  int n = 0;
  for (const auto& number : {s.omega, s.frequency, s.gamma, s.k_m, s.peak_velocity}) n += number ? 1 : 0;
  return n;
}

bool is_whole(const DriveSpec& s) {
  return stated(s) + (s.amplitude ? 1 : 0) >= 2;
}

/// Pixels per sigma: as stated, else by the walls.
double scale_of(const CellDescription& cell, const CellGeometry& geometry, const Where& where) {
  if (cell.pixels_per_sigma) return *cell.pixels_per_sigma;
  if (cell.width && geometry.has_left && geometry.has_right) return geometry.width_px() / *cell.width;
  throw ConfigError(where,
                    "is not stated, and the plate's motion gives it in pixels alone: say "
                    "camera.pixels_per_sigma, or cell.width where both walls are in the picture.");
}

}  // namespace

bool lacks_drive(const CellDescription& cell) {
  return !is_whole(cell.drive_spec) || !cell.phase_lock.locked();
}

std::string complete_drive(CellDescription& cell, const std::filesystem::path& cell_file,
                           const std::filesystem::path& stack, int threads, Progress& progress) {
  const auto where = [&](const char* key) { return Where{.file = cell_file.string(), .key = key}; };
  const double diameter = diameter_for_edges(stack, cell.bright, cell.pixels_per_sigma.value_or(0));
  const StackEdges edges = read_stack_edges(*open_frames(stack), cell.bright, diameter, threads, progress);
  const auto seen = [&] {
    try {
      const CellGeometry geometry = fit_cell_geometry(edges);
      return std::pair(
          geometry, lock_plate(geometry.heights_px(), {.frames_per_cycle = cell.phase_lock.frames_per_cycle,
                                                       .mend = true,
                                                       .model_error = kHeightModelError_px}));
    } catch (const InputError& e) {
      throw InputError({.file = stack.string()},
                       fmt::format("the drive is not stated, and cannot be seen on the plate: {}", e.what()));
    }
  }();
  const auto& [geometry, lock] = seen;
  std::string said = "by the plate's edge:";
  DriveSpec& spec = cell.drive_spec;
  if (!is_whole(spec)) {
    if (!spec.amplitude) {
      const double scale = scale_of(cell, geometry, where("drive.amplitude"));
      spec.amplitude = lock.amplitude / scale;
      said += fmt::format(" A = {:.5g} +- {:.2g} sigma", *spec.amplitude, lock.amplitude_error / scale);
    }
    if (stated(spec) == 0) {
      const auto rate = frame_rate_of(cell.frame_rate_hz, edges, stack);
      const auto t0 = cell.scale.t0_s();
      if (!rate || !t0)
        throw ConfigError(
            where("drive.omega"),
            fmt::format("is not stated, and the plate's motion gives it per frame alone: say it, or {}.",
                        !rate ? "camera.frame_rate_hz" : "scale.sigma_m and gravity_m_s2"));
      spec.omega = lock.omega * *rate * *t0;
      said += fmt::format("{} omega = {:.6g} +- {:.2g} /t0", said.back() == ':' ? "" : ",", *spec.omega,
                          lock.omega_error * *rate * *t0);
    }
  }
  if (!cell.phase_lock.locked()) {
    if (lock.frames_per_cycle == 0)
      throw ConfigError(
          where("camera.frames_per_cycle"),
          fmt::format("is missing, and {:.5g} frames per cycle, as the plate moves, is no whole "
                      "number that lasts: the frames keep no phase.",
                      lock.period));
    cell.phase_lock = {lock.frames_per_cycle, lock.first_phase, lock.phase_offset};
    said += fmt::format("{} {} frames per cycle, the first at phase {}", said.back() == ':' ? "" : ",",
                        lock.frames_per_cycle, lock.first_phase);
  }
  return said;
}

namespace {

/// The beginning of a stack.
class FirstFrames : public FrameSource {
 public:
  FirstFrames(const std::filesystem::path& stack, std::size_t most)
      : all_(open_frames(stack)), most_(most), left_(most) {}
  bool next(cv::Mat& frame) override {
    if (left_ == 0) return false;
    --left_;
    return all_->next(frame);
  }
  [[nodiscard]] std::size_t announced() const override { return std::min(all_->announced(), most_); }
  [[nodiscard]] std::string current() const override { return all_->current(); }
  [[nodiscard]] StackInfo info() const override { return all_->info(); }
  [[nodiscard]] std::optional<double> time_s() const override { return all_->time_s(); }

 private:
  std::unique_ptr<FrameSource> all_;
  std::size_t most_, left_;
};

}  // namespace

std::string drive_disagreement(const CellDescription& cell, const std::filesystem::path& stack, int threads,
                               Progress& progress) {
  constexpr double kErrors = 5, kShare = 0.03, kPixels = 0.3;
  const auto drive = cell.drive();
  if (!drive || !cell.pixels_per_sigma) return {};
  const double scale = *cell.pixels_per_sigma;
  // Three cycles tell an amplitude; the rest of a long film would cost as much as locating its beads.
  constexpr std::size_t kCycles = 3, kFewest = 40;
  FirstFrames beginning(
      stack, std::max(kFewest, kCycles * static_cast<std::size_t>(cell.phase_lock.frames_per_cycle)));
  const StackEdges edges = read_stack_edges(beginning, cell.bright,
                                            diameter_for_edges(stack, cell.bright, scale), threads, progress);
  std::optional<PlateLock> seen;
  try {
    seen = lock_plate(fit_cell_geometry(edges).heights_px(),
                      {.frames_per_cycle = cell.phase_lock.frames_per_cycle,
                       .mend = true,
                       .model_error = kHeightModelError_px});
  } catch (const InputError&) {
    return {};  // no plate in the picture, or none that moves: nothing to compare with
  }
  const double amplitude = seen->amplitude / scale, error = seen->amplitude_error / scale,
               difference = std::abs(amplitude - drive->amplitude);
  if (difference > std::max({kErrors * error, kShare * drive->amplitude, kPixels / scale}))
    return fmt::format(
        "the plate in the frames moves by A = {:.4g} +- {:.2g} sigma, and the cell states {:.4g}", amplitude,
        error, drive->amplitude);
  const auto rate = frame_rate_of(cell.frame_rate_hz, edges, stack);
  const auto t0 = cell.scale.t0_s();
  if (rate && t0) {
    const double omega = seen->omega * *rate * *t0, omega_error = seen->omega_error * *rate * *t0;
    if (std::abs(omega - drive->omega) > std::max(kErrors * omega_error, kShare * drive->omega))
      return fmt::format(
          "the plate in the frames moves at omega = {:.4g} +- {:.2g} per t0, and the cell states {:.4g}",
          omega, omega_error, drive->omega);
  }
  return {};
}

}  // namespace twincell
