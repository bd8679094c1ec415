#pragma once
/// \file
/// The radial profile of darkness of a disc.

#include <vector>

namespace twincell {

/// The radial profile that discs of one look share.
struct DiscProfile {
  static constexpr double kPerPixel = 2;
  double radius_px = 0;       ///< R that it was learnt for; 0: none was
  double ground = 0;          ///< g, darkness between the discs
  std::vector<float> levels;  ///< f at r = k/kPerPixel; 0 behind the last
  /// f at a distance from the centre of a disc of radius R.
  [[nodiscard]] double at(double r) const;
  /// Radius at which f falls most steeply outward of its first extreme, from outside, that is a fifth as
  /// large as its largest: the outer rim, px.
  [[nodiscard]] double rim() const;
  /// The largest |f|.
  [[nodiscard]] double largest() const;
  /// Share of the sum of f^2 over the disc's area that a plain disc with this rim, of the blur that does
  /// best, leaves unexplained: below 0.01 for opaque discs, of which a small bright spot on each makes no
  /// others.
  [[nodiscard]] double unlike_plain() const;
};

/// f and its slope at a distance, R = that of the profile.
struct ProfileLevel {
  double value, slope;
};
ProfileLevel level_at(const DiscProfile& f, double r);

}  // namespace twincell
