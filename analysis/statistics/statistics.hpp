#pragma once
/// \file
/// Intervals: of means of correlated series, of functions of samples, of counts.
///
/// All intervals are two-sided at 95 % unless their method says otherwise. Where an honest interval cannot be
/// given there is none, and the reason is said.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace twincell {

/// An interval and where it comes from.
struct Interval {
  double low = 0;
  double high = 0;
  double level = 0.95;
  std::string method;  ///< "block averages over cycles: …", "bootstrap over tracers", "exact binomial …"
};

/// 95 % of a normal distribution lie within so many standard errors.
inline constexpr double kStandardErrors = 1.96;
/// The standard error behind a 95 % interval, taken as that of a normal distribution: half of it over
/// kStandardErrors.
[[nodiscard]] inline double standard_error(const Interval& interval) {
  return (interval.high - interval.low) / (2 * kStandardErrors);
}

/// Two-sided 95 % point of Student's t: P(|t| < value) = 0.95 for `degrees` of freedom >= 1 (1: 12.706; 1.960
/// in the limit); infinite for 0.
double student_t_95(double degrees);

/// Integrated correlation time of a stationary series, in steps:  tau = 1/2 + sum_{k>=1} rho_k, the sum
/// stopped at the smallest window W >= 5 tau(W) and corrected for the mean having been estimated (Sokal 1997;
/// Wolff 2004). The variance of the mean of n values is 2 tau var/n. 1/2 for independent values and for a
/// constant series; never below 1/2 (an anticorrelated series is treated as an independent one). NaN for
/// fewer than 2 values. For an AR(1) series with coefficient a: (1 + a)/(2 (1 - a)).
double correlation_time(const std::vector<double>& series);

/// Mean of a series of any length in constant memory, with the error of a correlated series.
///
/// The series is kept as at most 4096 means of equally many consecutive values (one each for a short series).
/// From it come the integrated correlation time tau and blocks at all places, each at least 5 tau and an
/// eighth of the series long: with n values and blocks of m, whose means are b_j, the variance of the mean is
///   m sum_j (b_j - mean)^2/((n - m + 1)(n - m))
/// (Meketon & Schmeiser 1984), with 1.2 (floor(n/m) - 1) degrees of freedom. What a block shares with the
/// next is corrected for as if the correlation fell exponentially. The interval is moved to the side to which
/// the values are skewed (Hall 1992), at most by a quarter of its width. Series shorter than about 20 true
/// correlation times are covered to 79 to 89 %, for what they show of their correlation is too little.
class BlockAverage {
 public:
  void add(double value);
  [[nodiscard]] std::size_t n() const { return n_; }
  /// Mean of all values; NaN if there are none.
  [[nodiscard]] double mean() const;
  /// Variance of the values, sum (x - mean)^2/(n - 1); NaN for n < 2.
  [[nodiscard]] double variance() const;
  /// Integrated correlation time (see above), in values.
  [[nodiscard]] double correlation_time() const;
  /// 95 % interval of the mean by Student's t. Absent for fewer than 4 values, or if fewer
  /// than 5 blocks of 5 correlation times fit into the series (one block per value where no correlation is
  /// to be seen, tau < 0.65), and where nothing scatters (has_no_scatter).
  [[nodiscard]] std::optional<Interval> interval(const std::string& of_what) const;
  /// Why `interval` is absent; empty if it is there.
  [[nodiscard]] std::string why_no_interval(const std::string& of_what) const;
  /// Whether the series is long enough for an interval, but its blocks all have the same mean to 12 digits:
  /// its values are all the same, or they repeat with a period that fits into a block (a bed that bounces
  /// with period two).
  [[nodiscard]] bool has_no_scatter() const;

 private:
  [[nodiscard]] std::size_t block_length() const;
  /// But for rounding.
  [[nodiscard]] bool all_the_same() const;
  [[nodiscard]] double lift() const;
  /// Half of the interval's width from blocks of `length` entries of coarse_.
  [[nodiscard]] double half_width(std::size_t length) const;

  std::vector<double> coarse_;  ///< means of coarse_length_ consecutive values
  std::size_t coarse_length_ = 1;
  double open_sum_ = 0;
  std::size_t open_count_ = 0;
  std::size_t n_ = 0;
  double mean_ = 0;
  double squares_ = 0;  ///< sum of (x - mean)^2 (Welford)
  double cubes_ = 0;    ///< sum of (x - mean)^3
};

/// 95 % bootstrap of a statistic of `n` independent items: `statistic` is called with the indices of each
/// resample. Bias-corrected and accelerated (Efron 1987), with the level widened to what Student's t asks of
/// n items (Hesterberg 2014). Same seed, same interval. Widened to Student's t of the jackknife where all
/// resamples lie on one side of the value. Absent for n < 2 and where resamples do not differ.
std::optional<Interval> bootstrap_interval(
    std::size_t n, const std::function<double(const std::vector<std::size_t>&)>& statistic,
    const std::string& of_what, std::uint64_t seed = 1, std::size_t resamples = 1000);

/// 95 % interval of the mean of independent items from a skewed distribution: bootstrap of Student's t (Efron
/// & Tibshirani 1993, ch. 12.5), widened by sqrt(n/(n - 2)) for what n items do not show of the skewness.
/// Same seed, same interval. Of 2 to 5 items, whose resamples show too little: Student's t. Absent for fewer,
/// and for items that are all the same.
std::optional<Interval> mean_interval(const std::vector<double>& items, const std::string& of_what,
                                      std::uint64_t seed = 1, std::size_t resamples = 1000);

/// Why `mean_interval` of these items is absent; empty if it is there.
std::string why_no_mean_interval(const std::vector<double>& items, const std::string& of_what);

/// 95 % interval of a probability from `successes` in `trials` independent trials: exact (Clopper & Pearson
/// 1934), by quantiles of the beta distribution. For no
/// success the one-sided 95 % upper limit 1 - 0.05^(1/trials) (about 3/trials), for no failure the lower one.
/// \pre 0 <= successes <= trials, trials > 0
Interval binomial_interval(double successes, double trials, const std::string& of_what);

/// The same for effective counts, which are estimates and have no exact interval: Wilson's (1927), whose
/// coverage is 95 % on average where Clopper and Pearson's is at least 95 %. \pre 0 < successes < trials
Interval wilson_interval(double successes, double trials, const std::string& of_what);

}  // namespace twincell
