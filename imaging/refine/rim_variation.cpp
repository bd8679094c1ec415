#include "imaging/refine/rim_variation.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "core/quantile.hpp"
#include "imaging/refine/picture_evidence.hpp"
#include "imaging/refine/rim_samples.hpp"

namespace twincell::imaging {

namespace {

constexpr double kNoise = 0.35;  // variance of a mean of three interpolated samples, in variances of a pixel

/// Part of the rim signal that does not depend on r alone, in units of the scatter along the radius.
struct RimSignal {
  std::size_t size = 0;                                     // index of the size
  std::vector<double> turns;                                // the directions in which it is seen
  Eigen::Matrix<double, Eigen::Dynamic, kRimSteps> rest{};  // a row for each
  double noise = 0;                                         // variance of the noise
};

RimSignal rim_of(const RimSamples& samples, double noise) {
  const auto n = static_cast<Eigen::Index>(samples.turns.size());
  if (n == 0) return {};
  RimSignal rim{.turns = samples.turns, .rest = samples.levels};
  Eigen::Matrix<double, Eigen::Dynamic, 3> first(n, 3);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double turn = rim.turns[static_cast<std::size_t>(k)];
    first.row(k) << 1, std::cos(turn), std::sin(turn);
    rim.rest.row(k).array() -= rim.rest.row(k).mean();
  }
  const double scatter = rim.rest.colwise().mean().squaredNorm() / kRimSteps;
  if (scatter <= 0) return {};
  rim.rest -= first * first.colPivHouseholderQr().solve(rim.rest).eval();
  rim.rest /= std::sqrt(scatter);
  rim.noise = kNoise * noise * noise / scatter;
  return rim;
}

/// Subtracts the part of the rim signal that varies with a function of the direction in the same way in all
/// discs.
template <class Function>
void subtract_common(std::vector<RimSignal>& rims, Function&& of) {
  Eigen::Matrix<double, 1, kRimSteps> sum = Eigen::Matrix<double, 1, kRimSteps>::Zero();
  double squares = 0;
  for (const RimSignal& rim : rims)
    for (std::size_t k = 0; k < rim.turns.size(); ++k) {
      const double f = of(rim.turns[k]);
      sum += f * rim.rest.row(static_cast<Eigen::Index>(k));
      squares += f * f;
    }
  if (squares <= 0) return;
  for (RimSignal& rim : rims)
    for (std::size_t k = 0; k < rim.turns.size(); ++k)
      rim.rest.row(static_cast<Eigen::Index>(k)) -= of(rim.turns[k]) / squares * sum;
}

}  // namespace

double rim_variation(const cv::Mat& grey, const std::vector<Detection>& discs,
                     const std::vector<double>& radii_px, const std::vector<Detection>& others,
                     const cv::Mat1b& walls) {
  constexpr std::size_t kMinDiscs = 3;       // that show what they have in common
  constexpr double kMinShareOfDiscs = 0.25;  // that show their rims
  if (discs.empty() || std::min(grey.cols, grey.rows) < 2) return 0;
  cv::Mat1f levels;
  grey.convertTo(levels, CV_32F);
  const double noise = noise_level(levels);
  const std::vector<RimSamples> samples = rim_samples(levels, discs, others, walls);
  std::vector<RimSignal> rims;
  for (std::size_t b = 0; b < discs.size(); ++b) {
    RimSignal rim = rim_of(samples[b], noise);
    if (rim.turns.empty()) continue;
    rim.size = nearest_size(discs[b].radius, radii_px);
    rims.push_back(std::move(rim));
  }
  if (static_cast<double>(rims.size()) < kMinShareOfDiscs * static_cast<double>(discs.size())) return 0;
  if (rims.size() >= kMinDiscs) {
    subtract_common(rims, [](double turn) { return std::cos(2 * turn); });
    subtract_common(rims, [](double turn) { return std::sin(2 * turn); });
  }
  std::vector<std::vector<double>> variations(radii_px.size());
  for (const RimSignal& rim : rims) {
    constexpr double kSubtracted = 3;  // parameters of each disc
    const double freedom = (static_cast<double>(rim.turns.size()) - kSubtracted) * kRimSteps;
    variations[rim.size].push_back(rim.rest.squaredNorm() / freedom - rim.noise);
  }
  // Objects beside beads may disturb the rims of most of them, but a further size must be clearly seen.
  const double share = radii_px.size() > 1 ? 0.5 : 0.25;
  double largest = 0;
  for (std::vector<double>& of_size : variations)
    if (!of_size.empty()) largest = std::max(largest, upper_quantile(std::move(of_size), share));
  return largest;
}

}  // namespace twincell::imaging
