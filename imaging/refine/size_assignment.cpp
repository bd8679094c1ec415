#include "imaging/refine/size_assignment.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <queue>
#include <utility>

#include "core/median.hpp"
#include "imaging/refine/sparse_gauss_newton.hpp"

namespace twincell::imaging {

namespace {

/// Table of P by distance from the rim, for one blur.
class BlurredRim {
 public:
  explicit BlurredRim(double blur_px) : reach_(kSigmas * blur_px), per_px_(kSteps / (2 * reach_)) {
    for (int k = 0; k <= kSteps; ++k)
      shape_.push_back(0.5 * std::erfc((k / per_px_ - reach_) / (std::numbers::sqrt2 * blur_px)));
  }
  /// Largest distance outside the rim at which P is not negligible, px.
  [[nodiscard]] double reach() const { return reach_; }
  /// \param out distance outside the rim, px, < reach()
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
  const BlurredRim rim(blur_px);
  const double near = kInner * p.radius, far = p.radius + rim.reach();
  const int reach = cvCeil(far), x0 = cvRound(p.x), y0 = cvRound(p.y);
  std::vector<std::pair<double, double>> seen;  // d, P
  std::vector<float> within;
  for (int y = std::max(0, y0 - reach); y <= std::min(image.darkness.rows - 1, y0 + reach); ++y)
    for (int x = std::max(0, x0 - reach); x <= std::min(image.darkness.cols - 1, x0 + reach); ++x) {
      const double r2 = (x - p.x) * (x - p.x) + (y - p.y) * (y - p.y);
      // Every other pixel, in a chessboard pattern, is sufficient.
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

std::vector<Proposal> assign_sizes(const Prepared& image, const std::vector<Proposal>& proposals) {
  constexpr double kApart = 0.8;     // of R_i + R_j
  constexpr double kMissing = 0.01;  // missing share at which a disc has no evidence
  const double blur = blur_of(image.darkness);
  const Noise noise = noise_of(image.darkness);
  std::vector<Disc> discs;
  for (const Proposal& p : proposals) discs.push_back({p.x, p.y, kApart * p.radius, 1});
  std::vector<std::vector<std::size_t>> excluded(proposals.size());
  for (const auto& [i, j] : near_pairs(discs, 0)) {
    excluded[static_cast<std::size_t>(i)].push_back(static_cast<std::size_t>(j));
    excluded[static_cast<std::size_t>(j)].push_back(static_cast<std::size_t>(i));
  }
  // Ordered by evidence, or by its upper bound (nothing missing) until the picture is examined. Most
  // proposals are excluded before they are examined.
  struct Candidate {
    double evidence;
    std::size_t k;
    bool looked_at;
    bool operator<(const Candidate& o) const { return std::pair(evidence, o.k) < std::pair(o.evidence, k); }
  };
  std::vector<Candidate> all;
  for (std::size_t k = 0; k < proposals.size(); ++k)
    all.push_back({proposals[k].score * proposals[k].radius * proposals[k].radius, k, false});
  std::priority_queue<Candidate> left(std::less<Candidate>(), std::move(all));
  std::vector<bool> out(proposals.size());
  std::vector<Proposal> kept;
  while (!left.empty()) {
    Candidate best = left.top();
    left.pop();
    if (out[best.k]) continue;
    const Proposal& p = proposals[best.k];
    if (!best.looked_at) {
      const double there = 1 - missing_share(image, p, blur, noise.dark) / kMissing;
      best.evidence *= std::clamp(there, 0.0, 1.0);
      best.looked_at = true;
      left.push(best);
      continue;
    }
    kept.push_back(p);
    for (const std::size_t other : excluded[best.k]) out[other] = true;
  }
  return kept;
}

}  // namespace twincell::imaging
