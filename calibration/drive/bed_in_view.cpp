#include "calibration/drive/bed_in_view.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "calibration/drive/bed_drive.hpp"
#include "core/error.hpp"
#include "core/median.hpp"
#include "core/plural.hpp"
#include "imaging/phase/phase_estimation.hpp"

namespace twincell::calibration {

namespace {

// Error of the contact of the outermost beads with a wall or the plate, in bead diameters: they need not
// touch it.
constexpr double kContactError = 0.003;

/// Height of the lower side of the bed.
double lower_side(const std::vector<SizedBead>& frame, double diameter) {
  std::map<long, double> lowest;  // by column
  for (const SizedBead& b : frame) {
    const double rim = -(b.y + b.radius);
    const auto [column, is_new] = lowest.try_emplace(std::lround(b.x / diameter), rim);
    if (!is_new) column->second = std::min(column->second, rim);
  }
  std::vector<double> rims;
  rims.reserve(lowest.size());
  for (const auto& [column, rim] : lowest) rims.push_back(rim);
  return rims.empty() ? std::nan("") : upper_median(std::move(rims));
}

double mean_height(const std::vector<SizedBead>& frame) {
  double sum = 0;
  for (const SizedBead& b : frame) sum -= b.y / static_cast<double>(frame.size());
  return frame.empty() ? std::nan("") : sum;
}

[[noreturn]] void refuse(const std::string& why) {
  throw InputError({.file = {}, .key = "bed"}, why);
}

}  // namespace

std::optional<Estimate> wall_of_bed(const BeadFrames& beads, double diameter, bool right) {
  std::vector<double> rims;  // outwards
  for (const auto& frame : beads.frames)
    for (const SizedBead& b : frame) rims.push_back((right ? b.x : -b.x) + b.radius);
  const auto frames = static_cast<double>(beads.frames.size());
  constexpr double kFalseBeads = 0.05;  // outside the wall, per frame
  const auto skip = static_cast<std::size_t>(kFalseBeads * frames);
  if (rims.size() <= skip) return std::nullopt;
  std::sort(rims.begin(), rims.end(), std::greater<>());
  const double from = rims[skip] - 0.1 * diameter;
  const auto last = std::find_if(rims.begin(), rims.end(), [&](double rim) { return rim < from; });
  const double place = upper_median(std::vector<double>(rims.begin(), last));
  double touching = 0, next = 0, sum = 0, squares = 0;
  for (const double rim : rims) {
    const double inside = (place - rim) / diameter;
    if (std::abs(inside) <= 0.03) ++touching, sum += rim - place, squares += (rim - place) * (rim - place);
    if (inside > 0.05 && inside <= 0.15) ++next;
  }
  if (touching < 1.5 * frames || touching < 2 * next) return std::nullopt;
  // Beads that only come near the wall trail inwards; their median is inside by the asymmetry of the trail.
  const auto at = [&](double share) {
    const auto n = static_cast<double>(last - rims.begin()) - 1;
    return rims[static_cast<std::size_t>(share * n)];
  };
  const double trail = std::max(0.0, (at(0.5) - at(0.9)) - (at(0.1) - at(0.5)));
  // Rims that glare or shade are not at the surfaces that touch.
  std::vector<double> radii;
  for (const auto& frame : beads.frames)
    for (const SizedBead& b : frame) radii.push_back(b.radius);
  const double rim_error = upper_median(std::move(radii)) - 0.5 * diameter;
  const double mean = sum / touching, scatter = std::sqrt(std::max(0.0, squares / touching - mean * mean));
  const double error =
      std::hypot(std::hypot(scatter / std::sqrt(touching / frames), kContactError * diameter),
                 std::hypot(trail, rim_error));
  return Estimate{(right ? 1 : -1) * (place + mean), error};
}

PlateOfBed plate_of_bed(const BeadFrames& beads, double diameter, double gamma) {
  const std::optional<TimeOnPlate> rest = time_at_rest(gamma);
  if (!rest) refuse(fmt::format("flies for longer than a cycle at Gamma = {:g}", gamma));
  PlateOfBed plate;
  imaging::BedMotion motion;
  for (const auto& frame : beads.frames) {
    motion.heights.push_back(mean_height(frame));
    plate.heights.push_back(lower_side(frame, diameter));
  }
  plate.phases = imaging::estimate_phases(motion, {.frames_per_cycle = 0, .gamma = gamma});
  const int n = plate.phases.frames_per_cycle;
  if (plate.phases.dropped > 0 || plate.phases.doubled > 0)
    refuse(fmt::format("does not move as a bed on this drive, or {} frames are missing and {} taken twice",
                       plate.phases.dropped, plate.phases.doubled));

  const auto angle = [&](std::size_t f) {
    return 2 * std::numbers::pi * plate.phases.at(static_cast<std::int64_t>(f)).phase / n;
  };
  std::vector<std::size_t> resting;
  for (std::size_t f = 0; f < plate.heights.size(); ++f) {
    double t = angle(f) / (2 * std::numbers::pi);
    if (t > rest->to) t -= 1;
    if (t >= rest->from && std::isfinite(plate.heights[f])) resting.push_back(f);
  }
  constexpr std::size_t kMinFrames = 8;  // at rest on the plate
  if (resting.size() < kMinFrames) refuse("rests on the plate in only " + plural(resting.size(), "frame"));
  Eigen::MatrixX3d model(static_cast<Eigen::Index>(resting.size()), 3);
  Eigen::VectorXd seen(static_cast<Eigen::Index>(resting.size()));
  for (std::size_t k = 0; k < resting.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    model.row(row) << 1, std::sin(angle(resting[k])), std::cos(angle(resting[k]));
    seen[row] = plate.heights[resting[k]];
  }
  const Eigen::Matrix3d normal = model.transpose() * model;
  const Eigen::Vector3d fit = normal.ldlt().solve(model.transpose() * seen);
  const double rms = (model * fit - seen).norm() / std::sqrt(static_cast<double>(resting.size()) - 3);
  constexpr double kMaxCosine = 0.2;  // amplitude of the cosine, fraction of that of the sine
  if (!(fit[1] > 0) || std::abs(fit[2]) > kMaxCosine * fit[1])
    refuse(fmt::format("does not move as one that rests on a plate with Gamma = {:g}", gamma));
  // Errors of the frames of one cycle are correlated, so the number of cycles determines the error.
  const double cycles = std::max(1.0, static_cast<double>(plate.heights.size()) / n);
  const double per_cycle = std::sqrt(std::max(1.0, static_cast<double>(resting.size()) / cycles));
  const Eigen::Matrix3d covariance = normal.inverse();
  const auto error = [&](int k) {
    return std::hypot(per_cycle * rms * std::sqrt(covariance(k, k)), kContactError * diameter);
  };
  plate.row = {-fit[0], error(0)};
  plate.amplitude = {std::hypot(fit[1], fit[2]), error(1)};
  for (double& height : plate.heights) height -= fit[0];
  return plate;
}

}  // namespace twincell::calibration
