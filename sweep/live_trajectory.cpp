#include "sweep/live_trajectory.hpp"

#include <cassert>
#include <utility>

namespace twincell::sweep {

namespace {

/// Sink that stores the latest frame.
class Hand : public TrajectorySink {
 public:
  explicit Hand(Frame& frame) : frame_(frame) {}
  void append(const Frame& frame) override { frame_ = frame; }

 private:
  Frame& frame_;
};

}  // namespace

LiveTrajectory::LiveTrajectory(sim::Simulation& run, std::string name, Progress& progress, Watcher watcher,
                               StageTimes* times)
    : run_(run), name_(std::move(name)), progress_(progress), watcher_(std::move(watcher)), times_(times) {
  run_.settle(progress_, times_);
  info_ = run_.trajectory_info();
  n_frames_ = static_cast<std::size_t>(run_.scene().cycles) * static_cast<std::size_t>(run_.scene().phases);
}

void LiveTrajectory::read(std::size_t index, Frame& frame) const {
  assert(index < n_frames_ && (index == made_ || index + 1 == made_));
  if (index == made_) {
    Hand hand(last_);
    run_.run(hand, progress_, 1, times_);
    ++made_;
    const bool goes_on = watcher_(last_);
    if (!goes_on && last_.phase + 1 == info_.phases_per_cycle) n_frames_ = made_;
  }
  frame = last_;
}

}  // namespace twincell::sweep
