#pragma once
/// \file
/// The middle of some numbers.

#include <algorithm>
#include <cstddef>
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

}  // namespace twincell
