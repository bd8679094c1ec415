#pragma once
/// \file
/// Random numbers that depend on their purpose and not on the order of the calls, so that the result does not
/// depend on the number of threads.

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numbers>

namespace twincell::imaging {

/// Purpose of a stream of random numbers.
enum class Chance : std::uint64_t { noise = 1, lamp, trigger, storage, dirt, glare };

/// SplitMix64 (Steele, Lea & Flood, OOPSLA 2014), seeded by a hash of seed, purpose and two numbers.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, Chance purpose, std::int64_t a, std::int64_t b = 0) : state_(seed) {
    for (const std::uint64_t word :
         {static_cast<std::uint64_t>(purpose), static_cast<std::uint64_t>(a), static_cast<std::uint64_t>(b)})
      state_ = mixed(state_ + 0x9E3779B97F4A7C15ULL * (word + 1));
  }
  /// In (0, 1).
  double uniform() {
    state_ += 0x9E3779B97F4A7C15ULL;
    return (static_cast<double>(mixed(state_) >> 11) + 0.5) * 0x1p-53;
  }
  double uniform(double a, double b) { return a + (b - a) * uniform(); }
  /// Normal distribution with mean 0 and variance 1, by the Box-Muller method. std::normal_distribution is
  /// not used, because it differs between implementations.
  double normal() {
    if (kept_) {
      kept_ = false;
      return other_;
    }
    const double r = std::sqrt(-2 * std::log(uniform())), angle = 2 * std::numbers::pi * uniform();
    other_ = r * std::sin(angle);
    kept_ = true;
    return r * std::cos(angle);
  }

 private:
  static std::uint64_t mixed(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
  double other_ = 0;
  bool kept_ = false;
};

}  // namespace twincell::imaging
