#pragma once
/// \file
/// Hypothesis test: how much of a picture discs of a given size and polarity explain. auto_configuration.hpp
/// compares these values.
///
/// The measure is the sum of -R^2 ln(1 - share explained) over the discs found, the gain in log-likelihood.
/// It is 0 if most discs overlap: the size is then wrong, although each disc may explain much together with
/// its share of its neighbours.

#include <opencv2/core.hpp>

#include "imaging/locate/locator.hpp"
#include "imaging/refine/disc_profile.hpp"

namespace twincell::imaging {

/// Darkness below which discs may be too pale to be recognised.
inline constexpr double kPale = 0.45;
/// Darkness from which discs are opaque. Discs below it may be grey only in the mean, with patterns inside.
inline constexpr double kOpaque = 0.7;
/// Factor by which pale discs must explain more than others.
inline constexpr double kPaleClearly = 1.2;
/// Largest side of the region of a frame that is examined, px.
inline constexpr int kExaminedSide = 600;
/// Smallest score of a disc whose size counts.
inline constexpr double kGoodScore = 0.8;
/// The range of radii that is searched, px.
inline constexpr double kSmallestRadius = 3, kLargestRadius = 40;

/// Contribution of one disc to the measure: -R^2 ln(1 - score), px^2.
double gained(const Detection& b);

/// A hypothesis about the discs of a frame.
struct Hypothesis {
  bool bright = false;
  double diameter_px = 0;
  double contrast = 1;  ///< PreprocessOptions::contrast
};

/// Result of a trial with plain discs.
struct Trial {
  double explained = 0;    ///< the measure above, px^2
  double diameter_px = 0;  ///< after convergence
};
/// Fits plain discs of the hypothesis's size, then of the median size found, and so on until the size
/// converges. A diameter in `given` is kept.
Trial settle_plain(const cv::Mat& grey, const LocatorOptions& given, const Hypothesis& h);

/// Result of a trial with discs that have a common profile.
struct ProfileTrial {
  double explained = 0;
  bool overlaps = false;  ///< most discs overlap; `explained` is then 0
  DiscProfile profile;
  /// Whether the profile is that of plain discs, however pale.
  [[nodiscard]] bool has_plain_shape() const;
  /// Whether, in addition, the discs are dark enough for the plain-disc fit.
  [[nodiscard]] bool looks_plain() const;
};
/// Fits discs with a common profile, of the size of the hypothesis.
/// \param options of the locator; their diameter and polarity are those of the hypothesis
ProfileTrial try_profile(const cv::Mat& grey, LocatorOptions options, const Hypothesis& h);

/// The region of a frame, at most `side` px wide and high, whose grey levels change most from pixel to pixel.
cv::Mat busiest(const cv::Mat& grey, int side);

}  // namespace twincell::imaging
