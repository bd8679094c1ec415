#include "imaging/refine/disc_profile.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace twincell::imaging {

namespace {

constexpr double kRim = 0.2;  // smallest level of the rim, as a fraction of the largest level

}  // namespace

ProfileLevel level_at(const DiscProfile& f, double r) {
  const double t = r * DiscProfile::kPerPixel;
  const auto k = static_cast<std::size_t>(t);
  if (k + 1 >= f.levels.size()) return {0, 0};
  const double part = t - static_cast<double>(k), a = static_cast<double>(f.levels[k]),
               b = static_cast<double>(f.levels[k + 1]);
  return {a + part * (b - a), (b - a) * DiscProfile::kPerPixel};
}

double DiscProfile::at(double r) const {
  return level_at(*this, r).value;
}

double DiscProfile::rim() const {
  const auto high = static_cast<float>(kRim * largest());
  if (high == 0) return 0;
  // From outside inwards to the first extremum that is high enough.
  std::size_t top = levels.size() - 1;
  while (top > 0 && !(std::abs(levels[top]) > high && std::abs(levels[top]) >= std::abs(levels[top - 1])))
    --top;
  // From there outwards, the steepest descent, refined with a parabola.
  std::vector<float> fall;
  for (std::size_t k = top; k + 1 < levels.size(); ++k)
    fall.push_back((levels[k] - levels[k + 1]) * (levels[top] < 0 ? -1.0F : 1.0F));
  if (fall.empty()) return radius_px;
  const auto most = static_cast<std::size_t>(std::max_element(fall.begin(), fall.end()) - fall.begin());
  double at = static_cast<double>(top + most) + 0.5;
  if (most > 0 && most + 1 < fall.size()) {
    const double before = static_cast<double>(fall[most - 1]), after = static_cast<double>(fall[most + 1]),
                 curvature = before - 2 * static_cast<double>(fall[most]) + after;
    if (curvature < 0) at += 0.5 * (before - after) / curvature;
  }
  return at / kPerPixel;
}

double DiscProfile::largest() const {
  float most = 0;
  for (const float f : levels) most = std::max(most, std::abs(f));
  return static_cast<double>(most);
}

double DiscProfile::difference_from_plain() const {
  constexpr double kSharpest = 0.4, kSoftest = 3.2, kRatio = 1.2;  // blur, px
  const double out = rim();
  double all = 0;
  for (std::size_t k = 0; k < levels.size(); ++k)
    all += static_cast<double>(k) * std::pow(static_cast<double>(levels[k]), 2);
  if (all <= 0) return 0;
  double least = 1;
  for (double blur = kSharpest; blur < kSoftest; blur *= kRatio) {
    double common = 0, of_plain = 0;
    for (std::size_t k = 0; k < levels.size(); ++k) {
      const double r = static_cast<double>(k) / kPerPixel,
                   plain = 0.5 * std::erfc((r - out) / (blur * std::numbers::sqrt2));
      common += static_cast<double>(k) * plain * static_cast<double>(levels[k]);
      of_plain += static_cast<double>(k) * plain * plain;
    }
    least = std::min(least, 1 - common * common / (of_plain * all));
  }
  return least;
}

}  // namespace twincell::imaging
