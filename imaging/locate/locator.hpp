#pragma once
/// \file
/// Beads in one frame: find -> refine -> judge.
///
/// find (vote_finder.hpp, hough_finder.hpp) proposes circle centres; refine (picture_fit.hpp) fits the
/// picture itself; judge (judge.hpp) drops what cannot be an opaque disc. Each is a pure function with its
/// options.

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "imaging/find/finder.hpp"
#include "imaging/preprocess/preprocess.hpp"
#include "imaging/refine/judge.hpp"
#include "imaging/refine/refiner.hpp"

namespace twincell {

/// How beads are located.
struct LocatorOptions {
  std::string finder = "vote";  ///< one of finder_names()
  double diameter_px = 0;       ///< bead diameter, 3 .. 400; 0: found from the first frame
  std::vector<double>
      other_diameters_px;      ///< further sizes, each likewise; not with DiscModel::shared_profile
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

/// What each stage made of a frame, as it is held.
struct LocatorStages {
  Prepared image;
  std::vector<Proposal> proposals;
  Refined refined;
  Judged judged;
  std::vector<StageReport> reports;
};
LocatorStages locate_stages(const cv::Mat& grey, const LocatorOptions& options);

/// Locates the beads in one grey frame, turned as picture_orientation.hpp says. Pure; needs diameter_px > 0.
/// \throws ConfigError as `check`
Located locate(const cv::Mat& grey, const LocatorOptions& options);

}  // namespace twincell
