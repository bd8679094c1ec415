#pragma once
/// \file
/// Plain discs that are not opaque: pale ones, whose gradients are too weak to vote for their size, and ones
/// that are grey in the mean.

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "imaging/locate/locator.hpp"
#include "imaging/settings/found_settings.hpp"
#include "imaging/settings/hypothesis_test.hpp"

namespace twincell::imaging {

/// Pale plain discs.
struct PaleDiscs {
  std::optional<FoundSettings> best;  ///< nothing: there are none
  bool preferred = false;             ///< they explain clearly more than the best settings so far
};

/// Pale plain discs, and whether they are preferred to the best settings so far. With grey discs a dark rim
/// does little harm, so to be preferred to a common profile, they need one with the shape of a plain disc's
/// profile; neighbours that touch change that shape, so that otherwise the evidence decides. None if `given`
/// asks for another model.
///
/// \param sizes to be tried if the picture suggests none of its own contrast
PaleDiscs find_pale(const cv::Mat& grey, const LocatorOptions& given, double lattice,
                    std::vector<Hypothesis> sizes, const std::optional<FoundSettings>& best);

/// Plain discs as dark as the picture shows, if that is grey. Discs with patterns inside, such as small
/// photoelastic ones, are grey in the mean and have no common profile, but their rims do not differ; as
/// opaque discs those with a bright middle would be dropped.
///
/// \param threads which do not change the result
/// \pre model_of(given.refine) is DiscModel::plain
std::vector<FoundSettings> find_grey(const cv::Mat& grey, const LocatorOptions& given, double lattice,
                                     int threads);

}  // namespace twincell::imaging
