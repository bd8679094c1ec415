#pragma once
/// \file
/// Location of the beads in one frame: find -> refine -> judge.
///
/// find (vote_finder.hpp, hough_finder.hpp) proposes circle centres; refine (picture_fit.hpp) fits the
/// picture itself; judge (judge.hpp) rejects candidates that cannot be opaque discs. Each stage is a pure
/// function with its own options.

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "imaging/find/finder.hpp"
#include "imaging/preprocess/preprocess.hpp"
#include "imaging/refine/judge.hpp"
#include "imaging/refine/refiner.hpp"

namespace twincell::imaging {

/// Options of the locator.
struct LocatorOptions {
  std::string finder = "vote";  ///< one of finder_names()
  double diameter_px = 0;       ///< bead diameter, 3 .. 400; 0: determined from the first frame
  /// Further diameters, 3 .. 400; not with DiscModel::shared_profile.
  std::vector<double> other_diameters_px;
  /// diameter_px is the scale that the cell states; no size of the beads was stated.
  bool diameter_of_scale = false;
  /// diameter_px was stated or measured: with DiscModel::shared_profile, discs whose common rim is clearly
  /// that of another size (DiscProfile::rim_of_known) have the wrong radius.
  bool size_known = false;
  bool polarity_known = true;  ///< preprocess.bright is given; false: determined from the first frame
  PreprocessOptions preprocess;
  FindOptions find;      ///< its radius is set from the diameters
  RefineOptions refine;  ///< its other radii are set from the diameters
  JudgeOptions judge;
  /// With DiscModel::shared_profile, the radii are those of the rims. false: relative to diameter_px, as the
  /// tests of hypotheses compare them. The fit itself determines profile and radii up to a common stretch.
  bool rim_radii = true;
  /// Of all sizes, that of diameter_px first.
  [[nodiscard]] std::vector<double> radii_px() const;
  /// \throws ConfigError naming the option and its bound
  void check() const;
};

/// Time and number of beads of one stage.
struct StageReport {
  std::string stage;      ///< "prepare", "find", "refine", "judge"
  double seconds = 0;     ///< wall time of the calling thread
  std::size_t beads = 0;  ///< proposals or beads after the stage
};

/// Result of one frame.
struct Located {
  std::vector<Detection> beads;        ///< ordered by y, then x
  std::vector<Detection> dropped;      ///< rejected candidates, each with its verdict
  double blur_px = 0;                  ///< standard deviation of the edge blur, from the fit
  std::array<double, 2> path_px = {};  ///< displacement of the bed in the exposure, x >= 0; 0: not detected
  /// Radius of the rim of the common profile in that of the discs as they were searched; 1 without a profile.
  double rim = 1;
  std::vector<StageReport> stages;
};

/// Intermediate results of all stages.
struct LocatorStages {
  Prepared image;
  std::vector<Proposal> proposals;
  Refined refined;
  Judged judged;
  std::vector<StageReport> reports;
};
/// Runs all stages on a grey frame in the orientation in which it is stored.
/// \throws ConfigError as `check`
LocatorStages locate_stages(const cv::Mat& grey, const LocatorOptions& options);

/// Locates the beads in one grey frame, in its canonical orientation (picture_orientation.hpp). Pure.
/// \pre diameter_px > 0
/// \throws ConfigError as `check`
Located locate(const cv::Mat& grey, const LocatorOptions& options);

/// Beads and walls of one frame.
struct LocatedBetweenWalls {
  Located located;
  cv::Mat1b walls;  ///< Prepared::opaque of the frame as it is stored, for the largest of the bead radii
};
/// As locate(), with the walls. They are computed a second time only if the frame is not stored in its
/// canonical orientation: in another one their rounding differs.
LocatedBetweenWalls locate_between_walls(const cv::Mat& grey, const LocatorOptions& options);

}  // namespace twincell::imaging
