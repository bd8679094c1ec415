#pragma once
/// \file
/// Polydisperse settings: whether the plain discs of a frame have several sizes.

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "imaging/settings/found_settings.hpp"
#include "imaging/settings/hypothesis_test.hpp"

namespace twincell::imaging {

/// Whether discs of another diameter may be in one frame with discs of these: the ratio to each is between
/// 1.12 and 2.5.
bool sizes_apart(const std::vector<double>& diameters, double other);

/// Finds up to three sizes of plain discs in a region of the frame. The search starts from the known size (of
/// plain discs or of discs with a common profile). It adds a size as long as the enlarged set explains 2 %
/// more of the picture, its discs are well explained, and at least 2 % of them have the rarest size. The
/// candidates are the sizes at which the votes are sharp (`all`), the size of discs rejected for a wrong
/// radius and, if the number of rejected candidates exceeds 2 % of the number of beads, fixed ratios from 0.5
/// to 2. Empty if one size suffices.
std::optional<FoundSettings> find_polydisperse(const cv::Mat& grey, const LocatorOptions& given,
                                               const std::vector<Hypothesis>& all, const FoundSettings& one);

}  // namespace twincell::imaging
