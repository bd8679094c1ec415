#pragma once
/// \file
/// Pairs of frames that are a whole number of intervals apart, for displacements and correlations.

#include <cmath>
#include <cstddef>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "trajectory/trajectory.hpp"

namespace twincell::analysis {

/// One vector per bead of the last frames.
class LaggedVectors {
 public:
  /// \param longest largest lag, intervals
  explicit LaggedVectors(std::size_t longest) : longest_(longest) {}

  /// Adds a frame and calls pair(lag, before, now) for it and each earlier frame that is `lag` intervals
  /// earlier, 0 <= lag <= longest, the frame itself included; a tenth of an interval off still counts.
  /// \param at time of the frame, and `interval` in its unit; while it is 0 every frame has the lag 0
  template <class Pair>
  void add(double at, std::vector<Vec3> now, double interval, const Pair& pair) {
    past_.emplace_back(at, std::move(now));
    const auto longest = static_cast<double>(longest_);
    for (const auto& [time, before] : past_) {
      const double lag = interval > 0 ? (at - time) / interval : 0, whole = std::round(lag);
      constexpr double kJitter = 0.1;
      if (whole < 0 || whole > longest || std::abs(lag - whole) > kJitter) continue;
      pair(static_cast<std::size_t>(whole), before, past_.back().second);
    }
    if (past_.size() > longest_) past_.pop_front();
  }
  /// Time of the last frame.
  /// \pre a frame was added
  [[nodiscard]] double last() const { return past_.back().first; }
  [[nodiscard]] bool empty() const { return past_.empty(); }

 private:
  std::size_t longest_;
  std::deque<std::pair<double, std::vector<Vec3>>> past_;
};

/// The vectors of the beads of a frame, its positions or velocities: NaN where a bead is absent, without the
/// y component in a planar cell.
inline std::vector<Vec3> of_present(const Frame& frame, std::vector<Vec3> vectors, const Box& box) {
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    if (box.dimension == 2) vectors[i].y() = 0;
    if (!frame.present(i)) vectors[i].setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return vectors;
}

}  // namespace twincell::analysis
