#pragma once
/// \file
/// A simulation that is analysed while it runs: its frames are made when they are asked for, and not kept.

#include <cstddef>
#include <functional>
#include <string>

#include "sim/run/simulation.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sweep {

class LiveTrajectory : public TrajectorySource {
 public:
  /// Called with each frame as it is made; false ends the trajectory with that frame's cycle, at its last
  /// phase.
  using Watcher = std::function<bool(const Frame& frame)>;

  /// Settles the run. \param name for messages \throws RunError, Interrupted
  LiveTrajectory(sim::Simulation& run, std::string name, Progress& progress, Watcher watcher);

  [[nodiscard]] const TrajectoryInfo& info() const override { return info_; }
  /// Of the whole run, or up to where the watcher ended it.
  [[nodiscard]] std::size_t n_frames() const override { return n_frames_; }
  /// \pre index is that of the last frame read, or the next one \throws RunError, Interrupted
  void read(std::size_t index, Frame& frame) const override;
  [[nodiscard]] std::string name() const override { return name_; }

 private:
  sim::Simulation& run_;
  std::string name_;
  Progress& progress_;
  Watcher watcher_;
  TrajectoryInfo info_;
  mutable std::size_t n_frames_ = 0, made_ = 0;
  mutable Frame last_;
};

}  // namespace twincell::sweep
