#pragma once
/// \file
/// Found centres against the truth.

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "imaging/benchmark/picture.hpp"

namespace twincell::rendered {

/// Gathers the frames of one case, noise level and method.
class Marks {
 public:
  /// Pairs finds with discs, nearest pair first, within a radius; a disc whose centre lies outside the frame
  /// does not count, nor does a find that answers to it. \param bound per disc, px
  void add(const Picture& picture, const std::vector<cv::Point2d>& found, const std::vector<double>& bound);

  /// What a reader wants to know; lengths in px.
  struct Summary {
    std::size_t beads = 0, found = 0, invented = 0;
    double recall = 0, precision = 0;
    double rms = 0;    ///< per coordinate, sqrt(mean(dx^2 + dy^2)/2)
    double bound = 0;  ///< rms of the bounds of the beads that count
    double bias_x = 0, bias_y = 0;
    double largest = 0;  ///< largest distance from the truth
    /// Pixel locking: amplitude of the error's first harmonic in the true sub-pixel place,
    /// sqrt(a^2 + b^2) with a + i b = (2/n) sum e exp(-2 pi i x), both coordinates together. Without locking
    /// its mean is rms sqrt(pi/n) for n coordinates.
    double locking = 0;
    std::vector<double> error_by_phase;  ///< mean error in tenths of a pixel of the true place
    std::vector<int> found_by_phase;     ///< how many finds have their place in each tenth
    std::vector<int> truth_by_phase;     ///< how many truths
  };
  [[nodiscard]] Summary summary() const;

 private:
  struct Error {
    double at_x, at_y, dx, dy;
  };
  std::vector<Error> errors_;
  std::size_t beads_ = 0, invented_ = 0;
  double bounds_ = 0;  // sum of squares
};

}  // namespace twincell::rendered
