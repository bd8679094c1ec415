#pragma once
/// \file
/// Grey levels at the rims of discs, by direction and distance from the centre.

#include <Eigen/Core>
#include <algorithm>
#include <opencv2/core.hpp>
#include <vector>

#include "imaging/disc/detection.hpp"

namespace twincell::imaging {

inline constexpr int kRimDirections = 24;
inline constexpr int kRimSteps = 13;  ///< samples along the radius

/// Half width of the band of samples about the rim, px: 0.35 R, at least 2 px.
inline double rim_width_px(double radius_px) {
  constexpr double kWidthOfRadius = 0.35, kMinWidth_px = 2;
  return std::max(kWidthOfRadius * radius_px, kMinWidth_px);
}

/// The rim of a disc in the directions in which it is seen.
struct RimSamples {
  std::vector<double> turns;  ///< directions, rad, from x to y of the picture
  /// [turns][steps] grey levels from rim_width_px inside the rim to as much outside
  Eigen::Matrix<double, Eigen::Dynamic, kRimSteps> levels;
};

/// Samples the rims of discs in kRimDirections directions; each is the mean over three of a third of the
/// angle. Directions in which another disc or the border of the picture is nearer than 1.5 px, or that reach
/// a wall, are left out.
/// \param others discs that are not sampled, but may be nearer to a rim
/// \param walls  not 0 at pixels of walls; empty: none
/// \returns a rim for each disc, of at least a third of the directions, or empty. Pure
std::vector<RimSamples> rim_samples(const cv::Mat1f& grey, const std::vector<Detection>& discs,
                                    const std::vector<Detection>& others = {}, const cv::Mat1b& walls = {});

}  // namespace twincell::imaging
