#pragma once
/// \file
/// Arrays whose elements have intervals.

#include <cmath>
#include <string>
#include <vector>

#include "analysis/observable/observable.hpp"
#include "core/constants.hpp"

namespace twincell::analysis {

/// Three results with one element per series: `r` with the means, and NAME_low and NAME_high with the ends of
/// their 95 % intervals. An element of these is NaN where the series has no interval. All three are absent
/// with the reason `why_absent` if no series has a value; the last two are absent if no series has an
/// interval. `samples` is the kind of the values of the series, `r.n_of` that of the elements.
/// \tparam Average SeriesAverage or RatioAverage
template <class Average>
std::vector<Result> array_with_interval(const std::vector<Average>& series, const Result& r,
                                        const std::string& samples, const std::string& why_absent) {
  std::vector<double> mean, low, high;
  std::string method, why_none = why_absent;
  for (const Average& one : series) {
    mean.push_back(one.n() > 0 ? one.mean() : kNaN);
    const auto interval = one.n() > 0 ? one.interval(samples) : std::nullopt;
    low.push_back(interval ? interval->low : kNaN);
    high.push_back(interval ? interval->high : kNaN);
    if (interval && method.empty()) method = interval->method;
    if (!interval && one.n() > 0) why_none = one.why_no_interval(samples);
  }
  const auto end = [&](const char* suffix, const std::vector<double>& values, const char* which) {
    Result result{
        .name = r.name + suffix,
        .unit = r.unit,
        .n_of = r.n_of,
        .convention = which + (" end of the 95 % interval of each element of " + r.name) + ", " + method,
        .source = r.source};
    return array_of(values, result, why_none);
  };
  Result value = array_of(mean, r, why_absent);
  if (value.present())
    value.no_interval = method.empty()
                            ? why_none
                            : "the intervals of the elements are " + r.name + "_low and " + r.name + "_high";
  return {value, end("_low", low, "lower"), end("_high", high, "upper")};
}

}  // namespace twincell::analysis
