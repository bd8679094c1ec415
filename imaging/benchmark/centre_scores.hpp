#pragma once
/// \file
/// Scores of detected centres against the known truth.

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "imaging/benchmark/picture.hpp"

namespace twincell::imaging::rendered {

/// Accumulates the errors of the centres in all frames of one case, noise level and method.
class CentreScores {
 public:
  /// Matches detections to discs, nearest pair first, within one disc radius. A disc with its centre outside
  /// the frame is not scored, nor is a detection that matches it.
  /// \param bound Cramér–Rao bound of each disc, px
  void add(const Picture& picture, const std::vector<cv::Point2d>& found, const std::vector<double>& bound);

  /// Summary of all frames added. Lengths in px. `beads` counts the scored discs, `found` the detections that
  /// match them, `invented` the detections that match no disc.
  struct Summary {
    std::size_t beads = 0, found = 0, invented = 0;
    double recall = 0, precision = 0;
    double rms = 0;    ///< per coordinate, sqrt(mean(dx^2 + dy^2)/2)
    double bound = 0;  ///< rms of the bounds of the scored discs
    double bias_x = 0, bias_y = 0;
    double largest = 0;  ///< largest distance from the truth
    /// Pixel locking: amplitude of the first harmonic of the error as a function of the true sub-pixel
    /// position, sqrt(a^2 + b^2) with a + i b = (2/n) sum e exp(-2 pi i x), over both coordinates. Without
    /// locking its mean is rms sqrt(pi/n) for n coordinates.
    double locking = 0;
    std::vector<double> error_by_phase;  ///< mean error in each tenth of a pixel of the true position
    std::vector<int> found_by_phase;     ///< number of detections positioned in each tenth
    std::vector<int> truth_by_phase;     ///< number of true positions in each tenth
  };
  /// The summary of all frames so far; lengths in px.
  [[nodiscard]] Summary summary() const;

 private:
  struct Error {
    double at_x, at_y, dx, dy;
  };
  std::vector<Error> errors_;
  std::size_t beads_ = 0, invented_ = 0;
  double bounds_ = 0;  // sum of the squared bounds
};

}  // namespace twincell::imaging::rendered
