#include "imaging/edge_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "imaging/disc_measures.hpp"

namespace twincell {

namespace {

constexpr double kRing = 2.5;  // px
constexpr int kRounds = 3;
constexpr double kMinInterior = 0.3;  // as the opaque fit asks of a proposal
constexpr double kMinSlope = 0.05;    // darkness per pixel, as the vote asks of a pixel

struct EdgeSums {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double weight = 0, squares = 0;
  int pixels = 0;
};

EdgeSums edge_of(const cv::Mat1f& darkness, const Detection& b) {
  EdgeSums sums;
  const double reach = b.radius + kRing;
  const int last_row = std::min(darkness.rows - 2, cvFloor(b.y + reach));
  for (int y = std::max(1, cvCeil(b.y - reach)); y <= last_row; ++y) {
    const double dy = y - b.y, half = std::sqrt(std::max(0.0, reach * reach - dy * dy));
    const float *above = darkness[y - 1], *row = darkness[y], *below = darkness[y + 1];
    const int last = std::min(darkness.cols - 2, cvFloor(b.x + half));
    for (int x = std::max(1, cvCeil(b.x - half)); x <= last; ++x) {
      const double dx = x - b.x, r = std::sqrt(dx * dx + dy * dy), off = r - b.radius;
      if (std::abs(off) > kRing || r == 0) continue;
      ++sums.pixels;
      const auto gx = static_cast<double>(row[x + 1] - row[x - 1]),
                 gy = static_cast<double>(below[x] - above[x]);
      const double slope = -0.5 * (gx * dx + gy * dy) / r;
      if (slope < kMinSlope) continue;
      const Eigen::Vector3d j(dx / r, dy / r, 1);
      sums.a += slope * j * j.transpose();
      sums.right += slope * off * j;
      sums.weight += slope;
      sums.squares += slope * off * off;
    }
  }
  return sums;
}

}  // namespace

Refined refine_by_edges(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px) {
  Refined result;
  result.sweeps = kRounds;
  for (const Proposal& p : proposals) {
    Detection b;
    b.x = p.x, b.y = p.y, b.radius = radius_px, b.darkness = 1;
    const auto drop = [&](Verdict why) {
      b.verdict = why;
      result.dropped.push_back(b);
    };
    if (in_wall(image, b)) {
      drop(Verdict::in_wall);
      continue;
    }
    if (rough_interior(image, b) < kMinInterior) {
      drop(Verdict::bright_inside);
      continue;
    }
    EdgeSums sums;
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    for (int round = 0; round < kRounds; ++round) {
      sums = edge_of(image.darkness, b);
      // As if a twentieth of a whole edge already lay where the proposal has it: an arc alone does not say
      // where a circle ends.
      sums.a.diagonal().array() += 0.05 * 2 * std::numbers::pi * radius_px;
      step = sums.a.llt().solve(sums.right);
      b.x += std::clamp(step[0], -1.0, 1.0);
      b.y += std::clamp(step[1], -1.0, 1.0);
      b.radius = std::clamp(b.radius + std::clamp(step[2], -0.5, 0.5), 0.6 * radius_px, 1.4 * radius_px);
    }
    if (sums.weight < 0.02 * 2 * std::numbers::pi * radius_px) {
      drop(Verdict::unseen);
      continue;
    }
    const double spread = std::max(0.0, sums.squares - step.dot(sums.right)) / sums.weight;
    const Eigen::Matrix3d covariance = spread * sums.a.inverse();
    b.sigma_x = std::sqrt(covariance(0, 0));
    b.sigma_y = std::sqrt(covariance(1, 1));
    b.sigma_radius = std::sqrt(covariance(2, 2));
    b.score = std::clamp(1 - spread / (kRing * kRing / 3), 0.0, 1.0);
    b.ring_share = sums.pixels / (4 * std::numbers::pi * b.radius * kRing);
    measure_disc(image, b);
    b.darkness = b.interior;
    result.beads.push_back(b);
  }
  return result;
}

}  // namespace twincell
