#pragma once
/// \file
/// Sub-pixel centres by fitting the picture itself.
///
/// Model, in darkness d = 1 - I/B:  d(x, y) = sum_k a_k P(|(x, y) - c_k| - R_k) + l,  with the blurred edge
/// P(u) = 1/2 erfc((u + s^2/2R)/(sqrt 2 s)); the term s^2/2R is what blur does to the half level of a curved
/// edge. Opaque discs do not overlap, so the sum is exact. Per bead c, R, a and the local light l are fitted
/// on the ring |r - R| <= ring_px alone (glare and tracers inside do no harm), with the neighbours' discs
/// subtracted, in Gauss-Seidel sweeps; the blur s is shared by the frame and follows after each sweep.
/// Residuals are weighted after Huber. Bound (Cramer-Rao, 15 px disc, blur 0.8 px): 0.36/SNR px per
/// coordinate.
///
/// When not to use: translucent discs with bright cores, or discs that overlap in projection.

#include <opencv2/core.hpp>
#include <vector>

#include "imaging/preprocess.hpp"

namespace twincell {

/// A proposed centre.
struct Proposal {
  double x = 0;      ///< px
  double y = 0;      ///< px
  double score = 0;  ///< 0 .. about 1
};

/// A bead in a frame. Lengths in pixels.
struct Detection {
  double x = 0, y = 0;              ///< centre
  double radius = 0;                ///< R
  double darkness = 0;              ///< a: 1 for an opaque disc, less for a translucent or bright one
  double light = 0;                 ///< l: local darkness beside the disc, near 0
  double sigma_x = 0, sigma_y = 0;  ///< one standard deviation of x and y, from the normal matrix of the fit
  double sigma_radius = 0;          ///< likewise of R
  double residual = 0;              ///< rms of the fit on the ring, darkness
  double ring_share = 0;            ///< share of the ring that was free to be fitted, 0 .. 1
  double interior = 0;              ///< median darkness inside R/2
  double score = 0;                 ///< share of the ring's variance that the disc explains, 0 .. 1
  double mass = 0;                  ///< darkness summed over the disc, neighbours taken out
  double raw_mass = 0;              ///< light taken away by the disc, grey levels: sum of d B
  double signal = 0;                ///< largest darkness in the disc
  double size = 0;                  ///< radius of gyration of the darkness
  double ecc = 0;                   ///< eccentricity of the darkness from its second moments, 0: round
  bool edge = false;                ///< cut by the frame
  bool tracer = false;              ///< interior clearly brighter than that of the other beads
};

/// How the fit is done.
struct RefineOptions {
  int sweeps = 30;              ///< at most, 1 .. 1000
  double tolerance_px = 2e-3;   ///< a sweep that moves no bead further is the last, > 0
  double ring_px = 3;           ///< half width of the ring, > 1
  double blur_px = 0;           ///< edge blur s; 0: fitted
  double radius_spread = 0.06;  ///< prior: relative scatter of the radii about the given one, > 0
};

/// Result of a refinement.
struct Refined {
  std::vector<Detection> beads;  ///< in the order of the proposals
  double blur_px = 0;
  int sweeps = 0;
};

/// Fits all proposals of a frame together; looks once for discs that were missed, on the residual picture.
/// Pure.
Refined refine(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
               const RefineOptions& options);

}  // namespace twincell
