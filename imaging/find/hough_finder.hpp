#pragma once
/// \file
/// Proposals by OpenCV's Hough transform, the baseline.

#include <string_view>
#include <vector>

#include "imaging/find/finder.hpp"

namespace twincell::imaging {

/// cv::HoughCircles (HOUGH_GRADIENT) on the picture enlarged three times, radius +- 10 %, centres at least
/// 0.8 d apart. Its centres are accumulator cells, so a refinement must follow. It misses some beads at
/// contacts (recall 0.996 in a random packing at SNR 51), and beads cut by the frame. The score decreases
/// with the rank.
struct HoughFinder {
  static constexpr std::string_view name = "hough";
  /// The proposals, best first. Pure.
  static std::vector<Proposal> find(const Prepared& image, const FindOptions& options);
};

}  // namespace twincell::imaging
