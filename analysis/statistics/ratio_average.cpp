#include "analysis/statistics/ratio_average.hpp"

#include <cmath>
#include <limits>

namespace twincell::analysis {
namespace {

constexpr std::size_t kMaxMeans = 4096;

}  // namespace

void RatioAverage::add(double a, double b) {
  ++n_;
  a_ += a;
  b_ += b;
  open_.first += a;
  open_.second += b;
  if (++open_count_ < coarse_length_) return;
  coarse_.push_back(open_);
  open_ = {0, 0};
  open_count_ = 0;
  if (coarse_.size() < kMaxMeans) return;
  for (std::size_t k = 0; 2 * k + 1 < coarse_.size(); ++k)
    coarse_[k] = {coarse_[2 * k].first + coarse_[2 * k + 1].first,
                  coarse_[2 * k].second + coarse_[2 * k + 1].second};
  coarse_.resize(coarse_.size() / 2);
  coarse_length_ *= 2;
}

double RatioAverage::mean() const {
  return n_ > 0 && b_ != 0 ? a_ / b_ : std::numeric_limits<double>::quiet_NaN();
}

SeriesAverage RatioAverage::linearised() const {
  SeriesAverage series;
  const double ratio = mean();
  if (!std::isfinite(ratio)) return series;
  const double b = b_ / static_cast<double>(n_) * static_cast<double>(coarse_length_);
  for (const auto& [sum_a, sum_b] : coarse_) series.add(ratio + (sum_a - ratio * sum_b) / b);
  return series;
}

SeriesAverage RatioAverage::combination(double f, double g) const {
  SeriesAverage series;
  for (const auto& [sum_a, sum_b] : coarse_)
    series.add((f * sum_a + g * sum_b) / static_cast<double>(coarse_length_));
  return series;
}

std::pair<double, double> RatioAverage::means() const {
  const auto n = static_cast<double>(n_);
  return {a_ / n, b_ / n};
}

std::optional<Interval> RatioAverage::interval(const std::string& of_what) const {
  return linearised().interval(of_what);
}

std::string RatioAverage::why_no_interval(const std::string& of_what) const {
  return linearised().why_no_interval(of_what);
}

}  // namespace twincell::analysis
