#include "imaging/refine/rim_variation.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "imaging/refine/picture_evidence.hpp"
#include "imaging/refine/sparse_gauss_newton.hpp"

namespace twincell::imaging {

namespace {

constexpr int kDirections = 24, kTimes = 3;       // kTimes samples are averaged for each direction
constexpr int kSteps = 13;                        // samples along the radius
constexpr double kWidth = 0.35, kLeastWidth = 2;  // of R; px
constexpr double kApart = 1.5;                    // px from the rims of other discs
constexpr int kLeastDirections = kDirections / 3;
constexpr double kNoise = 0.35;  // variance of a mean of kTimes interpolated samples, in variances of a pixel

double width_of(const Detection& d) {
  return std::max(kWidth * d.radius, kLeastWidth);
}

using Levels = Eigen::Matrix<double, Eigen::Dynamic, kSteps>;

/// What of the rim of a disc does not depend on r alone, in units of the scatter along the radius.
struct Rim {
  std::size_t size = 0;       // index of the size
  std::vector<double> turns;  // the directions in which it is seen
  Levels rest;                // a row for each
  double noise = 0;           // variance of the noise
};

double interpolated(const cv::Mat1f& grey, double x, double y) {
  const int i = std::min(static_cast<int>(x), grey.cols - 2),
            j = std::min(static_cast<int>(y), grey.rows - 2);
  const double u = x - i, v = y - j;
  return (1 - v) * ((1 - u) * static_cast<double>(grey(j, i)) + u * static_cast<double>(grey(j, i + 1))) +
         v * ((1 - u) * static_cast<double>(grey(j + 1, i)) + u * static_cast<double>(grey(j + 1, i + 1)));
}

/// The rim of a disc. \param others discs that may hide parts of it, \param walls regions that do
Rim rim_of(const cv::Mat1f& grey, const Detection& d, const std::vector<const Detection*>& others,
           const cv::Mat1b& walls, double noise) {
  const double width = width_of(d);
  const auto at = [&](int step) { return d.radius + width * (2.0 * step / (kSteps - 1) - 1); };
  Rim rim;
  std::vector<std::array<double, kSteps>> levels;
  for (int k = 0; k < kDirections; ++k) {
    std::array<double, kSteps> sum{};
    bool seen = true;
    for (int t = 0; t < kTimes && seen; ++t) {
      const double turn = 2 * std::numbers::pi * (k * kTimes + t + 0.5) / (kDirections * kTimes);
      // Outermost first, because there it is most often hidden.
      for (int step = kSteps - 1; step >= 0 && seen; --step) {
        const double x = d.x + at(step) * std::cos(turn), y = d.y + at(step) * std::sin(turn);
        seen = x >= 0 && y >= 0 && x <= grey.cols - 1 && y <= grey.rows - 1 &&
               (walls.empty() || walls(cvRound(y), cvRound(x)) == 0) &&
               std::none_of(others.begin(), others.end(), [&](const Detection* o) {
                 const double dx = x - o->x, dy = y - o->y, far = o->radius + kApart;
                 return dx * dx + dy * dy < far * far;
               });
        if (seen) sum[static_cast<std::size_t>(step)] += interpolated(grey, x, y) / kTimes;
      }
    }
    if (!seen) continue;
    rim.turns.push_back(2 * std::numbers::pi * (k + 0.5) / kDirections);
    levels.push_back(sum);
  }
  const auto n = static_cast<Eigen::Index>(levels.size());
  if (n < kLeastDirections) return {};
  Eigen::Matrix<double, Eigen::Dynamic, 3> first(n, 3);
  rim.rest.resize(n, kSteps);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto row = static_cast<std::size_t>(k);
    first.row(k) << 1, std::cos(rim.turns[row]), std::sin(rim.turns[row]);
    rim.rest.row(k) = Eigen::Map<const Eigen::Matrix<double, 1, kSteps>>(levels[row].data());
    rim.rest.row(k).array() -= rim.rest.row(k).mean();
  }
  const double scatter = rim.rest.colwise().mean().squaredNorm() / kSteps;
  if (scatter <= 0) return {};
  rim.rest -= first * first.colPivHouseholderQr().solve(rim.rest).eval();
  rim.rest /= std::sqrt(scatter);
  rim.noise = kNoise * noise * noise / scatter;
  return rim;
}

/// Subtracts what varies with a function of the direction alike in all discs.
template <class Function>
void subtract_common(std::vector<Rim>& rims, Function&& of) {
  Eigen::Matrix<double, 1, kSteps> sum = Eigen::Matrix<double, 1, kSteps>::Zero();
  double squares = 0;
  for (const Rim& rim : rims)
    for (std::size_t k = 0; k < rim.turns.size(); ++k) {
      const double f = of(rim.turns[k]);
      sum += f * rim.rest.row(static_cast<Eigen::Index>(k));
      squares += f * f;
    }
  if (squares <= 0) return;
  for (Rim& rim : rims)
    for (std::size_t k = 0; k < rim.turns.size(); ++k)
      rim.rest.row(static_cast<Eigen::Index>(k)) -= of(rim.turns[k]) / squares * sum;
}

/// The value below which a share of the values lies.
double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

double rim_variation(const cv::Mat& grey, const std::vector<Detection>& discs,
                     const std::vector<double>& radii_px, const std::vector<Detection>& others,
                     const cv::Mat1b& walls) {
  constexpr std::size_t kEnough = 3;        // discs that show what they have in common
  constexpr double kRepresentative = 0.25;  // least share of discs that show their rims
  if (discs.empty() || std::min(grey.cols, grey.rows) < 2) return 0;
  cv::Mat1f levels;
  grey.convertTo(levels, CV_32F);
  const double noise = noise_level(levels);
  std::vector<Disc> places;
  std::vector<const Detection*> all;
  double reach = 0;
  for (const std::vector<Detection>* list : {&discs, &others})
    for (const Detection& d : *list) {
      places.push_back({d.x, d.y, d.radius, 1});
      all.push_back(&d);
      reach = std::max(reach, width_of(d) + kApart);
    }
  std::vector<std::vector<const Detection*>> neighbours(all.size());
  for (const auto& [i, j] : near_pairs(places, reach)) {
    neighbours[static_cast<std::size_t>(i)].push_back(all[static_cast<std::size_t>(j)]);
    neighbours[static_cast<std::size_t>(j)].push_back(all[static_cast<std::size_t>(i)]);
  }
  std::vector<Rim> rims;
  for (std::size_t b = 0; b < discs.size(); ++b) {
    Rim rim = rim_of(levels, discs[b], neighbours[b], walls, noise);
    if (rim.turns.empty()) continue;
    rim.size = nearest_size(discs[b].radius, radii_px);
    rims.push_back(std::move(rim));
  }
  if (static_cast<double>(rims.size()) < kRepresentative * static_cast<double>(discs.size())) return 0;
  if (rims.size() >= kEnough) {
    subtract_common(rims, [](double turn) { return std::cos(2 * turn); });
    subtract_common(rims, [](double turn) { return std::sin(2 * turn); });
  }
  std::vector<std::vector<double>> variations(radii_px.size());
  for (const Rim& rim : rims) {
    constexpr double kSubtracted = 3;  // parameters of each disc
    const double freedom = (static_cast<double>(rim.turns.size()) - kSubtracted) * kSteps;
    variations[rim.size].push_back(rim.rest.squaredNorm() / freedom - rim.noise);
  }
  // What lies beside beads may spoil the rims of most of them, but a further size must be clearly seen.
  const double share = radii_px.size() > 1 ? 0.5 : 0.25;
  double largest = 0;
  for (std::vector<double>& of_size : variations)
    if (!of_size.empty()) largest = std::max(largest, quantile(std::move(of_size), share));
  return largest;
}

}  // namespace twincell::imaging
