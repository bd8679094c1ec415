#include "imaging/phase/camera_jump.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "core/median.hpp"
#include "core/quantile.hpp"

namespace twincell::imaging {

namespace {

constexpr std::size_t kDeciles = std::tuple_size_v<Deciles>;

/// Median step of the deciles, and whether nearly all of them make it.
struct CommonStep {
  double px = 0;
  bool together = false;
};

CommonStep step_between(const Deciles& from, const Deciles& to) {
  constexpr double kOff = 0.35;  // of the step
  constexpr std::size_t kMostOff = 2;
  std::vector<double> steps;
  for (std::size_t k = 0; k < kDeciles; ++k) steps.push_back(to[k] - from[k]);
  const double middle = upper_median(steps);
  const auto off = static_cast<std::size_t>(std::count_if(
      steps.begin(), steps.end(), [&](double s) { return std::abs(s - middle) > kOff * std::abs(middle); }));
  return {middle, off <= kMostOff};
}

}  // namespace

std::optional<Deciles> deciles_of(std::vector<double> x_px) {
  constexpr std::size_t kMinBeads = 20;
  if (x_px.size() < kMinBeads) return std::nullopt;
  std::sort(x_px.begin(), x_px.end());
  Deciles all{};
  for (std::size_t k = 0; k < kDeciles; ++k) all[k] = x_px[(k + 1) * x_px.size() / (kDeciles + 1)];
  return all;
}

std::vector<CameraJump> jumps_of_beads(std::span<const std::optional<Deciles>> x_px, double diameter_px) {
  constexpr std::size_t kMinFrames = 10, kAround = 3;            // frames
  constexpr double kUsual = 0.9, kTimesUsual = 4, kLeast = 0.1;  // share; ratio; diameters
  constexpr double kRemains = 0.5;                               // of the jump
  std::vector<std::size_t> frames;
  std::vector<Deciles> deciles;
  for (std::size_t f = 0; f < x_px.size(); ++f)
    if (x_px[f]) frames.push_back(f), deciles.push_back(*x_px[f]);
  if (frames.size() < kMinFrames) return {};
  std::vector<CommonStep> steps{{}};
  std::vector<double> sizes;
  for (std::size_t k = 1; k < deciles.size(); ++k) {
    steps.push_back(step_between(deciles[k - 1], deciles[k]));
    sizes.push_back(std::abs(steps.back().px));
  }
  const double least = std::max(kTimesUsual * lower_quantile(std::move(sizes), kUsual), kLeast * diameter_px);
  std::vector<CameraJump> jumps;
  for (std::size_t k = 1; k < steps.size(); ++k) {
    if (!steps[k].together || std::abs(steps[k].px) < least) continue;
    const std::size_t before = k - std::min(k, kAround), after = std::min(k + kAround, deciles.size() - 1);
    if (step_between(deciles[before], deciles[k]).px / steps[k].px < kRemains ||
        step_between(deciles[k - 1], deciles[after]).px / steps[k].px < kRemains)
      continue;
    jumps.push_back({.frame = frames[k], .right_px = steps[k].px, .down_px = {}});
  }
  return jumps;
}

std::optional<CameraJump> jump_of_plate(std::span<const double> plate_px, int frames_per_cycle) {
  constexpr int kTerms = 5;  // mean, sine and second harmonic
  constexpr std::size_t kMinCycles = 2, kMinFrames = 3;
  constexpr double kLeft = 0.25, kLeast_px = 0.5;  // of the step that its fit may leave; of the step
  using Row = Eigen::Matrix<double, kTerms, 1>;
  if (frames_per_cycle < kTerms) return std::nullopt;
  std::vector<std::size_t> frames;
  for (std::size_t f = 0; f < plate_px.size(); ++f)
    if (std::isfinite(plate_px[f])) frames.push_back(f);
  if (frames.size() < kMinCycles * static_cast<std::size_t>(frames_per_cycle)) return std::nullopt;
  const auto row = [&](std::size_t f) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(f) / frames_per_cycle;
    return Row{1, std::cos(turn), std::sin(turn), std::cos(2 * turn), std::sin(2 * turn)};
  };
  Eigen::Matrix<double, kTerms, kTerms> a = Eigen::Matrix<double, kTerms, kTerms>::Zero();
  Row right = Row::Zero();
  for (const std::size_t f : frames) a += row(f) * row(f).transpose(), right += plate_px[f] * row(f);
  const auto solver = a.ldlt();
  const Row fit = solver.solve(right);
  double squares = 0;
  for (const std::size_t f : frames) squares += std::pow(plate_px[f] - fit.dot(row(f)), 2);
  // A step from the frame f on changes the sum of squares by -(sum of residuals from f on)^2 over the square
  // of what the sine leaves of the step.
  Row later = Row::Zero();
  double residuals = 0, count = 0, best_gain = 0, step = 0;
  std::size_t first = 0;
  for (std::size_t k = frames.size(); k-- > kMinFrames;) {
    const std::size_t f = frames[k];
    later += row(f), residuals += plate_px[f] - fit.dot(row(f)), count += 1;
    if (count < kMinFrames) continue;
    const double left = count - later.dot(solver.solve(later));
    if (left <= 0) continue;
    if (const double gain = residuals * residuals / left; gain > best_gain)
      best_gain = gain, step = residuals / left, first = f;
  }
  const double rms = std::sqrt(std::max(0.0, squares - best_gain) / static_cast<double>(frames.size()));
  if (std::abs(step) < kLeast_px || rms > kLeft * std::abs(step)) return std::nullopt;
  return CameraJump{.frame = first, .right_px = {}, .down_px = -step};
}

std::vector<CameraJump> merged(std::vector<CameraJump> beads, const std::optional<CameraJump>& plate) {
  if (!plate) return beads;
  const auto same = std::find_if(beads.begin(), beads.end(), [&](const CameraJump& j) {
    return std::max(j.frame, plate->frame) - std::min(j.frame, plate->frame) <= 1;
  });
  if (same != beads.end())
    same->down_px = plate->down_px;
  else
    beads.insert(std::upper_bound(beads.begin(), beads.end(), *plate,
                                  [](const auto& a, const auto& b) { return a.frame < b.frame; }),
                 *plate);
  return beads;
}

std::string in_words(std::span<const CameraJump> jumps, std::size_t frames) {
  constexpr std::size_t kMaxNamed = 3;
  if (jumps.empty()) return {};
  std::string text;
  for (std::size_t i = 0; i < std::min(jumps.size(), kMaxNamed); ++i) {
    const CameraJump& j = jumps[i];
    text += fmt::format("{}from frame {} on, ", i > 0 ? ", and " : "", j.frame);
    text += j.right_px && j.down_px
                ? fmt::format("plate and beads are shifted by ({:.1f}, {:.1f}) px", *j.right_px, *j.down_px)
            : j.right_px ? fmt::format("all beads are shifted by {:.1f} px to the right", *j.right_px)
                         : fmt::format("the plate is shifted by {:.1f} px downwards", *j.down_px);
  }
  const std::size_t at = jumps.front().frame;
  return text + fmt::format(
                    "{}: the camera or the cell was moved, and positions, s_b and s_c mix the two; track the "
                    "parts one by one (--frames 0:{} and --frames {}:{})",
                    jumps.size() > kMaxNamed ? ", ..." : "", at, at,
                    jumps.size() > 1 ? jumps[1].frame : frames);
}

}  // namespace twincell::imaging
