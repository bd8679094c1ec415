#pragma once
/// \file
/// Auto-configuration of the locator from one frame: bead size, polarity and disc model.
///
/// The hypotheses are the radii at which the gradient votes of either polarity are sharpest, and the lattice
/// constant of a crystal (lattice_constant.hpp). Plain discs, discs with a common radial profile
/// (profile_fit.hpp), pale discs, discs known by their rims alone (edge_fit.hpp) and discs of several sizes
/// propose settings: those whose fits converge and do not overlap. The proposals are judged by the evidence
/// of the picture (settings_choice.hpp). The search uses the region of the frame with the most edges, some
/// hundred discs wide. If it finds nothing there, it searches the region reduced by a factor of four for
/// larger discs.

#include <opencv2/core.hpp>
#include <optional>

#include "imaging/locate/locator.hpp"
#include "imaging/settings/found_settings.hpp"

namespace twincell::imaging {

/// Tries settings for what `given` leaves open (see above), and chooses by the evidence of the picture
/// (settings_choice.hpp). Empty if no round object stands out.
/// \param threads which do not change the result
SettingsChoice choose_settings(const cv::Mat& grey, const LocatorOptions& given, int threads = 1);

/// Whether another frame confirms a choice: of the chosen settings, the next best and the preferred ones, the
/// chosen ones are chosen on that frame too. Takes a fraction of the time of choose_settings.
///
/// \param threads which do not change the result
bool confirms(const cv::Mat& frame, const SettingsChoice& choice, const LocatorOptions& given,
              int threads = 1);

/// The settings chosen by choose_settings: the diameter, the polarity and, with the default refiner, the
/// disc model. Empty if no round object stands out.
std::optional<FoundSettings> find_settings(const cv::Mat& grey, const LocatorOptions& given);

}  // namespace twincell::imaging
