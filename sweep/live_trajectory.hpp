#pragma once
/// \file
/// A running simulation as a trajectory: each frame is computed when it is read and not stored.

#include <cstddef>
#include <functional>
#include <string>

#include "sim/run/simulation.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sweep {

/// Trajectory source that advances a simulation by one frame per read.
class LiveTrajectory : public TrajectorySource {
 public:
  /// Called with each new frame. A return value of false at the last phase of a cycle ends the trajectory
  /// there.
  using Watcher = std::function<bool(const Frame& frame)>;

  /// Settles the bed before the first frame.
  /// \param name for messages
  /// \param times receives the times of the stages of the simulation; null: not timed
  /// \throws RunError, Interrupted
  LiveTrajectory(sim::Simulation& run, std::string name, Progress& progress, Watcher watcher,
                 StageTimes* times = nullptr);

  [[nodiscard]] const TrajectoryInfo& info() const override { return info_; }
  /// Number of frames of the whole run, or up to the frame where the watcher ended it.
  [[nodiscard]] std::size_t n_frames() const override { return n_frames_; }
  /// \pre index is that of the last frame read, or the next one
  /// \throws RunError, Interrupted
  void read(std::size_t index, Frame& frame) const override;
  [[nodiscard]] std::string name() const override { return name_; }

 private:
  sim::Simulation& run_;
  std::string name_;
  Progress& progress_;
  Watcher watcher_;
  StageTimes* times_;
  TrajectoryInfo info_;
  mutable std::size_t n_frames_ = 0, made_ = 0;
  mutable Frame last_;
};

}  // namespace twincell::sweep
