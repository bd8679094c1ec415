#pragma once
/// \file
/// Correlation of the residuals of a fit from pixel to pixel, seen at the rims of the discs.
///
/// The uncertainties of a least-squares fit assume independent errors of the pixels. Texture of the
/// background, glare, shadows and unsharp dirt leave residuals that are alike over several pixels, and these
/// move a centre farther than as large independent ones do. The harmonics of the rim show by how much. An
/// error of the centre has the angular dependence cos phi and sin phi; the fit has absorbed that part of the
/// residuals. It leaves their parts in cos 2 phi, sin 2 phi, cos 3 phi and sin 3 phi, which are as large if
/// the residuals are correlated over less than a disc, and smaller if they are correlated over more.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "imaging/disc/ring_normal_equations.hpp"

namespace twincell::imaging {

/// The harmonics of the residuals r at the rim of one disc, weighted by the slope P' of its edge and by
/// w = 1/v, v the variance of the noise:  S_m = sum w P' r cos m phi,  E_m = sum w (P' cos m phi)^2,  and the
/// same of sin m phi. For residuals that are independent, S_m^2/E_m is their mean square over v.
class RimHarmonics {
 public:
  static constexpr std::size_t kOrders = 2;           ///< m = 2, 3
  static constexpr std::size_t kWaves = 2 * kOrders;  ///< cos and sin of each

  /// Adds a pixel.
  /// \param c, s cos phi and sin phi of its direction from the centre
  void add(double c, double s, double slope, double weight, double residual) {
    const double c2 = c * c - s * s, s2 = 2 * c * s;
    const std::array<double, kWaves> waves = {c2, s2, c * c2 - s * s2, s * c2 + c * s2};
    for (std::size_t m = 0; m < kWaves; ++m) {
      sums[m] += weight * slope * residual * waves[m];
      expected[m] += weight * slope * slope * waves[m] * waves[m];
    }
  }

  std::array<double, kWaves> sums{}, expected{};  ///< S, E
  double excess = 1;                              ///< mean of w r^2 over the pixels of the fit, at least 1
};

/// Harmonics of the discs whose ring lies in the frame and hides no pixel; of every n-th disc, so that there
/// are at most 256.
/// \param args     with the model of the picture, which contains the discs
/// \param excesses of each disc
std::vector<RimHarmonics> rim_harmonics(const RingArgs& args, std::span<const Disc> discs,
                                        std::span<const double> excesses);

/// Variance of a centre, divided by the variance that independent residuals of the same size would give:
///     rho = (p_2 + p_3)/2, or p_2 q with q = p_2/p_3, at most 4, where p_2 is clearly larger than p_3,
///     p_m = mean over the discs of (S_c^2/E_c + S_s^2/E_s)/2 / excess, without the largest twentieth.
/// p_1, which the fit has absorbed, is estimated by the geometric continuation of p_3 and p_2. The part of
/// the harmonics that all discs have in common (motion, stretched pixels) is subtracted. The variance of a
/// radius is not known from them: size and blur absorb the harmonic m = 0.
/// \returns rho; 1 if rho or, in units of the noise, the third harmonic exceeds 1 by less than three standard
///     errors, or for fewer than 12 discs. Pure.
double residual_correlation(const std::vector<RimHarmonics>& rims);

}  // namespace twincell::imaging
