#pragma once
/// \file
/// Averages over cycles, in which all phases have the same weight.

#include <cstdint>
#include <optional>
#include <string>

#include "analysis/statistics/statistics.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::analysis {

/// Mean over the frames of whole cycles, or over all frames if no cycle is whole.
class CycleAverage {
 public:
  /// \param frames_per_cycle 0: over all frames
  explicit CycleAverage(int frames_per_cycle) : frames_per_cycle_(frames_per_cycle) {}

  /// Adds the value of a frame. Returns the mean of the cycle if this frame completes it.
  std::optional<double> add(const Frame& frame, double value) {
    frames_.add(value);
    if (frames_per_cycle_ <= 0 || frame.cycle < 0) return std::nullopt;
    if (frame.cycle != cycle_) {
      cycle_ = frame.cycle;
      sum_ = 0;
      count_ = 0;
    }
    sum_ += value;
    if (++count_ != frames_per_cycle_) return std::nullopt;
    cycles_.add(sum_ / count_);
    return sum_ / count_;
  }
  [[nodiscard]] bool by_cycles() const { return cycles_.n() > 0; }
  [[nodiscard]] const SeriesAverage& average() const { return by_cycles() ? cycles_ : frames_; }
  [[nodiscard]] std::string of_what() const { return by_cycles() ? "cycles" : "frames"; }

 private:
  int frames_per_cycle_;
  std::int64_t cycle_ = -1;
  double sum_ = 0;
  int count_ = 0;
  SeriesAverage cycles_, frames_;
};

}  // namespace twincell::analysis
