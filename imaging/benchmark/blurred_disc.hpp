#pragma once
/// \file
/// A disc seen through Gaussian optics: exact value and exact derivatives.
///
/// P(r; R, s) is the disc of radius R convolved with a Gaussian of standard deviation s, at distance r from
/// the centre. By Gauss's theorem its derivatives are integrals of the Gaussian along the rim,
///     dP/dr = -(R/s^2) exp(-(r^2 + R^2)/2s^2) I1(rR/s^2),
///     dP/dR =  (R/s^2) exp(-(r^2 + R^2)/2s^2) I0(rR/s^2),
/// with the modified Bessel functions I0 and I1, and P(0) = 1 - exp(-R^2/2s^2). The rim is never approximated
/// by a straight edge.

#include <vector>

namespace twincell::imaging::rendered {

/// P and its derivatives, tabulated for one radius R and one blur s. Lengths in px.
class BlurredDisc {
 public:
  /// \param radius R, px, > 0
  /// \param blur s, px, > 0
  BlurredDisc(double radius, double blur);
  /// Half width of the rim, px; beyond it P is 1 or 0 to 1e-12.
  [[nodiscard]] double rim() const { return rim_; }
  /// R, px.
  [[nodiscard]] double radius() const { return radius_; }
  /// P, a share of 1, by cubic Hermite interpolation.
  /// \param r distance from the centre, px, >= 0
  [[nodiscard]] double value(double r) const;
  /// dP/dr, 1/px, by linear interpolation.
  [[nodiscard]] double by_distance(double r) const;
  /// dP/dR, 1/px, by linear interpolation.
  [[nodiscard]] double by_radius(double r) const;

 private:
  double radius_, blur_, rim_, first_;
  std::vector<double> value_, slope_, by_radius_;  // on a grid from first_ with spacing kStep
};

}  // namespace twincell::imaging::rendered
