#pragma once
/// \file
/// Proposals by a gradient vote at known radius.

#include <string_view>
#include <vector>

#include "imaging/find/finder.hpp"

namespace twincell {

/// Peaks of the smoothed votes of votes.hpp; those nearer than 0.8 d to a better one are dropped. No edge
/// thinning: only arcs that face a gap vote, so contacts do no harm. The score is the peak over that of a
/// full circle of unit contrast. Centres up to one radius outside the frame are proposed (their rims are
/// inside).
struct VoteFinder {
  static constexpr std::string_view name = "vote";
  static std::vector<Proposal> find(const Prepared& image, const FindOptions& options);
};

/// Sum of squares of the smoothed votes at a radius, per voting pixel: largest where the votes meet.
double vote_sharpness(const cv::Mat1f& darkness, double radius_px);

}  // namespace twincell
