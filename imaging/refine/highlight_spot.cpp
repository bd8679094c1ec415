#include "imaging/refine/highlight_spot.hpp"

#include <algorithm>
#include <cmath>

namespace twincell::imaging {

namespace {

constexpr double kPerPixel = 2;              // values per px
constexpr double kWhole = 0.75, kEnd = 0.9;  // R: where the spot begins to vanish, and has vanished

int side_of(double radius) {
  return 2 * static_cast<int>(std::ceil(radius * kPerPixel)) + 1;
}

/// Cell of a spot's picture, and the place in it, 0 .. 1.
struct Place {
  int i, j;
  double s, t;
  bool outside;
};
Place place_of(const Detection& disc, int x, int y, int side) {
  const int middle = side / 2;
  const double u = (x - disc.x) * kPerPixel + middle, v = (y - disc.y) * kPerPixel + middle;
  if (!(u >= 0 && v >= 0 && u < side - 1 && v < side - 1)) return {0, 0, 0, 0, true};
  const int i = static_cast<int>(u), j = static_cast<int>(v);
  return {i, j, u - i, v - j, false};
}

}  // namespace

HighlightSpot::Level HighlightSpot::inside(const Detection& disc, int x, int y) const {
  const auto [i, j, s, t, outside] = place_of(disc, x, y, side_);
  if (outside) return {};
  const float *above = values_[j] + i, *under = values_[j + 1] + i;
  const double a = static_cast<double>(above[0]), right = static_cast<double>(above[1]),
               below = static_cast<double>(under[0]), both = static_cast<double>(under[1]);
  return {(1 - t) * ((1 - s) * a + s * right) + t * ((1 - s) * below + s * both),
          kPerPixel * ((1 - t) * (right - a) + t * (both - below)),
          kPerPixel * ((1 - s) * (below - a) + s * (both - right))};
}

HighlightSpot::Estimate::Estimate(double radius_px)
    : radius_(radius_px),
      sum_(cv::Mat1d::zeros(side_of(radius_px), side_of(radius_px))),
      weight_(sum_.clone()) {}

void HighlightSpot::Estimate::add(const Detection& disc, int x, int y, double residual) {
  if (std::hypot(x - disc.x, y - disc.y) >= kEnd * disc.radius) return;
  const auto [i, j, s, t, outside] = place_of(disc, x, y, sum_.cols);
  if (outside) return;
  for (const int di : {0, 1})
    for (const int dj : {0, 1}) {
      const double share = (di == 0 ? 1 - s : s) * (dj == 0 ? 1 - t : t);
      sum_(j + dj, i + di) += share * disc.darkness * residual;
      weight_(j + dj, i + di) += share * disc.darkness * disc.darkness;
    }
}

HighlightSpot HighlightSpot::Estimate::spot() const {
  constexpr double kFew = 0.5;  // discs in a cell at which the value is half of their mean
  const int side = sum_.cols, middle = side / 2;
  cv::Mat1f values(side, side);
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const double r = std::hypot(i - middle, j - middle) / kPerPixel / radius_,
                   kept = std::clamp((kEnd - r) / (kEnd - kWhole), 0.0, 1.0);
      values(j, i) = static_cast<float>(kept * sum_(j, i) / (weight_(j, i) + kFew));
    }
  return HighlightSpot(values);
}

}  // namespace twincell::imaging
