#pragma once
/// \file
/// Settings by discs that look alike, where those for plain discs explain less of a frame
/// (auto_configuration.hpp).

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "imaging/settings/found_settings.hpp"
#include "imaging/settings/hypothesis_test.hpp"

namespace twincell {

/// The best of the hypotheses by a common profile, each led out to the rim that its profile shows; or plain
/// discs as wide as a profile shows them, which the votes did not propose. None if that is by what plain
/// discs were found. \param plain    the best of the same hypotheses by plain discs \param lattice  the
/// lattice constant, px; 0: none
std::optional<FoundSettings> select_profile_model(const cv::Mat& frame, const LocatorOptions& given,
                                                  const std::vector<Hypothesis>& all,
                                                  const FoundSettings& plain, double lattice);

}  // namespace twincell
