#pragma once
/// \file
/// Profile model selection: settings for discs with a common profile, used where plain discs explain less of
/// a frame (auto_configuration.hpp).

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "imaging/settings/found_settings.hpp"
#include "imaging/settings/hypothesis_test.hpp"

namespace twincell::imaging {

/// The best of the hypotheses with a common profile, each first extended to the rim that its profile shows;
/// or plain discs of the width that a profile shows, if the votes did not propose that width. Empty if the
/// result agrees with the settings in `plain`.
/// \param tried every size and polarity whose common profile explains something is added
/// \param plain the best of the same hypotheses with plain discs
/// \param lattice the lattice constant, px; 0: none
/// \param threads which do not change the result
std::optional<FoundSettings> select_profile_model(const cv::Mat& frame, const LocatorOptions& given,
                                                  const std::vector<Hypothesis>& all,
                                                  const FoundSettings& plain, double lattice, int threads,
                                                  std::vector<FoundSettings>& tried);

}  // namespace twincell::imaging
