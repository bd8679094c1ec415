#pragma once
/// \file
/// What a frame says of how to locate its beads: size, polarity, and by which model.
///
/// Hypotheses are the radii at which the gradient votes of either polarity meet most sharply, and the lattice
/// constant of a crystal (lattice_constant.hpp). Of those, the one whose fitted discs explain most of the
/// picture wins: the sum of -R^2 ln(1 - share explained), the logarithm of the likelihood gained; discs most
/// of which overlap explain nothing. Plain discs are tried first; discs with a common radial profile
/// (profile_fit.hpp) take their place if they explain clearly more, and give it back to plain ones of the
/// size that the profile shows if those explain as much. All is done on the part of the frame that has most
/// edges, some hundred discs wide. Where nothing is found so, a frame of a quarter the size is asked for
/// larger discs.

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "imaging/locate/locator.hpp"
#include "imaging/preprocess/preprocess.hpp"
#include "imaging/settings/found_settings.hpp"

namespace twincell {

/// Bead diameter (px) at which the gradient votes of a frame meet most sharply, sought between 6 and 80 px.
/// Good to a few per cent for beads of one size. Returns 0 if nothing round stands out.
double estimate_diameter(const cv::Mat& grey, const PreprocessOptions& options);

/// Large discs (80 px and more, up to two sizes) known by their rims alone, such as photoelastic ones: most
/// of each rim must be seen and the discs must cover a fifth of the frame. The contrast is found too. None if
/// there are none.
std::optional<FoundSettings> find_patterned(const cv::Mat& grey, const LocatorOptions& given);

/// Darkness of a typical disc of a frame, for PreprocessOptions::contrast with the method, size and polarity
/// of the options. 1 for discs with a common profile, and where the picture is fitted for all but those that
/// are so pale that the fit explains a fifth more if it knows.
double find_contrast(const cv::Mat& grey, const LocatorOptions& options);

/// Finds what `given` leaves open: the diameter, the polarity, and, where the refinement is the default one,
/// the model. None if nothing round stands out.
std::optional<FoundSettings> find_settings(const cv::Mat& grey, const LocatorOptions& given);

}  // namespace twincell
