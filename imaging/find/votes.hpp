#pragma once
/// \file
/// Votes of a frame's edges for the centres of discs of one radius: the SIMD loops over pixels that take most
/// of the time of finding.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

namespace twincell::imaging {

/// Standard deviation of the Gaussian that smooths the votes, px.
inline constexpr double kVoteSmoothing = 1.5;

/// Options of the votes.
struct VoteOptions {
  double radius_px;                   ///< R
  double smoothing = kVoteSmoothing;  ///< standard deviation of the Gaussian, px, at most kVoteSmoothing
  int pad = 0;  ///< margin of the vote picture beyond the frame on every side, px, > R + 1
};

/// Three successive rows of a vote picture. A vector may extend 16 floats past their ends.
using VoteLines = std::array<const float*, 3>;

/// Computes the smoothed votes row by row. Each pixel with a gradient g (of darkness per pixel, Sobel
/// operator over 5 x 5 pixels) longer than 0.05 votes with the weight |g| for the pixel nearest to its
/// position + R g/|g|: one radius up the gradient, where a dark disc has its centre. About a hundred pixels
/// vote for each disc, so spreading a vote over four pixels was tried and gives no gain. The vote picture is
/// not stored, because it would not fit into the cache.
/// \param ignore  empty, or of the same size; its nonzero pixels do not vote
/// \param use     called with the index of each row of the smoothed vote picture, from 0 (`pad` rows above
///   the first row of the frame), and with the two rows before it and the row itself
void over_smoothed_votes(const cv::Mat1f& darkness, const cv::Mat1b& ignore, const VoteOptions& options,
                         const std::function<void(int, const VoteLines&)>& use);

/// Local maxima in the middle of three rows of `n` votes: the columns, except the first and the last, with at
/// least `least` votes and more than the eight neighbours. Of equal neighbours the first one read, row by
/// row, counts.
/// \param room  storage of the result
std::span<const std::int32_t> tops_of_votes(const VoteLines& lines, std::size_t n, float least,
                                            std::vector<std::int32_t>& room);

}  // namespace twincell::imaging
