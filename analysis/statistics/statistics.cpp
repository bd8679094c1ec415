#include "analysis/statistics/statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/beta.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

#include "analysis/statistics/autoregression.hpp"
#include "core/constants.hpp"

namespace twincell::analysis {
namespace {

/// Maximum number of stored means of consecutive values.
constexpr std::size_t kCoarse = 4096;
/// Relative difference below which two numbers are equal up to rounding.
constexpr double kSame = 1e-12;
/// Upper bound of the ratio variance/mean^2 that rounding leaves when equal numbers are accumulated.
constexpr double kRounding = 1e-13;
/// Number of cosines. Few, because a shaken gas has slow breathing modes: it is correlated with its state 18
/// cycles earlier, long after the first zero of its correlation function, and more cosines reach into its
/// frequencies. A long series has room for more.
constexpr std::size_t kCosines = 6, kCosinesOfLongSeries = 8;
/// Length of a long series, in correlation times.
constexpr double kLongSeries = 100;
/// Degrees of freedom that the fitted process takes. Without them, 92.8 % of the
/// intervals of 80 skewed values contained the mean.
constexpr double kDegreesOfPrewhitening = 1;
/// Least length of a series with an interval, in correlation times. Shorter ones cannot be told from a
/// random walk, which has no mean.
constexpr double kMinTimes = 8;
constexpr std::size_t kMinValues = 4;

/// Minimum number of items for a bootstrap. Below it the interval is Student's t, because resamples of so few
/// items have too little variety. For normally distributed values Student's t has 95 % coverage at every
/// number of items. For 6 exponentially distributed values its coverage is 87 %, that of the bootstrap 94 %.
constexpr std::size_t kItemsToResample = 6;
/// Largest quantile of the studentised bootstrap, in those of Student's t. Where all items but one nearly
/// agree, a resample without this one has almost no scatter of its own, and its t is without bound: s_c of 7
/// tracers, of which one had moved, was 0.3 [0, 194]. Skewed items that are not degenerate stay below.
constexpr double kMaxStudents = 4;

double normal_cdf(double z) {
  return boost::math::cdf(boost::math::normal(), z);
}
double normal_quantile(double p) {
  return boost::math::quantile(boost::math::normal(), p);
}

}  // namespace

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

double student_t_95(double degrees) {
  if (degrees <= 0) return std::numeric_limits<double>::infinity();
  return boost::math::quantile(boost::math::students_t(degrees), 0.975);
}

double correlation_time(const std::vector<double>& series) {
  if (series.size() < 2) return kNaN;
  const double mean = twincell::analysis::mean(series);
  double squares = 0;
  for (const double x : series) squares += (x - mean) * (x - mean);
  // The correlation of a series that is constant up to rounding is meaningless.
  if (squares <= 1e-28 * mean * mean * static_cast<double>(series.size())) return 0.5;
  return fit_autoregression(series).correlation_time;
}

void SeriesAverage::add(double value) {
  ++n_;
  const double off = value - mean_, n = static_cast<double>(n_), step = off / n;
  mean_ += step;
  cubes_ += off * step * step * (n - 1) * (n - 2) - 3 * step * squares_;
  squares_ += off * (value - mean_);
  open_sum_ += value;
  if (++open_count_ < coarse_length_) return;
  coarse_.push_back(open_sum_ / static_cast<double>(coarse_length_));
  open_sum_ = 0;
  open_count_ = 0;
  // When the buffer is full, adjacent means are merged, so that the memory stays constant.
  if (coarse_.size() < kCoarse) return;
  for (std::size_t b = 0; b < kCoarse / 2; ++b) coarse_[b] = (coarse_[2 * b] + coarse_[2 * b + 1]) / 2;
  coarse_.resize(kCoarse / 2);
  coarse_length_ *= 2;
}

double SeriesAverage::mean() const {
  return n_ > 0 ? mean_ : kNaN;
}

double SeriesAverage::variance() const {
  return n_ > 1 ? squares_ / static_cast<double>(n_ - 1) : kNaN;
}

double SeriesAverage::correlation_time() const {
  return in_values(twincell::analysis::correlation_time(coarse_));
}

double SeriesAverage::in_values(double coarse) const {
  if (coarse_length_ == 1 || !(variance() > 0)) return coarse;
  // The variance of the mean is the same in the coarse and in the full series, which gives tau of the full
  // one.
  const double centre = twincell::analysis::mean(coarse_);
  double squares = 0;
  for (const double block : coarse_) squares += (block - centre) * (block - centre);
  const double of_blocks = squares / static_cast<double>(coarse_.size() - 1);
  return std::max(0.5, coarse * static_cast<double>(coarse_length_) * of_blocks / variance());
}

bool SeriesAverage::all_the_same() const {
  return n_ >= kMinValues && !(variance() > kRounding * mean_ * mean_);
}

std::optional<Autoregression> SeriesAverage::process() const {
  const auto [least, largest] = std::minmax_element(coarse_.begin(), coarse_.end());
  // The variance enters the scale because the mean may be zero by cancellation.
  if (*largest - *least <= kSame * std::sqrt(mean_ * mean_ + variance())) return std::nullopt;
  Autoregression fit = fit_autoregression(coarse_);
  if (fit.unexplained < kSame) return std::nullopt;
  return fit;
}

bool SeriesAverage::has_no_scatter() const {
  return n_ >= kMinValues && (all_the_same() || !process());
}

bool SeriesAverage::is_long_enough(const Autoregression& fit) const {
  return static_cast<double>(coarse_.size()) >= kMinTimes * fit.correlation_time;
}

std::string SeriesAverage::why_no_interval(const std::string& of_what) const {
  if (n_ < kMinValues)
    return fmt::format("too few {} for an error: {} of at least {}", of_what, n_, kMinValues);
  if (all_the_same()) return fmt::format("the same in all {} {}", n_, of_what);
  const auto fit = process();
  if (!fit) return fmt::format("{} {} repeat with a period: they do not scatter", n_, of_what);
  if (is_long_enough(*fit)) return "";
  return std::isinf(fit->correlation_time)
             ? fmt::format("{} {} drift: their correlation does not end", n_, of_what)
             : fmt::format(
                   "{} {} with a correlation time of {:.3g} are too few for an error: {:g} times the "
                   "correlation time at least",
                   n_, of_what, in_values(fit->correlation_time), kMinTimes);
}

/// Standard error of the mean. The spectrum of the innovations at zero frequency is the mean over the lowest
/// cosines of their squared transforms, each of which is one degree of freedom.
double SeriesAverage::standard_error(const Autoregression& fit, std::size_t cosines) const {
  const std::vector<double>& e = fit.innovations;
  const auto m = static_cast<double>(e.size());
  double sum = 0;
  for (std::size_t j = 1; j <= cosines; ++j) {
    // cos(pi j (i + 1/2)/m) by turning a unit vector: a cosine for each value costs more than the rest.
    const double angle = std::numbers::pi * static_cast<double>(j) / m;
    std::complex<double> at = std::polar(1.0, angle / 2);
    const std::complex<double> turn = std::polar(1.0, angle);
    double transform = 0;
    for (const double value : e) {
      transform += value * at.real();
      at *= turn;
    }
    sum += 2 / m * transform * transform;
  }
  const double spectrum = sum / static_cast<double>(cosines) / (fit.gain() * fit.gain());
  return std::sqrt(spectrum * static_cast<double>(coarse_length_) / static_cast<double>(n_));
}

/// Upward shift of the interval's centre from the mean, in standard errors. In a small sample from a
/// distribution with positive skewness, a mean that is too low comes with a scatter that is too small. The
/// shift is the second term of the Edgeworth series of Student's t (Hall 1992), (2 z^2 + 1)/6 times the
/// skewness of the mean.
double SeriesAverage::lift(double tau) const {
  if (n_ < 3) return 0;
  const auto n = static_cast<double>(n_);
  const double skewness = std::sqrt(n * (n - 1)) / (n - 2) * std::sqrt(n) * cubes_ / std::pow(squares_, 1.5);
  return (2 * kStandardErrors * kStandardErrors + 1) / 6 * skewness / std::sqrt(n / (2 * tau));
}

std::optional<Interval> SeriesAverage::interval(const std::string& of_what) const {
  if (n_ < kMinValues || all_the_same()) return std::nullopt;
  const auto fit = process();
  if (!fit || !is_long_enough(*fit)) return std::nullopt;
  const bool is_long = static_cast<double>(coarse_.size()) >= kLongSeries * fit->correlation_time;
  const std::size_t cosines =
      std::min(is_long ? kCosinesOfLongSeries : kCosines, fit->innovations.size() - 1);
  const double degrees = std::max(1.0, static_cast<double>(cosines) - kDegreesOfPrewhitening);
  const double half = student_t_95(degrees) * standard_error(*fit, cosines);
  const double tau = in_values(fit->correlation_time);
  // The limit keeps the mean well inside the interval.
  const double lifted = mean() + half * std::clamp(lift(tau) / kStandardErrors, -0.5, 0.5);
  return Interval{lifted - half, lifted + half, 0.95,
                  fmt::format("Student's t of {} cosines over {}, prewhitened at order {}, correlation time "
                              "{:.3g} {}",
                              cosines, of_what, fit->coefficients.size(), tau, of_what)};
}

std::optional<Interval> bootstrap_interval(
    std::size_t n, const std::function<double(const std::vector<std::size_t>&)>& statistic,
    const std::string& of_what, std::uint64_t seed, std::size_t resamples) {
  if (n < 2 || resamples < 40) return std::nullopt;
  std::vector<std::size_t> pick(n);
  std::iota(pick.begin(), pick.end(), std::size_t{0});
  const double value = statistic(pick);
  if (!std::isfinite(value)) return std::nullopt;

  // Jackknife: leaving out one item at a time gives the acceleration.
  std::vector<double> left_out;
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<std::size_t> others;
    for (std::size_t k = 0; k < n; ++k)
      if (k != i) others.push_back(k);
    const double without = statistic(others);
    if (std::isfinite(without)) left_out.push_back(without);
  }
  double acceleration = 0;
  if (left_out.size() == n) {
    const double centre = twincell::analysis::mean(left_out);
    double second = 0, third = 0;
    for (const double v : left_out) {
      second += (centre - v) * (centre - v);
      third += (centre - v) * (centre - v) * (centre - v);
    }
    if (second > 0) acceleration = third / (6 * std::pow(second, 1.5));
  }

  // Bootstrap: the statistic of random resamples.
  std::mt19937_64 generator(seed);
  std::vector<double> values;
  values.reserve(resamples);
  for (std::size_t r = 0; r < resamples; ++r) {
    for (auto& index : pick) index = static_cast<std::size_t>(generator() % n);  // bias below n/2^64
    const double resampled = statistic(pick);
    if (std::isfinite(resampled)) values.push_back(resampled);
  }
  if (values.size() < 40) return std::nullopt;
  std::sort(values.begin(), values.end());
  // Bias correction: the share of resamples below the value sets the shift of the quantiles.
  const auto count = static_cast<double>(values.size());
  const auto below =
      static_cast<double>(std::lower_bound(values.begin(), values.end(), value) - values.begin());
  const auto equal =
      static_cast<double>(std::upper_bound(values.begin(), values.end(), value) - values.begin()) - below;
  const double share = std::clamp((below + equal / 2) / count, 0.5 / count, 1 - 0.5 / count);
  const double shift = normal_quantile(share);
  const double wide = student_t_95(static_cast<double>(n - 1)) *
                      std::sqrt(static_cast<double>(n) / static_cast<double>(n - 1));
  const auto at = [&](double z) {
    const double stretched = (shift + z) / std::max(0.1, 1 - acceleration * (shift + z));
    return values[static_cast<std::size_t>(std::lround(normal_cdf(shift + stretched) * (count - 1)))];
  };
  const Interval interval{at(-wide), at(wide), 0.95, "bootstrap over " + of_what};
  // Differences due to rounding alone are not scatter.
  if (interval.high - interval.low <= 1e-12 * std::abs(value)) return std::nullopt;
  if (interval.low <= value && value <= interval.high) return interval;
  // Resamples that are all on one side give no bound on the other side: the jackknife error replaces it.
  if (left_out.size() != n) return std::nullopt;
  const double centre = twincell::analysis::mean(left_out);
  double squares = 0;
  for (const double v : left_out) squares += (v - centre) * (v - centre);
  const auto items = static_cast<double>(n);
  const double half = student_t_95(items - 1) * std::sqrt((items - 1) / items * squares);
  if (!(half > 0)) return std::nullopt;
  return Interval{std::min(interval.low, value - half), std::max(interval.high, value + half), 0.95,
                  "bootstrap over " + of_what + ", widened to Student's t of the jackknife"};
}

std::optional<Interval> mean_interval(const std::vector<double>& items, const std::string& of_what,
                                      std::uint64_t seed, std::size_t resamples) {
  const std::size_t n = items.size();
  if (n < 2) return std::nullopt;
  const auto mean_and_error = [n](const auto& value) {
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < n; ++i) sum += value(i);
    const double mean = sum / static_cast<double>(n);
    for (std::size_t i = 0; i < n; ++i) squares += (value(i) - mean) * (value(i) - mean);
    return std::pair(mean, std::sqrt(squares / static_cast<double>(n - 1) / static_cast<double>(n)));
  };
  const auto [mean, error] = mean_and_error([&](std::size_t i) { return items[i]; });
  if (!std::isfinite(mean) || error <= 1e-12 * std::abs(mean)) return std::nullopt;
  if (n < kItemsToResample) {
    const double half = student_t_95(static_cast<double>(n - 1)) * error;
    return Interval{mean - half, mean + half, 0.95, "Student's t over " + of_what};
  }
  std::mt19937_64 generator(seed);
  std::vector<std::size_t> pick(n);
  std::vector<double> t;
  for (std::size_t r = 0; r < resamples; ++r) {
    for (auto& index : pick) index = static_cast<std::size_t>(generator() % n);  // bias below n/2^64
    const auto [again, its_error] = mean_and_error([&](std::size_t i) { return items[pick[i]]; });
    if (its_error > 1e-9 * error) t.push_back((again - mean) / its_error);
  }
  const std::string method = "bootstrap (studentised) over " + of_what;
  // A few items show less skewness than their distribution has. Without this factor, the coverage for 20
  // squares of Gaussians is 93.8 %.
  const double wide = error * std::sqrt(static_cast<double>(n) / static_cast<double>(n - 2));
  if (t.size() < 40) return std::nullopt;
  std::sort(t.begin(), t.end());
  const double most = kMaxStudents * student_t_95(static_cast<double>(n - 1));
  const auto at = [&](double share) {
    const double quantile =
        t[static_cast<std::size_t>(std::lround(share * static_cast<double>(t.size() - 1)))];
    return std::clamp(quantile, -most, most);
  };
  return Interval{mean - at(0.975) * wide, mean - at(0.025) * wide, 0.95, method};
}

Interval binomial_interval(double successes, double trials, const std::string& of_what) {
  constexpr double kTail = 0.05;
  const double failures = trials - successes;
  if (successes <= 0)
    return {0, -std::expm1(std::log(kTail) / trials), 0.95,
            "exact binomial over " + of_what + ": no success, one-sided upper limit"};
  if (failures <= 0)
    return {std::exp(std::log(kTail) / trials), 1, 0.95,
            "exact binomial over " + of_what + ": no failure, one-sided lower limit"};
  return {boost::math::ibeta_inv(successes, failures + 1, kTail / 2),
          boost::math::ibeta_inv(successes + 1, failures, 1 - kTail / 2), 0.95,
          "exact binomial (Clopper-Pearson) over " + of_what};
}

Interval wilson_interval(double successes, double trials, const std::string& of_what) {
  const double z = normal_quantile(0.975), p = successes / trials;
  const double centre = (p + z * z / (2 * trials)) / (1 + z * z / trials);
  const double half =
      z * std::sqrt(p * (1 - p) / trials + z * z / (4 * trials * trials)) / (1 + z * z / trials);
  return {std::max(0.0, centre - half), std::min(1.0, centre + half), 0.95, "Wilson's over " + of_what};
}

}  // namespace twincell::analysis
