#include "imaging/refine/rim_samples.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "imaging/refine/sparse_gauss_newton.hpp"

namespace twincell::imaging {

namespace {

constexpr int kSamplesPerDirection = 3;  // averaged
constexpr double kMinGap_px = 1.5;       // to the rims of other discs
constexpr int kMinDirections = kRimDirections / 3;

double interpolated(const cv::Mat1f& grey, double x, double y) {
  const int i = std::min(static_cast<int>(x), grey.cols - 2),
            j = std::min(static_cast<int>(y), grey.rows - 2);
  const double u = x - i, v = y - j;
  return (1 - v) * ((1 - u) * static_cast<double>(grey(j, i)) + u * static_cast<double>(grey(j, i + 1))) +
         v * ((1 - u) * static_cast<double>(grey(j + 1, i)) + u * static_cast<double>(grey(j + 1, i + 1)));
}

/// \param others discs that may hide parts of the rim, \param walls regions that do
RimSamples samples_of(const cv::Mat1f& grey, const Detection& d, const std::vector<const Detection*>& others,
                      const cv::Mat1b& walls) {
  const double width = rim_width_px(d.radius);
  const auto at = [&](int step) { return d.radius + width * (2.0 * step / (kRimSteps - 1) - 1); };
  RimSamples rim;
  std::vector<std::array<double, kRimSteps>> levels;
  for (int k = 0; k < kRimDirections; ++k) {
    std::array<double, kRimSteps> sum{};
    bool seen = true;
    for (int t = 0; t < kSamplesPerDirection && seen; ++t) {
      const double turn = 2 * std::numbers::pi * (k * kSamplesPerDirection + t + 0.5) /
                          (kRimDirections * kSamplesPerDirection);
      // Outermost first, because there it is most often hidden.
      for (int step = kRimSteps - 1; step >= 0 && seen; --step) {
        const double x = d.x + at(step) * std::cos(turn), y = d.y + at(step) * std::sin(turn);
        seen = x >= 0 && y >= 0 && x <= grey.cols - 1 && y <= grey.rows - 1 &&
               (walls.empty() || walls(cvRound(y), cvRound(x)) == 0) &&
               std::none_of(others.begin(), others.end(), [&](const Detection* o) {
                 const double dx = x - o->x, dy = y - o->y, far = o->radius + kMinGap_px;
                 return dx * dx + dy * dy < far * far;
               });
        if (seen) sum[static_cast<std::size_t>(step)] += interpolated(grey, x, y) / kSamplesPerDirection;
      }
    }
    if (!seen) continue;
    rim.turns.push_back(2 * std::numbers::pi * (k + 0.5) / kRimDirections);
    levels.push_back(sum);
  }
  const auto n = static_cast<Eigen::Index>(levels.size());
  if (n < kMinDirections) return {};
  rim.levels.resize(n, kRimSteps);
  for (Eigen::Index k = 0; k < n; ++k)
    rim.levels.row(k) =
        Eigen::Map<const Eigen::Matrix<double, 1, kRimSteps>>(levels[static_cast<std::size_t>(k)].data());
  return rim;
}

}  // namespace

std::vector<RimSamples> rim_samples(const cv::Mat1f& grey, const std::vector<Detection>& discs,
                                    const std::vector<Detection>& others, const cv::Mat1b& walls) {
  std::vector<Disc> places;
  std::vector<const Detection*> all;
  double reach = 0;
  for (const std::vector<Detection>* list : {&discs, &others})
    for (const Detection& d : *list) {
      places.push_back({d.x, d.y, d.radius, 1});
      all.push_back(&d);
      reach = std::max(reach, rim_width_px(d.radius) + kMinGap_px);
    }
  std::vector<std::vector<const Detection*>> neighbours(all.size());
  for (const auto& [i, j] : near_pairs(places, reach)) {
    neighbours[static_cast<std::size_t>(i)].push_back(all[static_cast<std::size_t>(j)]);
    neighbours[static_cast<std::size_t>(j)].push_back(all[static_cast<std::size_t>(i)]);
  }
  std::vector<RimSamples> rims(discs.size());
  if (std::min(grey.cols, grey.rows) < 2) return rims;
  for (std::size_t b = 0; b < discs.size(); ++b) rims[b] = samples_of(grey, discs[b], neighbours[b], walls);
  return rims;
}

}  // namespace twincell::imaging
