#pragma once
/// \file
/// Proposals by gradient votes at known radius.

#include <string_view>
#include <vector>

#include "imaging/find/finder.hpp"

namespace twincell::imaging {

/// Peaks of the smoothed votes of votes.hpp. A peak nearer than 0.8 d to a better one is dropped. Edges are
/// not thinned: only arcs that face a gap vote, so contacts do no harm. The score is the peak divided by the
/// peak of a full circle of unit contrast. Centres up to one radius outside the frame are also proposed,
/// because their rims are visible.
struct VoteFinder {
  static constexpr std::string_view name = "vote";
  /// The proposals, best first. Pure.
  static std::vector<Proposal> find(const Prepared& image, const FindOptions& options);
};

/// Sum of the squared smoothed votes at a radius, divided by their sum: largest at the radius at which the
/// votes meet.
double vote_sharpness(const cv::Mat1f& darkness, double radius_px);

}  // namespace twincell::imaging
