#pragma once
/// \file
/// Distribution of a quantity over its mean in each frame.

#include <span>
#include <string>
#include <vector>

#include "analysis/observable/observable.hpp"
#include "analysis/statistics/statistics.hpp"

namespace twincell::analysis {

/// Probability density of x/<x>, where <x> is the mean over a frame; averaged over the frames.
class RatioDensity {
 public:
  /// \param range largest ratio
  /// \param width of a bin; a divisor of the range
  RatioDensity(double range, double width);

  /// Adds the values of a frame. Ratios below 0 or beyond the range count in the normalisation alone.
  /// \pre values is not empty, mean > 0
  void add(std::span<const double> values, double mean);

  /// NAME_density with _low and _high (array_with_interval.hpp), and NAME_ratio, the centres of the bins.
  /// \param what the quantity x, in words
  /// \param which which values of x count, in words
  /// \param none why the results are absent, if no frame was added
  [[nodiscard]] std::vector<Result> results(const std::string& name, const std::string& what,
                                            const std::string& which, const std::string& source,
                                            const std::string& none) const;

 private:
  double width_;
  std::vector<SeriesAverage> density_;
};

}  // namespace twincell::analysis
