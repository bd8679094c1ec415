#pragma once
/// \file
/// Whether plain discs of a frame are of several sizes.

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "imaging/settings/found_settings.hpp"
#include "imaging/settings/hypothesis_test.hpp"

namespace twincell {

/// Sizes that stand beside each other, up to three, on a part of the frame: to the one known, of plain discs
/// or discs with a common profile, further ones are added while one explains a fiftieth more of the picture,
/// by discs that are well explained and of which a fiftieth at least have the rarest size. Candidates are the
/// sizes at which votes meet (`all`), that of discs left out as of wrong radius, and, where more than a
/// fiftieth of the candidates was left out, fixed ratios from 0.5 to 2. None if one size does.
std::optional<FoundSettings> find_polydisperse(const cv::Mat& grey, const LocatorOptions& given,
                                               const std::vector<Hypothesis>& all, const FoundSettings& one);

}  // namespace twincell
