#include "imaging/refine/rim_aspect.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/median.hpp"
#include "imaging/refine/rim_samples.hpp"
#include "imaging/refine/sparse_gauss_newton.hpp"

namespace twincell::imaging {

namespace {

double median_of(const Eigen::VectorXd& values) {
  return upper_median(std::vector<double>(values.begin(), values.end()));
}

/// Half of the weight is below it.
template <class Parts, class Value>
double weighted_median(Parts parts, Value&& of) {
  std::sort(parts.begin(), parts.end(), [&](const auto& a, const auto& b) { return of(a) < of(b); });
  double half = 0;
  for (const auto& p : parts) half += 0.5 * p.weight;
  for (const auto& p : parts)
    if ((half -= p.weight) <= 0) return of(p);
  return of(parts.back());
}

}  // namespace

std::string Aspect::doubt() const {
  constexpr double kMinDeviation = 0.015, kMinSignificance = 4;  // of the ratio from 1; standard errors
  constexpr double kAgrees = 0.5;  // least deviation of the spacing, in that of the rims
  if (!(std::abs(ratio - 1) > std::max(kMinDeviation, kMinSignificance * error))) return {};
  if (of_spacing && (*of_spacing - 1) / (ratio - 1) < kAgrees) return {};
  return fmt::format(
      "the beads are {:.3f} +- {:.3f} times as high as they are wide in the picture: its pixels are not "
      "square, and all lengths along y, as the amplitude and heights, are wrong by this factor; resize the "
      "frames to {:.3f} of their height (ffmpeg -i FILM -vf scale=iw:ih/{:.3f} RESIZED/%05d.png)",
      ratio, error, 1 / ratio, ratio);
}

void RimAspect::add(const cv::Mat& grey, const std::vector<Detection>& discs, std::array<double, 2> path_px) {
  constexpr double kMaxPath = 0.5;        // during the exposure, R
  constexpr double kMaxBackground = 0.2;  // deviation outside the rim, fraction of the step at it
  // Each sample is the mean over three directions that are a third of the angle apart.
  const double mean_of_second = (1 + 2 * std::cos(4 * std::numbers::pi / (3 * kRimDirections))) / 3;
  constexpr Eigen::Index kParameters = 4;
  constexpr double kMinWeight = 1;  // of the 12 of a whole rim
  cv::Mat1f levels;
  grey.convertTo(levels, CV_32F);
  const std::vector<RimSamples> rims = rim_samples(levels, discs);
  constexpr double kReach = 1.1;  // sums of radii: discs farther apart do not touch
  std::vector<Disc> wider;
  for (const Detection& d : discs) wider.push_back({d.x, d.y, kReach * d.radius, 1});
  for (const auto& [i, k] : near_pairs(wider, 0)) {
    const Disc &a = wider[static_cast<std::size_t>(i)], &b = wider[static_cast<std::size_t>(k)];
    const double x = a.x - b.x, y = a.y - b.y;
    if (std::hypot(x, y) < a.radius + b.radius) pairs_.push_back({x * x, y * y});
  }
  std::size_t measured = 0;
  for (std::size_t b = 0; b < discs.size(); ++b) {
    const RimSamples& rim = rims[b];
    const double radius = discs[b].radius;
    if (rim.turns.empty() || std::hypot(path_px[0], path_px[1]) > kMaxPath * radius) continue;
    const double outside = median_of(rim.levels.col(kRimSteps - 1)),
                 step = median_of(rim.levels.col(0)) - outside,
                 interval = 2 * rim_width_px(radius) / (kRimSteps - 1);
    if (step == 0) continue;
    Eigen::MatrixX3d first(rim.levels.rows(), 3);
    Eigen::VectorXd edge(rim.levels.rows()), second(rim.levels.rows());
    Eigen::Index n = 0;
    for (Eigen::Index k = 0; k < rim.levels.rows(); ++k) {
      const auto inside = ((rim.levels.row(k).array() - outside) / step).eval();
      if (std::abs(inside(kRimSteps - 1)) > kMaxBackground) continue;
      const double turn = rim.turns[static_cast<std::size_t>(k)];
      edge(n) = interval * (inside.sum() - 0.5 * (inside(0) + inside(kRimSteps - 1)));
      first.row(n) << 1, std::cos(turn), std::sin(turn);
      second(n++) = std::cos(2 * turn);
    }
    if (n <= kParameters) continue;
    // Only what the first harmonic cannot explain is evidence.
    const auto solver = first.topRows(n).colPivHouseholderQr();
    second.head(n) -= first.topRows(n) * solver.solve(second.head(n)).eval();
    const double weight = second.head(n).squaredNorm();
    if (weight < kMinWeight) continue;
    const double across = (path_px[0] * path_px[0] - path_px[1] * path_px[1]) / (radius * radius);
    discs_.push_back({second.head(n).dot(edge.head(n)) / (weight * radius * mean_of_second), weight, across});
    ++measured;
  }
  most_ = std::max(most_, measured);
}

// Touching discs have x^2/a^2 + y^2/b^2 = 1, others more, so that the quantile below which a tenth lies is
// fitted, by least squares with weights that make them absolute deviations.
std::optional<double> RimAspect::ratio_of_spacing() const {
  constexpr std::size_t kMinPairs = 30;
  constexpr double kQuantile = 0.15, kSmall = 1e-3;
  constexpr int kRounds = 40;
  if (pairs_.size() < kMinPairs) return std::nullopt;
  double mean = 0;
  for (const Pair& p : pairs_) mean += (p.xx + p.yy) / static_cast<double>(pairs_.size());
  Eigen::Vector2d of(1 / mean, 1 / mean);  // 1/a^2, 1/b^2
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (const Pair& p : pairs_) {
      const Eigen::Vector2d f(p.xx, p.yy);
      const double left = f.dot(of) - 1,
                   weight = (left > 0 ? kQuantile : 1 - kQuantile) / std::max(kSmall, std::abs(left));
      normal += weight * f * f.transpose();
      right += weight * f;
    }
    const Eigen::Vector2d next = normal.ldlt().solve(right);
    if (!(next.minCoeff() > 0)) return std::nullopt;
    of = next;
  }
  return std::sqrt(of.x() / of.y());
}

std::optional<Aspect> RimAspect::value() const {
  constexpr std::size_t kMinDiscs = 5;  // in one picture
  if (most_ < kMinDiscs) return std::nullopt;
  const double all_alike = std::min_element(discs_.begin(), discs_.end(), [](const Part& a, const Part& b) {
                             return std::abs(a.across) < std::abs(b.across);
                           })->across;
  const auto of = [&](const Part& p) { return p.e - (p.across - all_alike) / 48; };
  const double e = weighted_median(discs_, of),
               scatter = kSpreadOverDeviation *
                         weighted_median(discs_, [&](const Part&p) { return std::abs(of(p) - e); });
  const double ratio = (1 - e) / (1 + e);
  // Neighbours hide parts of the rims as circles, not as ellipses: of the demo, stretched by 1.08 and 0.93,
  // the deviation from 1 is measured 5 and 6 % too small.
  constexpr double kModelError = 0.06;
  // The error of a median; d ratio/d e is -2 for small e.
  return Aspect{
      ratio,
      std::hypot(2 * 1.2533 * scatter / std::sqrt(static_cast<double>(most_)), kModelError * (ratio - 1)),
      ratio_of_spacing()};
}

}  // namespace twincell::imaging
