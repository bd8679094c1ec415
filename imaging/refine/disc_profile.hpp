#pragma once
/// \file
/// The radial profile of darkness of a disc.

#include <cstddef>
#include <optional>
#include <vector>

namespace twincell::imaging {

/// The radial profile shared by discs of the same appearance.
struct DiscProfile {
  static constexpr double kPerPixel = 2;  ///< levels per px
  double radius_px = 0;                   ///< R for which the profile was learnt; 0: no profile
  double ground = 0;                      ///< g, darkness between the discs
  std::vector<float> levels;              ///< f at r = k/kPerPixel; 0 beyond the last
  /// f at distance r, px, from the centre of a disc of radius R.
  [[nodiscard]] double at(double r) const;
  /// Radius of the outer rim, px: where f falls most steeply outside its outermost extremum that exceeds a
  /// fifth of the largest |f|. The reflection on a steel ball is many times as bright as its body: if that
  /// place is more than a fifth of R inside of R, the steepest shoulder within a fifth of R counts instead.
  [[nodiscard]] double rim() const;
  /// Radius of the rim of discs whose radius is known to about a fifth, px: rim() if it is within a fifth of
  /// R. Otherwise, if |f| at 0.8 R is above a tenth of its largest value, the steepest fall between 0.8
  /// and 1.2 R, where the discs end even if a highlight falls more steeply. 0: the discs clearly have another
  /// size.
  [[nodiscard]] double rim_of_known() const;
  /// The largest |f|, darkness.
  [[nodiscard]] double largest() const;
  /// Fraction of the sum of f^2 over the disc's area that a plain disc with this rim, at its best-fitting
  /// blur, leaves unexplained. Below 0.01 for opaque discs, including those with a small bright spot.
  [[nodiscard]] double difference_from_plain() const;

 private:
  /// The rim outside the outermost extremum, px.
  [[nodiscard]] double outer_rim() const;
  /// Where f falls most steeply within a fifth of R, px, if it falls there from a tenth of its largest value
  /// and clearly more steeply than somewhere between there and inner_px.
  [[nodiscard]] std::optional<double> shoulder(double inner_px) const;
  /// Decrease of |f| from each level to the next, from the level `top` on.
  [[nodiscard]] std::vector<float> falls(std::size_t top) const;
};

/// A level of the profile.
struct ProfileLevel {
  double value;  ///< f, darkness
  double slope;  ///< df/dr, darkness per px
};
/// f and its slope at distance r >= 0, px, from the centre of a disc of radius radius_px, by linear
/// interpolation; {0, 0} beyond the last level. Pure.
inline ProfileLevel level_at(const DiscProfile& f, double r) {
  const double t = r * DiscProfile::kPerPixel;
  const auto k = static_cast<std::size_t>(t);
  if (k + 1 >= f.levels.size()) return {0, 0};
  const double part = t - static_cast<double>(k), a = static_cast<double>(f.levels[k]),
               b = static_cast<double>(f.levels[k + 1]);
  return {a + part * (b - a), (b - a) * DiscProfile::kPerPixel};
}

}  // namespace twincell::imaging
