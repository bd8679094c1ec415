// A request to stop ends the analysis within a frame: the loops over its beads ask.
#include "core/cancellation.hpp"

#include <gtest/gtest.h>

#include <csignal>

#include "analysis/neighbours/neighbours.hpp"
#include "analysis/neighbours/voronoi.hpp"
#include "analysis/observable/observable.hpp"
#include "core/error.hpp"
#include "trajectory/spacing.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::analysis::cancellation_test {
namespace {

class Cancellation : public ::testing::Test {
 protected:
  Cancellation() {
    frame_.position = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 1)};
    box_.upper = Vec3(10, 1, 10);
    request_cancellation(SIGINT);
  }
  ~Cancellation() override { withdraw_cancellation(); }

  Frame frame_;
  Box box_;
};

TEST_F(Cancellation, StopsTheSearchesOfAFrame) {
  EXPECT_THROW((void)find_neighbours(frame_, box_, 1.5), Interrupted);
  EXPECT_THROW((void)voronoi_cells(frame_, box_), Interrupted);
  EXPECT_THROW((void)listed_again(frame_.position, 0.1), Interrupted);
}

/// Frames before phase 0; the request comes while they are read.
class LateFrames : public TrajectorySource {
 public:
  LateFrames() {
    info_.n_beads = 3;
    info_.columns.phase = true;
    info_.phases_per_cycle = 1000;
    info_.box.upper = Vec3(10, 1, 10);
  }
  [[nodiscard]] const TrajectoryInfo& info() const override { return info_; }
  [[nodiscard]] std::size_t n_frames() const override { return 100; }
  void read(std::size_t index, Frame& frame) const override {
    frame.position = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 1)};
    frame.phase = static_cast<int>(index) + 1;
    ++reads;
  }
  [[nodiscard]] std::string name() const override { return "late frames"; }
  mutable std::size_t reads = 0;

 private:
  TrajectoryInfo info_;
};

TEST_F(Cancellation, StopsTheSearchForTheFirstFrameAtPhaseZero) {
  const LateFrames frames;
  EXPECT_THROW((void)analyze(frames), Interrupted);
  EXPECT_EQ(frames.reads, 1U);
}

}  // namespace
}  // namespace twincell::analysis::cancellation_test
