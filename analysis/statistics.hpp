#pragma once
/// \file
/// Intervals for means of correlated series and for functions of samples.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace twincell {

/// A two-sided interval and where it comes from.
struct Interval {
  double low = 0;
  double high = 0;
  double level = 0.95;
  std::string method;  ///< "block averages over cycles", "bootstrap over tracers"
};

/// Two-sided 95 % point of Student's t: P(|t| < value) = 0.95 for `degrees` of freedom >= 1 (1: 12.706; 1.960
/// in the limit).
double student_t_95(std::size_t degrees);

/// Mean of a series of any length in constant memory, with the error of a correlated series: consecutive
/// values are gathered into 10 to 19 blocks of equal length (the length doubles whenever 20 are full), and
/// the block means are taken as independent.
class BlockAverage {
 public:
  void add(double value);
  [[nodiscard]] std::size_t n() const { return n_; }
  /// Mean of all values; NaN if there are none.
  [[nodiscard]] double mean() const;
  /// 95 % interval of the mean by Student's t over the full blocks. Absent with fewer than 4 values.
  [[nodiscard]] std::optional<Interval> interval(const std::string& of_what) const;

 private:
  static constexpr std::size_t kMaxBlocks = 20;
  std::vector<double> blocks_;  ///< sums of full blocks
  std::size_t block_length_ = 1;
  double open_sum_ = 0;
  std::size_t open_count_ = 0;
  double sum_ = 0;
  std::size_t n_ = 0;
};

/// 95 % percentile bootstrap of a statistic of `n` independent items: `statistic` is called with the indices
/// of each resample. Same seed, same interval. Absent for n < 2.
std::optional<Interval> bootstrap_interval(
    std::size_t n, const std::function<double(const std::vector<std::size_t>&)>& statistic,
    const std::string& of_what, std::uint64_t seed = 1, std::size_t resamples = 1000);

}  // namespace twincell
