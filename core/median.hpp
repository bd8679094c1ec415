#pragma once
/// \file
/// Medians of lists of numbers, and a robust spread.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace twincell {

/// Upper median: the element of index n/2 of the sorted values, for even n the larger of the middle two.
/// \param values not empty
template <class T>
T upper_median(std::vector<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Standard deviation of a normal distribution over its median deviation, 1/0.67449.
inline constexpr double kSpreadOverDeviation = 1.4826;

/// Robust spread: 1.4826 median |x - middle|, with the upper median. For a normal distribution about `middle`
/// it estimates the standard deviation, of which the median deviation is 0.67449 = 1/1.4826. Outliers change
/// it little if they are few.
/// \param values without NaN
/// \param middle centre of the distribution: 0 for residuals, otherwise usually the median of the values
/// \returns >= 0, in the unit of the values; 0 if there are none
inline double robust_spread(std::vector<double> values, double middle = 0) {
  if (values.empty()) return 0;
  for (double& x : values) x = std::abs(x - middle);
  return kSpreadOverDeviation * upper_median(std::move(values));
}

/// Upper median of the first n of a few values. Each value is compared with all others, vectorised and
/// without branches; for thirty values this is several times faster than sorting.
/// \param n 1 .. kCapacity; no value may be NaN
template <class T, std::size_t kCapacity>
T upper_median_of_few(std::array<T, kCapacity> values, std::size_t n) {
  constexpr std::size_t kVector = 8;  // the array is padded with infinity to whole vectors
  static_assert(kCapacity % kVector == 0);
  const std::size_t filled = (n + kVector - 1) / kVector * kVector;
  for (std::size_t k = n; k < filled; ++k) values[k] = std::numeric_limits<T>::infinity();
  const auto middle = static_cast<int>(n / 2);
  for (std::size_t at = 0; at < n; ++at) {
    int less = 0, no_more = 0;
    for (std::size_t k = 0; k < filled; ++k) {
      less += values[k] < values[at] ? 1 : 0;
      no_more += values[k] <= values[at] ? 1 : 0;
    }
    if (less <= middle && middle < no_more) return values[at];
  }
  return values[0];
}

}  // namespace twincell
