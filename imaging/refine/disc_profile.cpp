#include "imaging/refine/disc_profile.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace twincell::imaging {

namespace {

constexpr double kRim = 0.2;  // smallest level of the rim, as a fraction of the largest level
constexpr double kShoulder = 0.1, kNear = 0.2;  // smallest level of a shoulder; distance from R, in R
constexpr float kSteeper = 1.5F;                // than the flattest place between reflection and shoulder

/// The steepest place about index `most` of falls between levels, in levels, refined with a parabola.
double steepest_near(const std::vector<float>& fall, std::size_t most) {
  double at = static_cast<double>(most) + 0.5;
  if (most > 0 && most + 1 < fall.size()) {
    const double before = static_cast<double>(fall[most - 1]), after = static_cast<double>(fall[most + 1]),
                 curvature = before - 2 * static_cast<double>(fall[most]) + after;
    if (curvature < 0) at += 0.5 * (before - after) / curvature;
  }
  return at;
}

}  // namespace

double DiscProfile::at(double r) const {
  return level_at(*this, r).value;
}

double DiscProfile::rim() const {
  const double rim = outer_rim();
  if (!(rim > 0) || rim > (1 - kNear) * radius_px) return rim;
  return shoulder(rim).value_or(rim);
}

double DiscProfile::rim_of_known() const {
  const double out = rim();
  if (std::abs(out - radius_px) <= kNear * radius_px) return out;
  const auto begin = static_cast<std::size_t>((1 - kNear) * radius_px * kPerPixel),
             end = static_cast<std::size_t>((1 + kNear) * radius_px * kPerPixel);
  if (out > radius_px || end >= levels.size() ||
      std::abs(static_cast<double>(levels[begin])) <= kShoulder * largest())
    return 0;
  const std::vector<float> fall = falls(begin);
  const auto last = fall.begin() + static_cast<std::ptrdiff_t>(std::min(end - begin, fall.size()));
  const auto most = static_cast<std::size_t>(std::max_element(fall.begin(), last) - fall.begin());
  return (static_cast<double>(begin) + steepest_near(fall, most)) / kPerPixel;
}

double DiscProfile::outer_rim() const {
  const auto high = static_cast<float>(kRim * largest());
  if (high == 0) return 0;
  // From outside inwards to the first extremum that is high enough.
  std::size_t top = levels.size() - 1;
  while (top > 0 && !(std::abs(levels[top]) > high && std::abs(levels[top]) >= std::abs(levels[top - 1])))
    --top;
  // From there outwards, the steepest descent.
  const std::vector<float> fall = falls(top);
  if (fall.empty()) return radius_px;
  const auto most = static_cast<std::size_t>(std::max_element(fall.begin(), fall.end()) - fall.begin());
  return (static_cast<double>(top) + steepest_near(fall, most)) / kPerPixel;
}

std::optional<double> DiscProfile::shoulder(double inner_px) const {
  const auto begin = static_cast<std::size_t>(inner_px * kPerPixel);
  if (begin >= levels.size()) return std::nullopt;
  const std::vector<float> fall = falls(begin);
  std::optional<std::size_t> best;
  float least = HUGE_VALF;  // of the falls inside of the shoulder
  for (std::size_t k = 1; k + 1 < fall.size(); ++k) {
    least = std::min(least, fall[k - 1]);
    const double at = (static_cast<double>(begin + k) + 0.5) / kPerPixel,
                 level = std::abs(static_cast<double>(levels[begin + k]));
    if (std::abs(at - radius_px) < kNear * radius_px && level > kShoulder * largest() &&
        fall[k] >= fall[k - 1] && fall[k] > fall[k + 1] && fall[k] > kSteeper * std::max(0.0F, least) &&
        (!best || fall[k] > fall[*best]))
      best = k;
  }
  if (!best) return std::nullopt;
  return (static_cast<double>(begin) + steepest_near(fall, *best)) / kPerPixel;
}

std::vector<float> DiscProfile::falls(std::size_t top) const {
  std::vector<float> fall;
  for (std::size_t k = top; k + 1 < levels.size(); ++k)
    fall.push_back((levels[k] - levels[k + 1]) * (levels[top] < 0 ? -1.0F : 1.0F));
  return fall;
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
