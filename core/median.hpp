#pragma once
/// \file
/// The middle of some numbers.

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

namespace twincell {

/// The number at place n/2 of the sorted ones; of an even number the upper of the two in the middle.
/// \param values not empty
template <class T>
T upper_median(std::vector<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Likewise of the first n of few numbers: each is compared with all, in vectors and without branches, which
/// for thirty is several times as fast as to sort them. \param n  1 .. kMost; none of them NaN
template <class T, std::size_t kMost>
T upper_median_of_few(std::array<T, kMost> values, std::size_t n) {
  constexpr std::size_t kVector = 8;  // whole vectors, filled up with what is larger
  static_assert(kMost % kVector == 0);
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
