#pragma once
/// \file
/// Quantiles of lists of numbers, without interpolation: each is one of the values. There are two rules,
/// which differ as the lower and the upper median do.

#include <algorithm>
#include <cstddef>
#include <vector>

namespace twincell {

/// Lower quantile: the element of index floor(share (n - 1)) of the sorted values. Shares 0 and 1 give the
/// smallest and the largest value, 0.5 the lower median.
/// \param values not empty
/// \param share 0 to 1
template <class T>
T lower_quantile(std::vector<T> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Upper quantile: the element of index floor(share n) of the sorted values. Share 0.5 gives the upper median
/// (median.hpp).
/// \param values not empty
/// \param share 0 to below 1
template <class T>
T upper_quantile(std::vector<T> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace twincell
