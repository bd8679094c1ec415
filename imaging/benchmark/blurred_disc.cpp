#include "imaging/benchmark/blurred_disc.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace twincell::imaging::rendered {

namespace {

constexpr double kStep = 1.0 / 16;

// exp(-z) I_n(z): from the standard library, or from the asymptotic series where the library overflows.
double scaled_bessel(double n, double z) {
  if (z < 500) return std::exp(-z) * std::cyl_bessel_i(n, z);
  const double m = 4 * n * n;
  double term = 1, sum = 1;
  for (int k = 1; k < 8; ++k) {
    term *= -(m - (2 * k - 1) * (2 * k - 1)) / (k * 8 * z);
    sum += term;
  }
  return sum / std::sqrt(2 * std::numbers::pi * z);
}

// The table at index t, by linear interpolation; 0 outside of it.
double interpolated(const std::vector<double>& table, double t) {
  if (t < 0) return 0;
  const auto i = static_cast<std::size_t>(t);
  if (i + 1 >= table.size()) return 0;
  const double f = t - static_cast<double>(i);
  return (1 - f) * table[i] + f * table[i + 1];
}

}  // namespace

BlurredDisc::BlurredDisc(double radius, double blur) : radius_(radius), blur_(blur), rim_(7 * blur) {
  first_ = std::max(0.0, radius - rim_ - kStep);
  const double s2 = blur * blur;
  const int n = static_cast<int>(std::ceil((radius + rim_ + kStep - first_) / kStep)) + 1;
  auto along_rim = [&](double order, double r) {
    return radius / s2 * std::exp(-0.5 * (r - radius) * (r - radius) / s2) *
           scaled_bessel(order, r * radius / s2);
  };
  for (int i = 0; i < n; ++i) {
    const double r = first_ + i * kStep;
    slope_.push_back(-along_rim(1, r));
    by_radius_.push_back(along_rim(0, r));
  }
  // P: Simpson's rule on dP/dr, starting outside the disc, where P is 0.
  value_.assign(slope_.size(), 0);
  for (int i = n - 2; i >= 0; --i) {
    const auto k = static_cast<std::size_t>(i);
    const double middle = -along_rim(1, first_ + (i + 0.5) * kStep);
    value_[k] = value_[k + 1] - kStep / 6 * (slope_[k] + 4 * middle + slope_[k + 1]);
  }
}

double BlurredDisc::value(double r) const {
  if (r < first_) return value_.front();
  const double t = (r - first_) / kStep;
  const auto i = static_cast<std::size_t>(t);
  if (i + 1 >= value_.size()) return 0;
  const double f = t - static_cast<double>(i), g = 1 - f;
  return g * g * ((1 + 2 * f) * value_[i] + f * kStep * slope_[i]) +
         f * f * ((1 + 2 * g) * value_[i + 1] - g * kStep * slope_[i + 1]);
}

double BlurredDisc::by_distance(double r) const {
  return interpolated(slope_, (r - first_) / kStep);
}

double BlurredDisc::by_radius(double r) const {
  return interpolated(by_radius_, (r - first_) / kStep);
}

}  // namespace twincell::imaging::rendered
