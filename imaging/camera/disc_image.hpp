#pragma once
/// \file
/// Share of a pixel's light that an opaque disc blocks: the convolution disc * Gaussian of the optics *
/// square of the pixel.
///
/// The disc convolved with the Gaussian is P(r), a function of the distance alone. The mean of P over a
/// pixel's square is, to 1e-6, F0(r) + F4(r) cos 4 theta, with theta the direction from the centre to the
/// pixel. F0 and F4 are tabulated, so that a pixel costs one look-up. The rim is not approximated by a
/// straight edge, for which a closed form exists.

#include <cmath>
#include <vector>

namespace twincell::imaging {

/// The tabulated image of a disc with one radius and one blur.
class DiscImage {
 public:
  /// \param radius_px, blur_px > 0
  DiscImage(double radius_px, double blur_px);
  /// Distance beyond which the disc blocks no light (to 1e-9), px.
  [[nodiscard]] double reach() const { return last_; }
  /// Blocked share of the pixel at (dx, dy) from the centre. The distance r is given separately, because the
  /// lens may stretch it.
  [[nodiscard]] float at(double dx, double dy, double r) const {
    if (r < first_) return 1;
    const double t = (r - first_) * kPerPixel;
    const auto i = static_cast<std::size_t>(t);
    if (i + 1 >= table_.size()) return 0;
    const auto f = static_cast<float>(t - static_cast<double>(i));
    const Entry &a = table_[i], &b = table_[i + 1];
    const double d2 = dx * dx + dy * dy, q = d2 > 0 ? dx * dx / d2 : 0;
    return a.mean + f * (b.mean - a.mean) +
           (a.fourth + f * (b.fourth - a.fourth)) * static_cast<float>(8 * q * (q - 1) + 1);
  }

 private:
  static constexpr double kPerPixel = 128;
  struct Entry {
    float mean, fourth;
  };
  double first_, last_;
  std::vector<Entry> table_;
};

}  // namespace twincell::imaging
