#pragma once
/// \file
/// What is explained of a picture by discs of a size and polarity: what auto_configuration.hpp compares.
///
/// Explained is the sum of -R^2 ln(1 - share explained) over the discs found, the logarithm of the likelihood
/// gained. Discs most of which overlap explain nothing: they are none of that size, though each may explain
/// much with its share of its neighbours.

#include <opencv2/core.hpp>

#include "imaging/locate/locator.hpp"
#include "imaging/refine/profile_fit.hpp"

namespace twincell {

/// Darkness below which discs may be too pale to be taken for some.
inline constexpr double kPale = 0.45;
/// The radii that are sought, px.
inline constexpr double kSmallestRadius = 3, kLargestRadius = 40;

/// What one disc explains, px^2.
double gained(const Detection& b);

/// What the discs may be.
struct Hypothesis {
  bool bright = false;
  double diameter_px = 0;
  double contrast = 1;  ///< PreprocessOptions::contrast
};

/// Plain discs.
struct Trial {
  double explained = 0;
  double diameter_px = 0;  ///< that was settled on
};
/// Plain discs of that size, then of the size that those found have, and so on until it stands; a given one
/// stays.
Trial settle_plain(const cv::Mat& grey, const LocatorOptions& given, const Hypothesis& h);

/// Discs with a common profile.
struct ProfileTrial {
  double explained = 0;
  bool overlaps = false;  ///< and nothing is explained
  DiscProfile profile;
  /// Whether plain discs, however pale, would have that profile.
  [[nodiscard]] bool has_plain_shape() const;
  /// The same of discs dark enough for their fit.
  [[nodiscard]] bool looks_plain() const;
};
ProfileTrial try_profile(const cv::Mat& grey, LocatorOptions options, const Hypothesis& h);

/// The part of a frame, at most `side` px wide and high, whose grey levels change most from pixel to pixel.
cv::Mat busiest(const cv::Mat& grey, int side);

}  // namespace twincell
