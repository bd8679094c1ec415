#include "trajectory/record_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace twincell {

namespace {

/// Runs of values that are exactly `extreme`, with sharp steps on both sides, and the number of their values.
struct Runs {
  std::size_t runs = 0, values = 0;
};

Runs runs_at(double extreme, const std::vector<double>& values, double resolution) {
  constexpr std::size_t kMinClippedSamples = 3;
  Runs found;
  for (std::size_t begin = 0; begin < values.size();) {
    std::size_t end = begin;
    while (end < values.size() && values[end] == extreme) ++end;
    const std::size_t length = end - begin;
    if (length >= kMinClippedSamples) {
      // Of a parabola whose `length` middle values are within the resolution, the value two further out is
      // within this, and half of the resolution is for its rounding. The value next to a run may lie just
      // below the bound of the instrument. A run at an end of the record has one side.
      const double n = static_cast<double>(length),
                   sharp = (std::pow((n + 3) / (n - 1), 2) + 1.5) * resolution;
      const bool before = begin < 2 || std::abs(values[begin - 2] - extreme) > sharp,
                 after = end + 1 >= values.size() || std::abs(values[end + 1] - extreme) > sharp;
      if (before && after) ++found.runs, found.values += length;
    }
    begin = std::max(end, begin + 1);
  }
  return found;
}

}  // namespace

std::string doubt_of_clipping(const std::vector<double>& values) {
  constexpr std::size_t kMinRuns = 2;
  if (values.empty()) return {};
  std::vector<double> sorted = values;
  std::ranges::sort(sorted);
  const double low = sorted.front(), high = sorted.back();
  double resolution = high - low;
  for (std::size_t i = 1; i < sorted.size(); ++i)
    if (const double step = sorted[i] - sorted[i - 1]; step > 0) resolution = std::min(resolution, step);
  if (!(resolution > 0)) return {};
  const Runs at_low = runs_at(low, values, resolution), at_high = runs_at(high, values, resolution);
  if (at_low.runs + at_high.runs < kMinRuns) return {};
  return fmt::format(
      "{:.2g} % of the values are exactly the largest or the smallest, in {} flat parts with sharp ends: was "
      "the range of the instrument exceeded?",
      100 * static_cast<double>(at_low.values + at_high.values) / static_cast<double>(values.size()),
      at_low.runs + at_high.runs);
}

std::string doubt_of_unit(const std::vector<double>& values) {
  constexpr double kTolerance = 0.03;
  if (values.empty()) return {};
  const double mean =
      std::abs(std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size()));
  const auto is = [&](double g) { return std::abs(mean / g - 1) < kTolerance; };
  if (is(kStandardGravity))
    return fmt::format("their mean is {:.4g} g, where gravity gives 1 g: are they in m/s^2?", mean);
  if (is(1 / kStandardGravity))
    return fmt::format("their mean is {:.4g} m/s^2, where gravity gives 9.8 m/s^2: are they in g?",
                       mean * kStandardGravity);
  return {};
}

}  // namespace twincell
