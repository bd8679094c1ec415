#include "imaging/judge.hpp"

#include <algorithm>
#include <cmath>

namespace twincell {

namespace {

bool is_disc(const Detection& b, double radius_px, const JudgeOptions& o) {
  return std::isfinite(b.x) && std::isfinite(b.y) &&
         std::abs(b.radius - radius_px) <= o.radius_tolerance * radius_px && b.interior >= o.min_interior &&
         b.score >= o.min_score;
}

// Two opaque discs cannot overlap: of a pair that does, the better explained one stays.
std::vector<Detection> without_overlaps(std::vector<Detection> beads, double max_overlap) {
  std::stable_sort(beads.begin(), beads.end(),
                   [](const Detection& a, const Detection& b) { return a.score > b.score; });
  std::vector<Detection> kept;
  for (const Detection& b : beads) {
    const bool overlaps = std::any_of(kept.begin(), kept.end(), [&](const Detection& k) {
      const double touch = b.radius + k.radius, r = std::min(b.radius, k.radius);
      return std::abs(b.x - k.x) < touch && std::hypot(b.x - k.x, b.y - k.y) < touch - max_overlap * r;
    });
    if (!overlaps) kept.push_back(b);
  }
  return kept;
}

void flag_tracers(std::vector<Detection>& beads, double below) {
  if (beads.empty()) return;
  std::vector<double> interior;
  interior.reserve(beads.size());
  for (const Detection& b : beads) interior.push_back(b.interior);
  const auto middle = interior.begin() + static_cast<std::ptrdiff_t>(interior.size() / 2);
  std::nth_element(interior.begin(), middle, interior.end());
  for (Detection& b : beads) b.tracer = b.interior < below * *middle;
}

}  // namespace

std::vector<Detection> judge(std::vector<Detection> beads, double radius_px, int width, int height,
                             const JudgeOptions& options) {
  std::erase_if(beads, [&](const Detection& b) { return !is_disc(b, radius_px, options); });
  beads = without_overlaps(std::move(beads), options.max_overlap);
  std::erase_if(beads, [&](const Detection& b) {
    return b.x < -0.5 || b.y < -0.5 || b.x >= width - 0.5 || b.y >= height - 0.5;
  });
  for (Detection& b : beads)
    b.edge = b.x - b.radius < -0.5 || b.y - b.radius < -0.5 || b.x + b.radius > width - 0.5 ||
             b.y + b.radius > height - 0.5;
  flag_tracers(beads, options.tracer_below);
  std::sort(beads.begin(), beads.end(),
            [](const Detection& a, const Detection& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
  return beads;
}

}  // namespace twincell
