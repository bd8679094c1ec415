#pragma once
/// \file
/// Large discs that only their rims have in common, such as photoelastic ones under load.

#include <opencv2/core.hpp>
#include <optional>

#include "imaging/locate/locator.hpp"
#include "imaging/settings/found_settings.hpp"

namespace twincell::imaging {

/// Finds large discs (80 px and more, up to two sizes) by their rims alone, such as photoelastic ones. On
/// average 0.7 of each rim must be visible, and the discs must cover a fifth of the frame. The contrast is
/// found too. Empty if no such discs are found.
std::optional<FoundSettings> find_patterned(const cv::Mat& grey, const LocatorOptions& given);

}  // namespace twincell::imaging
