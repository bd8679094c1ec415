#pragma once
/// \file
/// Ratio of the means of two series, with its error for correlated values.

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/statistics/statistics.hpp"

namespace twincell::analysis {

/// Ratio R = sum a/sum b of a series of pairs (a, b) of any length, in constant memory. To first order, the
/// scatter of the ratio is that of
///
///     R + (a - R b)/<b>
///
/// (linearised ratio estimator). The interval is that of the SeriesAverage of this series. At most 4096 means
/// of equally many consecutive pairs are stored, as in SeriesAverage.
class RatioAverage {
 public:
  /// Adds the next pair.
  void add(double a, double b);
  [[nodiscard]] std::size_t n() const { return n_; }
  /// R; NaN if there are no pairs or sum b = 0.
  [[nodiscard]] double mean() const;
  /// 95 % interval of R, absent as SeriesAverage::interval.
  [[nodiscard]] std::optional<Interval> interval(const std::string& of_what) const;
  /// Why `interval` is absent; empty if it is present.
  [[nodiscard]] std::string why_no_interval(const std::string& of_what) const;
  /// The series f a + g b, for example a component of a vector (a, b) in other axes. Of a long series the
  /// means of consecutive values.
  [[nodiscard]] SeriesAverage combination(double f, double g) const;
  /// Means of a and of b; NaN if there are no pairs.
  [[nodiscard]] std::pair<double, double> means() const;

 private:
  [[nodiscard]] SeriesAverage linearised() const;

  std::vector<std::pair<double, double>> coarse_;  ///< sums over coarse_length_ consecutive pairs
  std::size_t coarse_length_ = 1;
  std::pair<double, double> open_ = {0, 0};
  std::size_t open_count_ = 0;
  std::size_t n_ = 0;
  double a_ = 0, b_ = 0;  ///< sums of all pairs
};

}  // namespace twincell::analysis
