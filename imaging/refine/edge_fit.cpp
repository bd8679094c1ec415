#include "imaging/refine/edge_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "imaging/refine/disc_measures.hpp"

namespace twincell::imaging {

namespace {

// Half width of the ring in each round: at least kMinRing px, and for large discs the given fractions of
// their radius, because the proposal of a large disc is coarse.
constexpr double kMinRing = 2.5;
constexpr std::array<double, 5> kRings = {0.08, 0.06, 0.05, 0.05, 0.05};
// From this radius on (px) the edge is long enough to require that kMinSeen of it is visible.
constexpr double kLarge = 25;
constexpr double kMinSeen = 0.4;
constexpr std::size_t kSectors = 36;
constexpr double kMinSlope = 0.05;  // darkness per pixel, as the vote requires of a pixel

struct EdgeSums {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double weight = 0, squares = 0;
  int pixels = 0;
  std::array<double, kSectors> slopes{}, offs{};  // sums of slope and of slope times off in each sector
};

EdgeSums edge_of(const cv::Mat1f& darkness, const Detection& b, double ring) {
  EdgeSums sums;
  const double reach = b.radius + ring;
  const int last_row = std::min(darkness.rows - 2, cvFloor(b.y + reach));
  for (int y = std::max(1, cvCeil(b.y - reach)); y <= last_row; ++y) {
    const double dy = y - b.y, half = std::sqrt(std::max(0.0, reach * reach - dy * dy));
    const float *above = darkness[y - 1], *row = darkness[y], *below = darkness[y + 1];
    const int last = std::min(darkness.cols - 2, cvFloor(b.x + half));
    for (int x = std::max(1, cvCeil(b.x - half)); x <= last; ++x) {
      const double dx = x - b.x, r = std::sqrt(dx * dx + dy * dy), off = r - b.radius;
      if (std::abs(off) > ring || r == 0) continue;
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
      const double turn = 0.5 + std::atan2(dy, dx) / (2 * std::numbers::pi);
      const std::size_t sector = std::min(kSectors - 1, static_cast<std::size_t>(turn * kSectors));
      sums.slopes[sector] += slope;
      sums.offs[sector] += slope * off;
    }
  }
  return sums;
}

/// Fraction of the visible part of the circle on which an edge is found.
double seen(const EdgeSums& sums, const Detection& b, double ring, cv::Size size) {
  // Smallest sum of slopes in a sector: an edge with the smallest slope, two pixels wide along the arc.
  const double enough = 2 * kMinSlope * 2 * std::numbers::pi * b.radius / kSectors;
  int inside = 0, on = 0;
  for (std::size_t k = 0; k < kSectors; ++k) {
    const double turn = 2 * std::numbers::pi * ((static_cast<double>(k) + 0.5) / kSectors - 0.5);
    const double x = b.x + b.radius * std::cos(turn), y = b.y + b.radius * std::sin(turn);
    if (x < 0 || y < 0 || x > size.width - 1 || y > size.height - 1) continue;
    ++inside;
    on += sums.slopes[k] > enough && std::abs(sums.offs[k]) < 0.4 * ring * sums.slopes[k];
  }
  return inside > 0 ? static_cast<double>(on) / inside : 0;
}

}  // namespace

Refined refine_by_edges(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
                        const RefineOptions& /*options*/) {
  Refined result;
  result.sweeps = static_cast<int>(kRings.size());
  for (const Proposal& p : proposals) {
    // Check: proposals in walls or on bright areas are dropped at once.
    Detection b;
    const double radius = p.radius > 0 ? p.radius : radius_px;
    b.x = p.x, b.y = p.y, b.radius = radius, b.darkness = 1;
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
    // Fit: rounds with narrower rings.
    EdgeSums sums;
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    double ring = kMinRing;
    for (const double wide : kRings) {
      ring = std::max(kMinRing, wide * radius);
      sums = edge_of(image.darkness, b, ring);
      // Prior: a twentieth of a whole edge at the proposed circle. A short arc alone does not determine the
      // circle.
      sums.a.diagonal().array() += 0.05 * 2 * std::numbers::pi * radius;
      step = sums.a.llt().solve(sums.right);
      const double most = std::max(1.0, 0.5 * ring);
      b.x += std::clamp(step[0], -most, most);
      b.y += std::clamp(step[1], -most, most);
      b.radius =
          std::clamp(b.radius + std::clamp(step[2], -0.5 * most, 0.5 * most), 0.6 * radius, 1.4 * radius);
    }
    // Result: visibility, uncertainties from the spread of the edge, score.
    if (sums.weight < 0.02 * 2 * std::numbers::pi * radius) {
      drop(Verdict::unseen);
      continue;
    }
    b.ring_share = seen(sums, b, ring, image.darkness.size());
    if (radius > kLarge && b.ring_share < kMinSeen) {
      drop(Verdict::unexplained);
      continue;
    }
    const double spread = std::max(0.0, sums.squares - step.dot(sums.right)) / sums.weight;
    const Eigen::Matrix3d covariance = spread * sums.a.inverse();
    b.sigma_x = std::sqrt(covariance(0, 0));
    b.sigma_y = std::sqrt(covariance(1, 1));
    b.sigma_radius = std::sqrt(covariance(2, 2));
    b.score = std::clamp(1 - spread / (ring * ring / 3), 0.0, 1.0);
    if (radius > kLarge) b.score = b.ring_share;  // fringes inside and outside would lower it
    measure_disc(image, b);
    b.darkness = b.interior;
    result.beads.push_back(b);
  }
  return result;
}

}  // namespace twincell::imaging
