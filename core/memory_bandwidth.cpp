#include "core/memory_bandwidth.hpp"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/in_parallel.hpp"
#include "core/machine_memory.hpp"
#include "core/stage_times.hpp"

namespace twincell {

std::optional<double> memory_bandwidth(int threads) {
  constexpr std::size_t kBytes = std::size_t{128} << 20U, kNumbers = kBytes / sizeof(std::uint64_t);
  constexpr int kPasses = 3;
  if (memory_available() < 4.0 * kBytes) return std::nullopt;
  const std::vector<std::uint64_t> numbers(kNumbers, 1);
  const auto n = static_cast<std::size_t>(threads);
  std::atomic<std::uint64_t> sum = 0;  // used, so that the compiler keeps the loop
  double best = 0;
  for (int pass = 0; pass < kPasses; ++pass) {
    const double begin = StageTimes::elapsed_seconds();
    in_parallel(n, threads, [&](std::size_t t) {
      const auto at = [&](std::size_t part) {
        return numbers.begin() + static_cast<std::ptrdiff_t>(kNumbers * part / n);
      };
      sum += std::accumulate(at(t), at(t + 1), std::uint64_t{0});
    });
    const double seconds = StageTimes::elapsed_seconds() - begin;
    if (seconds > 0) best = std::max(best, kBytes / seconds);
  }
  if (best == 0 || sum != kPasses * kNumbers) return std::nullopt;
  return best;
}

}  // namespace twincell
