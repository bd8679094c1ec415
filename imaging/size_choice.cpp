#include "imaging/size_choice.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "analysis/trajectory/median.hpp"
#include "imaging/coupled_step.hpp"

namespace twincell {

namespace {

/// P by distance from the rim, for one blur.
class Rim {
 public:
  explicit Rim(double blur_px) : reach_(kSigmas * blur_px), per_px_(kSteps / (2 * reach_)) {
    for (int k = 0; k <= kSteps; ++k)
      shape_.push_back(0.5 * std::erfc((k / per_px_ - reach_) / (std::numbers::sqrt2 * blur_px)));
  }
  /// How far beyond the rim there is anything.
  [[nodiscard]] double reach() const { return reach_; }
  /// \param out  px beyond the rim, < reach()
  [[nodiscard]] double at(double out) const {
    return out < -reach_ ? 1 : shape_[static_cast<std::size_t>((out + reach_) * per_px_ + 0.5)];
  }

 private:
  static constexpr int kSteps = 256;
  static constexpr double kSigmas = 2;
  double reach_, per_px_;
  std::vector<double> shape_;
};

}  // namespace

double missing_share(const Prepared& image, const Proposal& p, double blur_px, double noise_variance) {
  constexpr double kInner = 0.5;  // of R
  const Rim rim(blur_px);
  const double near = kInner * p.radius, far = p.radius + rim.reach();
  const int reach = cvCeil(far), x0 = cvRound(p.x), y0 = cvRound(p.y);
  std::vector<std::pair<double, double>> seen;  // d, P
  std::vector<float> within;
  for (int y = std::max(0, y0 - reach); y <= std::min(image.darkness.rows - 1, y0 + reach); ++y)
    for (int x = std::max(0, x0 - reach); x <= std::min(image.darkness.cols - 1, x0 + reach); ++x) {
      const double r2 = (x - p.x) * (x - p.x) + (y - p.y) * (y - p.y);
      // One pixel of two tells as much.
      if ((x + y) % 2 != 0 || r2 < near * near || r2 >= far * far) continue;
      const double out = std::sqrt(r2) - p.radius;
      const float d = image.darkness(y, x);
      seen.emplace_back(d, rim.at(out));
      if (out < -blur_px) within.push_back(d);
    }
  if (within.empty()) return 1;
  const auto a = static_cast<double>(upper_median(std::move(within)));
  double missing = 0, all = 0;
  for (const auto& [d, shape] : seen) {
    const double short_of = std::max(0.0, a * shape - d);
    missing += short_of * short_of - 0.5 * noise_variance;
    all += a * a * shape * shape;
  }
  return all > 0 ? missing / all : 1;
}

std::vector<Proposal> choose_sizes(const Prepared& image, const std::vector<Proposal>& proposals) {
  constexpr double kApart = 0.8;     // of R_i + R_j
  constexpr double kMissing = 0.01;  // of a disc that is none
  const double blur = blur_of(image.darkness);
  const Noise noise = noise_of(image.darkness);
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k < proposals.size(); ++k) {
    const Proposal& p = proposals[k];
    const double there = 1 - missing_share(image, p, blur, noise.dark) / kMissing;
    order.emplace_back(-p.score * (there > 0 ? p.radius * p.radius * there : 0), k);
  }
  std::sort(order.begin(), order.end());
  std::vector<Proposal> ranked;
  std::vector<Disc> discs;
  for (const auto& entry : order) {
    const Proposal& p = ranked.emplace_back(proposals[entry.second]);
    discs.push_back({p.x, p.y, kApart * p.radius, 1});
  }
  std::vector<std::vector<std::size_t>> better(ranked.size());
  for (const auto& [i, j] : near_pairs(discs, 0))
    better[static_cast<std::size_t>(std::max(i, j))].push_back(static_cast<std::size_t>(std::min(i, j)));
  std::vector<bool> stays(ranked.size());
  std::vector<Proposal> kept;
  for (std::size_t k = 0; k < ranked.size(); ++k) {
    stays[k] = std::none_of(better[k].begin(), better[k].end(), [&](std::size_t b) { return stays[b]; });
    if (stays[k]) kept.push_back(ranked[k]);
  }
  return kept;
}

}  // namespace twincell
