#pragma once
/// \file
/// Discs that are alike but not plain (clear ones with dark rims, discs with rings printed on them): the
/// radial profile that they share is learnt from the frame, then fitted.
///
/// Model, in darkness d = 1 - I/B:  d(x, y) = g + sum_k a_k f(|(x, y) - c_k| R/R_k), with f linear between
/// levels half a pixel apart and 0 from the outer rim on, g the ground. f is first learnt from the better
/// half of the proposals; where the frame correlates with it over r < R, discs are proposed anew, and f is
/// learnt from those, twice. Then by turns c_k, R_k, a_k are found by Gauss-Newton steps, one disc at a time,
/// all others subtracted, and f and g by linear least squares from all discs that explain themselves,
/// neighbours included. Residuals beyond Huber's bound are weighted down.
///
/// When not to use: plain discs, for which refine.hpp is as good and ten times faster; discs that look
/// different from each other (edge_fit.hpp).

#include <vector>

#include "imaging/refine.hpp"

namespace twincell {

/// What discs of one look share.
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

/// Fits all discs that look alike with the profile that they share; the proposals need be right for most of
/// their better half only, and may miss discs. Detection::score is the share of the variance of the
/// disc's own pixels (r < R + 1) that it explains, Detection::darkness is a. Discs that explain less than
/// half are dropped. Pure. \param sweeps at most, in the last round \param learnt receives the profile, where
/// not null
Refined refine_by_profile(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
                          int sweeps, DiscProfile* learnt = nullptr);

}  // namespace twincell
