#pragma once
/// \file
/// Light that is smooth but no quadratic: what of it is left in the gaps between the discs, found on coarse
/// tiles.
///
/// The map s minimises  sum_t (s_t - m_t)^2/v_t + (lambda/v) sum [(s_xx)^2 + 2 (s_xy)^2 + (s_yy)^2]  over
/// tiles t, differences from tile to tile, 1/v the mean of 1/v_t (Whittaker's smoother in two dimensions: the
/// bent plate). lambda is that of four decades by which every other tile is best foretold from the rest; so
/// a tile in which no gap is seen follows its neighbours. Source: Eilers, Anal. Chem. 75, 3631 (2003).

#include <opencv2/core.hpp>

namespace twincell {

/// Whether what is left in neighbouring tiles goes together, by more than five standard deviations of what it
/// would by chance. What tiles have each for itself, as noise or a disc that is out of place, does not count.
bool has_ripple(const cv::Mat1d& mean, const cv::Mat1d& variance);

/// The map, nowhere beyond the least and the largest mean. Pure. \param mean of each tile \param variance of
/// that mean by the noise; infinite where a tile tells nothing
cv::Mat1f smooth_ripple(const cv::Mat1d& mean, const cv::Mat1d& variance);

}  // namespace twincell
