#pragma once
/// \file
/// Confidence intervals: for means of correlated series, functions of samples, and counts.
///
/// All intervals are two-sided at 95 % unless their method states otherwise. If no valid interval can be
/// given, it is absent and the reason is stated.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace twincell::analysis {

struct Autoregression;

/// A confidence interval and the method that gave it.
struct Interval {
  double low = 0;
  double high = 0;
  double level = 0.95;
  std::string method;  ///< "block averages over cycles: …", "bootstrap over tracers", "exact binomial …"
};

/// Half width of the central 95 % interval of a normal distribution, in standard errors.
inline constexpr double kStandardErrors = 1.96;
/// Standard error that corresponds to a 95 % interval of a normal distribution: half the width of the
/// interval divided by kStandardErrors.
[[nodiscard]] inline double standard_error(const Interval& interval) {
  return (interval.high - interval.low) / (2 * kStandardErrors);
}

/// Arithmetic mean, sum x_i/n. NaN for no values.
[[nodiscard]] double mean(const std::vector<double>& values);

/// Two-sided 95 % quantile of Student's t: P(|t| < value) = 0.95 for `degrees` of freedom >= 1 (12.706 for 1,
/// 1.960 in the limit). Infinite for 0.
double student_t_95(double degrees);

/// Integrated correlation time of a stationary series, in steps: tau = 1/2 + sum_{k>=1} rho_k of the
/// autoregressive process that describes it (fit_autoregression). The variance of the mean of n values is
/// 2 tau var/n. tau is 1/2 for independent values and for a constant series. It is never below 1/2: an
/// anticorrelated series is treated as independent. Infinite for a series that drifts, NaN for fewer than 2
/// values. An AR(1) series with coefficient a has tau = (1 + a)/(2 (1 - a)).
double correlation_time(const std::vector<double>& series);

/// Mean of a series of any length in constant memory, with its error for correlated values.
///
/// The series is stored as at most 4096 means of equally many consecutive values (one value each for a short
/// series). An autoregressive process takes their correlation away (prewhitening, Andrews & Monahan 1992).
/// With its innovations e_i, i = 0 ... m - 1, and its coefficients a_k, the mean of n values has the variance
///
///     1/(n (1 - sum_k a_k)^2)  1/B sum_{j=1..B} c_j^2,
///     c_j = sqrt(2/m) sum_i e_i cos(pi j (i + 1/2)/m)
///
/// with B = 6 cosines, or 8 for a series of 100 correlation times and more. The interval is that of Student's
/// t with B - 1 degrees of freedom (Lazarus, Lewis, Stock & Watson 2018), shifted towards the side of the
/// skewness (Hall 1992), at most by a quarter of its width. Of autoregressive series of 20 correlation times,
/// 94 % of the intervals or more contain the mean; docs/statistics.md states other processes.
class SeriesAverage {
 public:
  /// Adds the next value of the series.
  void add(double value);
  [[nodiscard]] std::size_t n() const { return n_; }
  /// Mean of all values; NaN if there are none.
  [[nodiscard]] double mean() const;
  /// Variance of the values, sum (x - mean)^2/(n - 1); NaN for n < 2.
  [[nodiscard]] double variance() const;
  /// Integrated correlation time (see the free function correlation_time), in values.
  [[nodiscard]] double correlation_time() const;
  /// 95 % interval of the mean. Absent for fewer than 4 values, for fewer than 8 correlation times, and if
  /// there is no scatter (has_no_scatter).
  [[nodiscard]] std::optional<Interval> interval(const std::string& of_what) const;
  /// Why `interval` is absent; empty if it is present.
  [[nodiscard]] std::string why_no_interval(const std::string& of_what) const;
  /// Whether at least 4 values are equal, or each follows exactly from its predecessors (for example those of
  /// a bed that bounces with period two).
  [[nodiscard]] bool has_no_scatter() const;

 private:
  /// Whether all values (at least 4) are equal up to rounding.
  [[nodiscard]] bool all_the_same() const;
  /// The process of the stored means. Empty if these are all equal, or each follows from those before it.
  /// \pre n() >= 4
  [[nodiscard]] std::optional<Autoregression> process() const;
  /// Correlation time in values, from that of the stored means.
  [[nodiscard]] double in_values(double coarse) const;
  [[nodiscard]] bool is_long_enough(const Autoregression& fit) const;
  /// \param tau correlation time, in values
  [[nodiscard]] double lift(double tau) const;
  [[nodiscard]] double standard_error(const Autoregression& fit, std::size_t cosines) const;

  std::vector<double> coarse_;  ///< means of coarse_length_ consecutive values
  std::size_t coarse_length_ = 1;
  double open_sum_ = 0;
  std::size_t open_count_ = 0;
  std::size_t n_ = 0;
  double mean_ = 0;
  double squares_ = 0;  ///< sum of (x - mean)^2 (Welford)
  double cubes_ = 0;    ///< sum of (x - mean)^3
};

/// 95 % bootstrap interval of a statistic of `n` independent items. `statistic` is called with the indices of
/// each resample. The bootstrap is bias-corrected and accelerated (Efron 1987), with the level widened to
/// that of Student's t for n items (Hesterberg 2014). If all resamples are on one side of the value, the
/// interval is widened to Student's t of the jackknife. The same seed gives the same interval. Absent for n <
/// 2, for fewer than 40 finite resamples, and if the resamples do not differ.
std::optional<Interval> bootstrap_interval(
    std::size_t n, const std::function<double(const std::vector<std::size_t>&)>& statistic,
    const std::string& of_what, std::uint64_t seed = 1, std::size_t resamples = 1000);

/// 95 % interval of the mean of independent items from a skewed distribution, by the bootstrap of Student's t
/// (Efron & Tibshirani 1993, ch. 12.5). It is widened by sqrt(n/(n - 2)), because n items underestimate the
/// skewness. The same seed gives the same interval. For 2 to 5 items, which have too few distinct resamples,
/// the interval is Student's t. Quantiles beyond four times those of Student's t, which items give of which
/// all but one nearly agree, are limited to that. Absent for fewer than 2 items and for items that are all
/// equal.
std::optional<Interval> mean_interval(const std::vector<double>& items, const std::string& of_what,
                                      std::uint64_t seed = 1, std::size_t resamples = 1000);

/// Exact 95 % interval of a probability from `successes` in `trials` independent trials (Clopper & Pearson
/// 1934), by quantiles of the beta distribution. Without a success it is the one-sided 95 % upper limit 1 -
/// 0.05^(1/trials) (about 3/trials); without a failure it is the one-sided lower limit.
/// \pre 0 <= successes <= trials, trials > 0
Interval binomial_interval(double successes, double trials, const std::string& of_what);

/// 95 % interval of a probability from effective counts, which are estimates and have no exact interval:
/// Wilson's interval (1927). Its coverage is 95 % on average, whereas that of Clopper and Pearson is at least
/// 95 %.
/// \pre 0 < successes < trials
Interval wilson_interval(double successes, double trials, const std::string& of_what);

}  // namespace twincell::analysis
