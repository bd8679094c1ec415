#include "imaging/drawing/view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"

namespace twincell::imaging {

namespace {

// Room for the texts and the colour bar, px.
constexpr int kLeft = 24, kRight = 24, kColourBar = 152, kTop = 40, kBottom = 56;
constexpr double kTurn = std::numbers::pi / 6, kTilt = std::numbers::pi / 12;

}  // namespace

View::View(const Box& box, double bottom, double top, bool colour_bar, double pixels_per_sigma)
    : planar_(box.dimension == 2), centre_((box.lower + box.upper) / 2), height_(top - bottom) {
  centre_.z() = (bottom + top) / 2;
  Vec3 low = box.lower, high = box.upper;
  low.z() = bottom, high.z() = top;
  distance_ = 3 * (high - low).norm();
  std::array<double, 2> least = {1e300, 1e300}, most = {-1e300, -1e300};
  double near = 1e300, far = -1e300;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 r((corner & 1) != 0 ? high.x() : low.x(), (corner & 2) != 0 ? high.y() : low.y(),
                 (corner & 4) != 0 ? high.z() : low.z());
    const auto [right, up, magnification, depth] = turned(r);
    least = {std::min(least[0], right), std::min(least[1], up)};
    most = {std::max(most[0], right), std::max(most[1], up)};
    near = std::min(near, depth), far = std::max(far, depth);
  }
  near_ = near, far_ = std::max(far, near + 1e-9);
  const double width = most[0] - least[0], height = most[1] - least[1];
  constexpr double kDefaultSide = 900, kMaxSide = 8000;  // px
  constexpr double kMinScale = 0.5, kMaxScale = 60;      // px per sigma
  scale_ = pixels_per_sigma > 0 ? pixels_per_sigma
                                : std::clamp(kDefaultSide / std::max(width, height), kMinScale, kMaxScale);
  if (std::max(width, height) * scale_ > kMaxSide)
    throw ConfigError(Where{.file = {}, .key = "--pixels-per-sigma"},
                      fmt::format("{:.4g} makes a picture of {:.0f} px; at most {:.0f} are drawn.", scale_,
                                  std::max(width, height) * scale_, kMaxSide));
  // Labels need some width and height even if the cell is narrow.
  constexpr int kMinWidth = 452, kMinHeight = 120;  // px
  const int bar = colour_bar ? kColourBar : 0;
  const int columns = std::max(static_cast<int>(std::ceil(width * scale_)), kMinWidth - bar);
  const int rows = std::max(static_cast<int>(std::ceil(height * scale_)), kMinHeight);
  cell_ = {kLeft, kTop, columns, rows};
  // Films need even sides.
  size_ = {(kLeft + columns + bar + kRight + 1) / 2 * 2, (kTop + rows + kBottom + 1) / 2 * 2};
  origin_ = {kLeft + (columns - width * scale_) / 2 - least[0] * scale_, kTop + rows + least[1] * scale_};
}

std::array<double, 4> View::turned(const Vec3& r) const {
  const Vec3 d = r - centre_;
  if (planar_) return {d.x(), d.z(), 1, 0};
  const double right = std::cos(kTurn) * d.x() + std::sin(kTurn) * d.y();
  const double back = -std::sin(kTurn) * d.x() + std::cos(kTurn) * d.y();
  const double up = std::cos(kTilt) * d.z() + std::sin(kTilt) * back;
  const double depth = std::cos(kTilt) * back - std::sin(kTilt) * d.z();
  const double magnification = distance_ / std::max(distance_ + depth, distance_ / 10);
  return {right * magnification, up * magnification, magnification, depth};
}

Projected View::project(const Vec3& r) const {
  const auto [right, up, magnification, depth] = turned(r);
  return {.at = {origin_.x + right * scale_, origin_.y - up * scale_},
          .scale = scale_ * magnification,
          .depth = planar_ ? 0 : std::clamp((depth - near_) / (far_ - near_), 0.0, 1.0)};
}

}  // namespace twincell::imaging
