#include "imaging/camera/disc_image.hpp"

#include <algorithm>
#include <array>
#include <numbers>

namespace twincell::imaging {

namespace {

// P(r): perpendicular to the line from the centre to the point, the Gaussian integrates to an error function.
// Along this line, the midpoint rule in the disc's polar angle converges exponentially.
double blurred(double radius, double s, double r) {
  const int n = std::max(200, static_cast<int>(40 * radius / s));
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double angle = std::numbers::pi * (i + 0.5) / n, u = -radius * std::cos(angle);
    if (std::abs(u - r) > 7 * s) continue;
    const double half = radius * std::sin(angle);
    sum += std::numbers::pi / n * half * std::exp(-0.5 * (u - r) * (u - r) / (s * s)) /
           (std::sqrt(2 * std::numbers::pi) * s) * std::erf(half / (std::numbers::sqrt2 * s));
  }
  return sum;
}

// Gauss-Legendre nodes and weights on a pixel.
constexpr std::array<std::pair<double, double>, 4> kNodes{{{-0.43056815579702629, 0.17392742256872693},
                                                           {-0.16999052179242813, 0.32607257743127307},
                                                           {0.16999052179242813, 0.32607257743127307},
                                                           {0.43056815579702629, 0.17392742256872693}}};

}  // namespace

DiscImage::DiscImage(double radius, double blur) {
  constexpr double kHalfDiagonal = 0.7072;
  constexpr int kFine = 32;  // samples of P per pixel; cubic interpolation between them
  const double rim = 6.2 * blur + kHalfDiagonal;
  first_ = std::max(0.0, radius - rim);
  last_ = radius + rim;
  const double from = std::max(0.0, first_ - 1);
  std::vector<double> fine;
  for (int i = 0; i < static_cast<int>((last_ + 2 - from) * kFine) + 3; ++i)
    fine.push_back(blurred(radius, blur, from + static_cast<double>(i) / kFine));
  auto p = [&](double r) {
    const double t = (r - from) * kFine;
    if (t <= 0) return fine.front();
    const auto i = std::clamp<std::size_t>(static_cast<std::size_t>(t), 1, fine.size() - 3);
    const double f = t - static_cast<double>(i);
    const double a = fine[i - 1], b = fine[i], c = fine[i + 1],
                 d = fine[i + 2];  // Lagrange cubic
    return -f * (f - 1) * (f - 2) / 6 * a + (f + 1) * (f - 1) * (f - 2) / 2 * b -
           (f + 1) * f * (f - 2) / 2 * c + (f + 1) * f * (f - 1) / 6 * d;
  };
  auto pixel = [&](double r, double angle) {
    double sum = 0;
    for (const auto& [v, wv] : kNodes)
      for (const auto& [u, wu] : kNodes)
        sum += wu * wv * p(std::hypot(r * std::cos(angle) + u, r * std::sin(angle) + v));
    return sum;
  };
  // The values at the angles 0, pi/8 and pi/4 separate the harmonics 0, 4 and 8; the eighth is dropped.
  for (int i = 0; i <= static_cast<int>((last_ - first_) * kPerPixel) + 1; ++i) {
    const double r = first_ + i / kPerPixel;
    const double axis = pixel(r, 0), half = pixel(r, std::numbers::pi / 8),
                 diagonal = pixel(r, std::numbers::pi / 4);
    table_.push_back({static_cast<float>(0.25 * (axis + 2 * half + diagonal)),
                      static_cast<float>(0.5 * (axis - diagonal))});
  }
}

}  // namespace twincell::imaging
