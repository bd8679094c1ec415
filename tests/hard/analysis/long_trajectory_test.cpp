// The analysis of a long film needs no more memory than its results.
#include <gtest/gtest.h>
#include <malloc.h>

#include <cmath>

#include "analysis/observable/observable.hpp"
#include "analysis/observable/results.hpp"

namespace twincell::long_trajectory_test {

using namespace analysis;

namespace {

/// Beads that fluctuate about fixed positions. The source generates each frame on demand and stores none.
class Endless : public TrajectorySource {
 public:
  explicit Endless(std::size_t cycles) : cycles_(cycles) {
    info_.n_beads = 300;
    info_.columns.phase = info_.columns.velocity = true;
    info_.box.upper = Vec3(10, 1, 60);
    info_.drive = Drive{Axis::z, 1.2, 1};
    info_.phases_per_cycle = 20;
    info_.source = Origin::simulation;
  }
  [[nodiscard]] const TrajectoryInfo& info() const override { return info_; }
  [[nodiscard]] std::size_t n_frames() const override { return cycles_ * 20; }
  [[nodiscard]] std::string name() const override { return "endless"; }
  void read(std::size_t index, Frame& frame) const override {
    frame = Frame{};
    frame.step = static_cast<std::int64_t>(index);
    frame.cycle = static_cast<std::int64_t>(index / 20);
    frame.phase = static_cast<std::int32_t>(index % 20);
    for (std::size_t i = 0; i < info_.n_beads; ++i) {
      const double jitter = 0.2 * std::sin(static_cast<double>(i * 7 + index * 13));
      frame.position.emplace_back(0.5 + static_cast<double>(i % 10), 0,
                                  0.5 + static_cast<double>(i / 10) + jitter);
      frame.velocity.emplace_back(jitter, 0, -jitter);
    }
    // Records the memory in use while frames are read, not the memory left at the end.
    most_ = std::max(most_, mallinfo2().uordblks);
  }
  [[nodiscard]] std::size_t most() const { return most_; }

 private:
  TrajectoryInfo info_;
  std::size_t cycles_;
  mutable std::size_t most_ = 0;
};

}  // namespace

TEST(LongTrajectory, MemoryGrowsByThePerCycleSeriesOnly) {
  AnalysisOptions options;
  options.only = {"s_b", "s_c", "drift", "p_s", "T_g", "T_z_field", "tracer_heights"};
  const Endless brief(20), lasting(400);
  analyze(brief, options);
  const auto results = analyze(lasting, options);
  const std::size_t tracers = find_result(results, "tracer_heights").shape[1];
  // Allowance for 380 more cycles, each with a height per tracer, a cycle number, a slip fraction and its
  // directions, and averages stored in full below 4096 values. A growing vector holds its old and its doubled
  // buffer at once.
  const double per_cycle = 3 * 8.0 * (static_cast<double>(tracers) + 2 + 4 + 12);
  const auto grown = static_cast<double>(lasting.most()) - static_cast<double>(brief.most());
  const double frames = 380.0 * 20 * 300 * 48;
  std::cout << "380 more cycles took " << grown / 1024 << " KiB; per-cycle series " << 380 * per_cycle / 1024
            << " KiB; the frames themselves " << frames / 1048576 << " MiB\n";
  EXPECT_LT(grown, 380 * per_cycle + 16384);
}

}  // namespace twincell::long_trajectory_test
