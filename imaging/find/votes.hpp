#pragma once
/// \file
/// Votes of a frame's edges for the centres of discs of one radius: the loops over pixels on which finding
/// spends its time, with vectors as wide as the processor has.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

namespace twincell {

/// Standard deviation of the Gaussian by which votes are smoothed, px.
inline constexpr double kVoteSmoothing = 1.5;

/// Who votes for what.
struct VoteOptions {
  double radius_px;                   ///< R
  double smoothing = kVoteSmoothing;  ///< standard deviation of the Gaussian, px, no more than kVoteSmoothing
  int pad = 0;  ///< the picture of votes reaches so far beyond the frame on every side, px, > R + 1
};

/// Three successive rows of a picture of votes. A vector may reach 16 floats past their ends.
using VoteLines = std::array<const float*, 3>;

/// Each pixel whose gradient g (of darkness per pixel, Sobel's over 5 x 5 pixels) is longer than 0.05 votes
/// with the weight |g| for the pixel nearest to its place + R g/|g|: one radius up the gradient, where a dark
/// disc has its centre. A hundred pixels vote for each disc, so that spreading a vote over four pixels, as
/// was tried, tells no more. The picture of votes is not kept: it would not fit into the cache.
/// \param ignore  not empty: of the same size; its pixels other than 0 do not vote
/// \param use     called with the number of each row of the smoothed picture of votes, from 0 (`pad` above
/// the frame's
///                first), and with the two rows before it and itself
void over_smoothed_votes(const cv::Mat1f& darkness, const cv::Mat1b& ignore, const VoteOptions& options,
                         const std::function<void(int, const VoteLines&)>& use);

/// The columns in which the middle one of three rows of `n` votes, the first and the last column aside, has
/// at least so many and more than the eight around; of equal ones the first that is read, row by row. \param
/// room  where they are put
std::span<const std::int32_t> tops_of_votes(const VoteLines& lines, std::size_t n, float least,
                                            std::vector<std::int32_t>& room);

}  // namespace twincell
