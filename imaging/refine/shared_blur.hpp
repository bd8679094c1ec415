#pragma once
/// \file
/// Gauss-Newton step of the blur that all discs of a frame share: its variance s^2 and, if the blur clearly
/// depends on direction, the straight path L along which the bed moved during the exposure.
///
/// Discs and blur are solved together, because a blur that followed one sweep behind would take twice as many
/// sweeps: with the discs' blocks and couplings M, their couplings S to the blur's unknowns, and the blur's
/// own block N, the blur's step solves (N - S^T M^-1 S) b = r - S^T M^-1 g, and the discs' steps lose
/// M^-1 S b.

#include <vector>

#include "imaging/refine/frame_model.hpp"
#include "imaging/refine/sparse_gauss_newton.hpp"

namespace twincell::imaging {

/// Normal equations of all discs of a frame and the steps that solve them without the blur.
struct DiscSteps {
  const std::vector<RingSums>& sums;
  const std::vector<Normal>& blocks;
  const std::vector<Coupling>& couplings;
  std::vector<Step>& steps;  ///< corrected for the step of the blur
};

/// Changes the blur of the frame by one bounded step, and the steps of the discs with it. Where `fit` is
/// `uneven`, also decides whether the blur has a direction; a path then starts from the one that corresponds
/// to the measured variance.
/// \returns the change of s^2 relative to s^2, or to 0.7 px^2 if s^2 is larger; 0 if `fit` is `none`
double fit_blur(FrameModel& frame, BlurFit fit, const DiscSteps& discs);

}  // namespace twincell::imaging
