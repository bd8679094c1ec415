#pragma once
/// \file
/// Beads in one frame: find -> refine -> judge.
///
/// find (vote_locator.hpp, hough_locator.hpp) proposes circle centres; refine (refine.hpp) fits the picture
/// itself; judge (judge.hpp) drops what cannot be an opaque disc. Each is a pure function with its options.
///
/// To add a finder: a class that satisfies CircleFinder in a header of its own, its .cpp, and one word in the
/// list in locators.cpp. Nothing else names it.

#include <array>
#include <concepts>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "imaging/judge.hpp"
#include "imaging/preprocess.hpp"
#include "imaging/profile_fit.hpp"
#include "imaging/refine.hpp"

namespace twincell {

/// What every finder is told.
struct FindOptions {
  double radius_px = 0;  ///< bead radius, > 1.5
  /// Share of a full circle's edge that must point at a centre, 0 .. 1. Inside a hexagonal packing only the
  /// six small voids face a bead, 5 to 10 % of its edge; false proposals are cheap, the fit and the judge
  /// drop them.
  double min_score = 0.04;
  double apart = 0.8;  ///< no two proposals are nearer to each other, diameters
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
  std::vector<double> other_diameters_px;  ///< further sizes, each likewise; not with refine.method "profile"
  bool polarity_known = true;  ///< preprocess.bright was said, not to be found from the first frame
  PreprocessOptions preprocess;
  FindOptions find;      ///< its radius is set from the diameter
  RefineOptions refine;  ///< its other radii likewise
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
  std::vector<Detection> beads;        ///< ordered by y, then x
  std::vector<Detection> dropped;      ///< candidates that are none, each with its verdict
  double blur_px = 0;                  ///< standard deviation of the edge found by the fit
  std::array<double, 2> path_px = {};  ///< by which the bed moved during the exposure, x >= 0; 0: not seen to
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
  DiscProfile profile;  ///< with refine.method "profile"
  std::vector<StageReport> reports;
};
LocatorStages locate_stages(const cv::Mat& grey, const LocatorOptions& options);

/// Locates the beads in one grey frame, turned as orientation.hpp says. Pure; needs diameter_px > 0. \throws
/// ConfigError as `check`
Located locate(const cv::Mat& grey, const LocatorOptions& options);

}  // namespace twincell
