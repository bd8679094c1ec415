#include "analysis/statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace twincell {

double student_t_95(std::size_t degrees) {
  static constexpr std::array<double, 30> table = {
      12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.3060, 2.2622, 2.2281,
      2.2010,  2.1788, 2.1604, 2.1448, 2.1314, 2.1199, 2.1098, 2.1009, 2.0930, 2.0860,
      2.0796,  2.0739, 2.0687, 2.0639, 2.0595, 2.0555, 2.0518, 2.0484, 2.0452, 2.0423};
  if (degrees == 0) return std::numeric_limits<double>::infinity();
  if (degrees <= table.size()) return table[degrees - 1];
  // Cornish-Fisher expansion about the normal quantile; error below 1e-5 from 31 degrees on.
  const double z = 1.959963985;
  const double v = static_cast<double>(degrees);
  return z + (z * z * z + z) / (4 * v) + (5 * std::pow(z, 5) + 16 * z * z * z + 3 * z) / (96 * v * v);
}

void BlockAverage::add(double value) {
  sum_ += value;
  ++n_;
  open_sum_ += value;
  if (++open_count_ < block_length_) return;
  blocks_.push_back(open_sum_);
  open_sum_ = 0;
  open_count_ = 0;
  if (blocks_.size() < kMaxBlocks) return;
  for (std::size_t i = 0; i < kMaxBlocks / 2; ++i) blocks_[i] = blocks_[2 * i] + blocks_[2 * i + 1];
  blocks_.resize(kMaxBlocks / 2);
  block_length_ *= 2;
}

double BlockAverage::mean() const {
  return n_ == 0 ? std::numeric_limits<double>::quiet_NaN() : sum_ / static_cast<double>(n_);
}

std::optional<Interval> BlockAverage::interval(const std::string& of_what) const {
  const std::size_t count = blocks_.size();
  if (count < 4) return std::nullopt;
  const double length = static_cast<double>(block_length_);
  const double centre =
      std::accumulate(blocks_.begin(), blocks_.end(), 0.0) / static_cast<double>(count) / length;
  double squares = 0;
  for (const double block : blocks_) squares += (block / length - centre) * (block / length - centre);
  const double error = std::sqrt(squares / static_cast<double>(count - 1) / static_cast<double>(count));
  const double half = student_t_95(count - 1) * error;
  return Interval{mean() - half, mean() + half, 0.95, "block averages over " + of_what};
}

std::optional<Interval> bootstrap_interval(
    std::size_t n, const std::function<double(const std::vector<std::size_t>&)>& statistic,
    const std::string& of_what, std::uint64_t seed, std::size_t resamples) {
  if (n < 2 || resamples < 40) return std::nullopt;
  std::mt19937_64 generator(seed);
  std::vector<std::size_t> pick(n);
  std::vector<double> values;
  values.reserve(resamples);
  for (std::size_t r = 0; r < resamples; ++r) {
    for (auto& index : pick) index = static_cast<std::size_t>(generator() % n);  // bias below n/2^64
    const double value = statistic(pick);
    if (std::isfinite(value)) values.push_back(value);
  }
  if (values.size() < 40) return std::nullopt;
  std::sort(values.begin(), values.end());
  const auto at = [&](double fraction) {
    return values[static_cast<std::size_t>(std::lround(fraction * static_cast<double>(values.size() - 1)))];
  };
  return Interval{at(0.025), at(0.975), 0.95, "bootstrap over " + of_what};
}

}  // namespace twincell
