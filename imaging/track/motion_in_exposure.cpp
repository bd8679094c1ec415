#include "imaging/track/motion_in_exposure.hpp"

#include <algorithm>
#include <cmath>

#include "core/median.hpp"

namespace twincell::imaging {

namespace {

/// Median over the beads of `from` of the distance to the nearest bead of `to`, px. The true step can only be
/// larger. \param from, to ordered by y
double median_step(const std::vector<Detection>& from, const std::vector<Detection>& to) {
  if (from.empty() || to.empty()) return 0;
  std::vector<double> distances;
  distances.reserve(from.size());
  for (const Detection& a : from) {
    double nearest = HUGE_VAL;
    const auto here =
        std::lower_bound(to.begin(), to.end(), a.y, [](const Detection& d, double y) { return d.y < y; });
    for (auto b = here; b != to.end() && b->y - a.y < nearest; ++b)
      nearest = std::min(nearest, std::hypot(b->x - a.x, b->y - a.y));
    for (auto b = here; b != to.begin() && a.y - std::prev(b)->y < nearest; --b)
      nearest = std::min(nearest, std::hypot(std::prev(b)->x - a.x, std::prev(b)->y - a.y));
    distances.push_back(nearest);
  }
  return upper_median(std::move(distances));
}

}  // namespace

void MotionInExposure::add(const Located& located) {
  if (!paths_.empty()) steps_.push_back(median_step(before_, located.beads));
  paths_.push_back(located.path_px);
  before_ = located.beads;
}

bool MotionInExposure::claimed(std::size_t frame) const {
  constexpr double kMinStep = 0.5;  // median step to the next frame, fraction of the path in the exposure
  const double path = std::hypot(paths_[frame][0], paths_[frame][1]);
  double step = 0;
  if (frame > 0) step = steps_[frame - 1];
  if (frame < steps_.size()) step = std::max(step, steps_[frame]);
  return path > 0 && step >= kMinStep * path;
}

std::size_t MotionInExposure::unproven() const {
  std::size_t n = 0;
  for (std::size_t f = 0; f < paths_.size(); ++f)
    n += paths_[f] != std::array<double, 2>{} && !claimed(f) ? 1 : 0;
  return n;
}

}  // namespace twincell::imaging
