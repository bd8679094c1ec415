#pragma once
/// \file
/// Auto-configuration of the locator from one frame: bead size, polarity and disc model.
///
/// The hypotheses are the radii at which the gradient votes of either polarity are sharpest, and the lattice
/// constant of a crystal (lattice_constant.hpp). The hypothesis whose fitted discs explain most of the
/// picture wins. The measure is the sum of -R^2 ln(1 - share explained), the gain in log-likelihood; it is 0
/// if most of the discs overlap. Plain discs are tried first. Discs with a common radial profile
/// (profile_fit.hpp) replace them if they explain clearly more. Plain discs of the size that the profile
/// shows are used again if they explain as much. The search uses the region of the frame with the most edges,
/// some hundred discs wide. If it finds nothing there, it searches the region reduced by a factor of four for
/// larger discs.

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "imaging/locate/locator.hpp"
#include "imaging/preprocess/preprocess.hpp"
#include "imaging/settings/found_settings.hpp"

namespace twincell {

/// Bead diameter (px) at which the gradient votes of a frame are sharpest, searched from 6 to 80 px. Accurate
/// to a few per cent for beads of one size. Returns 0 if no round object stands out.
double estimate_diameter(const cv::Mat& grey, const PreprocessOptions& options);

/// Finds large discs (80 px and more, up to two sizes) by their rims alone, such as photoelastic ones. On
/// average 0.7 of each rim must be visible, and the discs must cover a fifth of the frame. The contrast is
/// found too. Empty if no such discs are found.
std::optional<FoundSettings> find_patterned(const cv::Mat& grey, const LocatorOptions& given);

/// Darkness of a typical disc of a frame, for PreprocessOptions::contrast with the method, size and polarity
/// of the options. 1 for discs with a common profile. For the picture fit it is also 1, unless the discs are
/// so pale that the fit explains a fifth more with the measured contrast.
double find_contrast(const cv::Mat& grey, const LocatorOptions& options);

/// Finds the settings that `given` leaves open: the diameter, the polarity and, with the default refiner, the
/// disc model. Empty if no round object stands out.
std::optional<FoundSettings> find_settings(const cv::Mat& grey, const LocatorOptions& given);

}  // namespace twincell
