#pragma once
/// \file
/// Residual illumination: smooth variations of the light that a quadratic surface does not describe, measured
/// on coarse tiles in the gaps between the discs.
///
/// The map s minimises  sum_t (s_t - m_t)^2/v_t + (lambda/v) sum [(s_xx)^2 + 2 (s_xy)^2 + (s_yy)^2]  over
/// tiles t, with differences from tile to tile and 1/v the mean of 1/v_t (Whittaker smoother in two
/// dimensions: a bent plate). lambda is the one of four decades that best predicts every other tile from the
/// remaining ones. A tile in which no gap is visible follows its neighbours. Source: Eilers, Anal. Chem. 75,
/// 3631 (2003).

#include <opencv2/core.hpp>

namespace twincell::imaging {

/// Whether the residuals of neighbouring tiles are correlated, by more than five standard deviations of the
/// correlation by chance. Independent residuals, as from noise or from a misplaced disc, do not count.
bool has_ripple(const cv::Mat1d& mean, const cv::Mat1d& variance);

/// The map s, limited to the range of the means. Pure.
/// \param mean      mean residual m_t of each tile
/// \param variance  variance v_t of this mean due to noise; infinite for a tile without information
cv::Mat1f smooth_ripple(const cv::Mat1d& mean, const cv::Mat1d& variance);

}  // namespace twincell::imaging
