#pragma once
/// \file
/// Beads in one frame: find -> refine -> judge.
///
/// find (vote_locator.hpp, hough_locator.hpp) proposes circle centres; refine (refine.hpp) fits the picture
/// itself; judge (judge.hpp) drops what cannot be an opaque disc. Each is a pure function with its options.
///
/// To add a finder: a class that satisfies CircleFinder in a header of its own, its .cpp, and one word in the
/// list in locators.cpp. Nothing else names it.

#include <concepts>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "imaging/judge.hpp"
#include "imaging/preprocess.hpp"
#include "imaging/refine.hpp"

namespace twincell {

/// What every finder is told.
struct FindOptions {
  double radius_px = 0;  ///< bead radius, > 1.5
  /// Share of a full circle's edge that must point at a centre, 0 .. 1. Inside a hexagonal packing only the
  /// six small voids face a bead, 5 to 10 % of its edge; false proposals are cheap, the fit and the judge
  /// drop them.
  double min_score = 0.04;
};

/// A finder: a type with a name that turns darkness into proposals, best first.
template <class F>
concept CircleFinder = requires(const Prepared& image, const FindOptions& options) {
  { F::name } -> std::convertible_to<std::string_view>;
  { F::find(image, options) } -> std::same_as<std::vector<Proposal>>;
};

/// How beads are located.
struct LocatorOptions {
  std::string finder = "vote";             ///< one of finder_names()
  double diameter_px = 0;                  ///< bead diameter, 3 .. 400; 0: found from the first frame
  std::vector<double> other_diameters_px;  ///< further sizes, each likewise; only with refine.method "edges"
  bool polarity_known = true;  ///< preprocess.bright was said, not to be found from the first frame
  PreprocessOptions preprocess;
  FindOptions find;  ///< its radius is set from the diameter
  RefineOptions refine;
  JudgeOptions judge;
  /// \throws ConfigError naming the option and its bound
  void check() const;
};

/// Time and count of one stage.
struct StageReport {
  std::string stage;      ///< "prepare", "find", "refine", "judge"
  double seconds = 0;     ///< wall time of the calling thread
  std::size_t beads = 0;  ///< proposals or beads after the stage
};

/// One frame located.
struct Located {
  std::vector<Detection> beads;    ///< ordered by y, then x
  std::vector<Detection> dropped;  ///< candidates that are none, each with its verdict
  double blur_px = 0;              ///< standard deviation of the edge found by the fit
  std::vector<StageReport> stages;
};

/// Names that LocatorOptions::finder may take, the default first.
std::vector<std::string> finder_names();

/// What the finder of that name, one of finder_names(), proposes; none by another name. Pure.
std::vector<Proposal> propose(const std::string& finder, const Prepared& image, const FindOptions& options);

/// What each stage made of a frame, as it is held.
struct LocatorStages {
  Prepared image;
  std::vector<Proposal> proposals;
  Refined refined;
  Judged judged;
  std::vector<StageReport> reports;
};
LocatorStages locate_stages(const cv::Mat& grey, const LocatorOptions& options);

/// Locates the beads in one grey frame, turned as orientation.hpp says. Pure; needs diameter_px > 0. \throws
/// ConfigError as `check`
Located locate(const cv::Mat& grey, const LocatorOptions& options);

/// Bead diameter (px) at which the gradient votes of a frame meet most sharply, sought between 6 and 80 px.
/// Good to a few per cent for beads of one size. Returns 0 if nothing round stands out.
double estimate_diameter(const cv::Mat& grey, const PreprocessOptions& options);

/// What a frame says of how to locate its beads.
struct FoundSettings {
  double diameter_px = 0;
  bool bright = false;                     ///< beads are brighter than what lies behind them
  double explained = 0;                    ///< by well explained discs: sum of -R^2 ln(1 - score), px^2
  std::vector<double> other_diameters_px;  ///< of discs of further sizes
  bool patterned = false;  ///< only the rims are alike: RefineOptions::method is to be "edges"
};

/// Large discs (80 px and more, up to two sizes) known by their rims alone, such as photoelastic ones: most
/// of each rim must be seen and the discs must cover a fifth of the frame. The contrast is found too. None if
/// there are none.
std::optional<FoundSettings> find_patterned(const cv::Mat& grey, const LocatorOptions& given);

/// Darkness of a typical disc of a frame, for PreprocessOptions::contrast.
double find_contrast(const cv::Mat& grey, const LocatorOptions& options);

/// Finds what `given` leaves open: the diameter, first from the votes, then as the median of the fitted beads
/// until it stands; the polarity that explains more. None if nothing round stands out.
std::optional<FoundSettings> find_settings(const cv::Mat& grey, const LocatorOptions& given);

}  // namespace twincell
