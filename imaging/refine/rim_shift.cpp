#include "imaging/refine/rim_shift.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "core/median.hpp"

namespace twincell::imaging {

namespace {

constexpr std::size_t kSectors = RimShift::kSectors;
constexpr std::size_t kMinSectors = kSectors / 3;

/// Functions of the direction, in the middle of each sector.
std::array<double, kSectors> in_sectors(double (*of)(double), double times) {
  std::array<double, kSectors> f{};
  for (std::size_t k = 0; k < kSectors; ++k)
    f[k] = of(times * 2 * std::numbers::pi * (static_cast<double>(k) + 0.5) / kSectors);
  return f;
}
double cosine(double x) {
  return std::cos(x);
}
double sine(double x) {
  return std::sin(x);
}

/// Subtracts the best-fit circle: a shift of the centre and a change of the radius. \returns false if too
/// little of the rim is seen
bool subtract_circle(RimShift& rim, double least_weight) {
  static const std::array<double, kSectors> c = in_sectors(cosine, 1), s = in_sectors(sine, 1);
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  std::size_t seen = 0;
  for (std::size_t k = 0; k < kSectors; ++k) {
    if (rim.weight[k] < least_weight) rim.weight[k] = 0;
    seen += rim.weight[k] > 0 ? 1 : 0;
    const Eigen::Vector3d f(1, c[k], s[k]);
    a += rim.weight[k] * f * f.transpose();
    right += rim.weight[k] * rim.px[k] * f;
  }
  if (seen < kMinSectors) return false;
  const Eigen::Vector3d of = a.ldlt().solve(right);
  for (std::size_t k = 0; k < kSectors; ++k) rim.px[k] -= of[0] + of[1] * c[k] + of[2] * s[k];
  return true;
}

/// Subtracts the component in a function of the direction that all discs have in common.
void subtract_common(std::vector<RimShift>& rims, const std::array<double, kSectors>& f) {
  double sum = 0, squares = 0;
  for (const RimShift& rim : rims)
    for (std::size_t k = 0; k < kSectors; ++k) {
      sum += rim.weight[k] * rim.px[k] * f[k];
      squares += rim.weight[k] * f[k] * f[k];
    }
  if (squares <= 0) return;
  for (RimShift& rim : rims)
    for (std::size_t k = 0; k < kSectors; ++k) rim.px[k] -= sum / squares * f[k];
}

/// Mean square of the shifts, px^2, less the part expected from the noise of the residuals.
double mean_square(const RimShift& rim) {
  constexpr double kSubtracted = 3;  // parameters of the circle
  double sum = 0, weight = 0, seen = 0;
  for (std::size_t k = 0; k < kSectors; ++k) {
    sum += rim.weight[k] * rim.px[k] * rim.px[k];
    weight += rim.weight[k];
    seen += rim.weight[k] > 0 ? 1 : 0;
  }
  return (sum - (seen - kSubtracted) * rim.variance) / weight;
}

/// The largest of the values that exceeds the lower quartile of their distribution with a probability of at
/// most 0.001; the least if there are too few. \pre not empty
double below_quartile(std::vector<double> values) {
  constexpr double kFalseAlarm = 1e-3, kQuartile = 0.25;  // probabilities
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  // values[k] exceeds it if at most k of the n are below it, each with the probability kQuartile.
  double log_term = n * std::log(1 - kQuartile), probability = std::exp(log_term);
  std::size_t k = 0;
  while (k + 1 < values.size()) {
    const auto below = static_cast<double>(k);
    log_term += std::log((n - below) / (below + 1) * kQuartile / (1 - kQuartile));
    probability += std::exp(log_term);
    if (probability > kFalseAlarm) break;
    ++k;
  }
  return values[k];
}

}  // namespace

double rim_shift(const std::vector<Detection>& discs, const std::vector<RimShift>& rims,
                 const std::vector<double>& radii_px) {
  constexpr std::size_t kMinDiscs = 3;  // that show what they have in common
  constexpr double kMinWeight = 0.1;    // of a sector that is seen
  std::vector<double> most;
  for (const RimShift& rim : rims) most.push_back(*std::max_element(rim.weight.begin(), rim.weight.end()));
  if (most.empty()) return 0;
  const double least_weight = std::max(kMinWeight * upper_median(std::move(most)), 1e-12);
  std::vector<RimShift> seen;
  std::vector<std::size_t> of;
  for (std::size_t b = 0; b < rims.size(); ++b) {
    RimShift rim = rims[b];
    if (!subtract_circle(rim, least_weight)) continue;
    seen.push_back(rim);
    of.push_back(b);
  }
  if (seen.size() >= kMinDiscs)
    for (const auto& f : {in_sectors(cosine, 2), in_sectors(sine, 2)}) subtract_common(seen, f);
  std::vector<std::vector<double>> squares(radii_px.size());
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const Detection& d = discs[of[k]];
    squares[nearest_size(d.radius, radii_px)].push_back(mean_square(seen[k]) /
                                                        (seen[k].radius * seen[k].radius));
  }
  double largest = 0;
  for (std::vector<double>& of_size : squares)
    if (!of_size.empty()) largest = std::max(largest, below_quartile(std::move(of_size)));
  return std::sqrt(largest);
}

}  // namespace twincell::imaging
