#pragma once
/// \file
/// Votes of a frame's edges for the centres of discs of one radius: the loops over pixels on which finding
/// spends its time, with vectors as wide as the processor has.

#include <opencv2/core.hpp>

namespace twincell {

/// Standard deviation of the Gaussian by which votes are smoothed, px.
inline constexpr double kVoteSmoothing = 1.5;

/// Each pixel whose gradient g (of darkness per pixel, Sobel's over 5 x 5 pixels) is longer than 0.05 votes
/// with the weight |g| for the pixel nearest to its place + R g/|g|: one radius up the gradient, where a dark
/// disc has its centre. A hundred pixels vote for each disc, so that spreading a vote over four pixels, as
/// was tried, tells no more. \param ignore  not empty: of the same size; its pixels other than 0 do not vote
/// \param smoothing  standard deviation of the Gaussian, px, no more than kVoteSmoothing
/// \param pad     the picture of votes reaches so many pixels beyond the frame on every side, > R + 1
cv::Mat1f smoothed_votes(const cv::Mat1f& darkness, const cv::Mat1b& ignore, double radius_px,
                         double smoothing, int pad);

}  // namespace twincell
