// A long stack of known beads passes through phases, links and file: memory use stays constant, and the
// output reproduces the input.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "imaging/phase/phase_estimation.hpp"
#include "imaging/track/link_detections.hpp"
#include "imaging/track/write_trajectory.hpp"
#include "tests/support/temporary_folder.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::tracking_test {

using namespace imaging;

namespace {

constexpr int kPhases = 20;

double peak_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// Motion of the beads, and scatter of their positions in units of the stated errors.
struct Bounce {
  double gamma = 2;
  int phases = kPhases;
  double noise = 0;
};

/// Rows of ten bouncing beads; bead 3 is a tracer.
void fill(DetectionStore& store, int frames, int rows, const std::vector<int>& dropped,
          const std::vector<int>& doubled, const Bounce& bounce = {}) {
  const std::vector<double> bed = inelastic_bed(bounce.gamma, bounce.phases);
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  int tick = 0;
  for (int f = 0; f < frames; ++f) {
    if (f > 0 && std::find(doubled.begin(), doubled.end(), f) == doubled.end()) ++tick;
    tick += static_cast<int>(std::count(dropped.begin(), dropped.end(), f));
    std::vector<TrackedBead> beads;
    for (int i = 0; i < 10 * rows; ++i)
      beads.push_back({.x_px = 20.0 + 15 * (i % 10) + 7.5 * (i / 10 % 2),
                       .y_px = 600.0 - 13 * static_cast<int>(i / 10) -
                               15 * 1.5 * bed[static_cast<std::size_t>(tick % bounce.phases)],
                       .radius_px = 7.5,
                       .tracer = i == 3,
                       .sigma_x_px = 0.01 + 1e-4 * i,
                       .sigma_y_px = 0.02});
    for (TrackedBead& b : beads) {
      b.x_px += bounce.noise * b.sigma_x_px * normal(generator);
      b.y_px += bounce.noise * b.sigma_y_px * normal(generator);
    }
    store.append(beads);
  }
}

CellDescription cell() {
  CellDescription c;
  c.pixels_per_sigma = 15;
  c.origin = PixelPoint{12.5, 607.5};
  c.drive_spec = {
      .amplitude = 1.5, .omega = {}, .frequency = {}, .gamma = 2.0, .k_m = {}, .peak_velocity = {}};
  return c;
}

void track_to(const std::filesystem::path& path, const DetectionStore& store, const CellDescription& c,
              const PhaseSource& source, const std::filesystem::path& folder) {
  const TrackedStack stack{link_detections(store, {.diameter_px = 15}, c, source, folder), {}, 200, 640};
  const TrackPlan plan = plan_trajectory(stack, c, 15, 1);
  H5mdWriter writer(path, plan.info);
  write_trajectory(stack, plan, writer);
  writer.finish();
}

}  // namespace

TEST(Tracking, FoundPhasesUncertaintiesAndTracersAreInTheFile) {
  const TemporaryFolder folder;
  DetectionStore store(folder / "");
  fill(store, 300, 12, {101}, {202});
  track_to(folder / "t.h5", store, cell(), {.method = PhaseMethod::found}, folder / "");
  EXPECT_TRUE(validate_h5md(folder / "t.h5").empty());
  const H5mdReader reader(folder / "t.h5");
  EXPECT_EQ(reader.n_frames(), 299U) << "a frame taken twice is written once";
  EXPECT_EQ(reader.info().n_beads, 120U);
  EXPECT_EQ(reader.info().phases_per_cycle, kPhases);
  const auto said = nlohmann::json::parse(reader.info().tracking_json);
  EXPECT_EQ(said["phase_lock"]["method"], "found");
  EXPECT_EQ(said["phase_lock"]["dropped"], 1);
  EXPECT_EQ(said["phase_lock"]["doubled"], 1);
  EXPECT_EQ(said["links"]["made"], 120 * 299);
  EXPECT_EQ(said["links"]["ambiguous"], 0);
  EXPECT_EQ(said["tracers"]["count"], 1);
  EXPECT_TRUE(said["tracers"]["broken"].empty());
  EXPECT_TRUE(said["tracers"]["uncertain"].empty());
  Frame frame;
  int off_phase = 0;
  for (std::size_t f = 0; f < reader.n_frames(); ++f) {
    reader.read(f, frame);
    // Frames 0 to 100, then one missing frame, then one duplicated frame, which is left out.
    const auto tick = static_cast<int>(f < 101 ? f : f + 1);
    off_phase += frame.phase != tick % kPhases || frame.cycle != tick / kPhases ? 1 : 0;
    for (std::size_t i = 0; i < 120; ++i) {
      ASSERT_NEAR(frame.position_sigma[i].x() * 15, 0.01 + 1e-4 * static_cast<double>(i), 1e-12);
      ASSERT_NEAR(frame.position_sigma[i].z() * 15, 0.02, 1e-12);
      ASSERT_TRUE(std::isnan(frame.position_sigma[i].y())) << "the camera does not see depth";
    }
  }
  EXPECT_LE(off_phase, 4) << "a slip may be placed a frame early or late";
}

// The mean step alone does not find the duplicated frame at all of these forty positions.
TEST(Tracking, AFrameTakenTwiceIsFoundWhereverItIs) {
  constexpr int kMany = 40;
  int found = 0;
  for (int at = 2 * kMany; at < 3 * kMany; ++at) {
    const TemporaryFolder folder;
    DetectionStore store(folder / "");
    fill(store, 4 * kMany, 12, {}, {at}, {.gamma = 1.5, .phases = kMany, .noise = 1});
    const LinkedDetections stack =
        link_detections(store, {.diameter_px = 15}, cell(), {.method = PhaseMethod::found}, folder / "");
    const PhaseTable& p = stack.phases;
    found += p.doubled == 1 && p.dropped == 0 && p.frames.at(static_cast<std::size_t>(at)).interval == 0;
  }
  std::cout << found << " of " << kMany << " found in their places\n";
  EXPECT_EQ(found, kMany);
}

TEST(Tracking, ATracerThatIsLostIsNamed) {
  const TemporaryFolder folder;
  DetectionStore store(folder / "");
  for (int f = 0; f < 40; ++f) {
    std::vector<TrackedBead> beads = {{.x_px = 10, .y_px = 10, .radius_px = 7, .tracer = true}};
    if (f < 20) beads.push_back({.x_px = 60, .y_px = 10, .radius_px = 7, .tracer = true});
    store.append(beads);
  }
  const LinkedDetections stack = link_detections(store, {.diameter_px = 15}, {}, {}, folder / "");
  EXPECT_EQ(stack.broken_tracers(), (std::vector<std::int64_t>{1}));
  EXPECT_EQ(stack.tracks[1].last, 19);
}

TEST(Tracking, MemoryDoesNotGrowWithTheStack) {
  const TemporaryFolder folder;
  CellDescription c = cell();
  c.phase_lock.frames_per_cycle = kPhases;
  auto run = [&](int frames) {
    DetectionStore store(folder / "");
    fill(store, frames, 30, {}, {});
    track_to(folder / "long.h5", store, c, {}, folder / "");
    return peak_mib();
  };
  const double brief = run(200), lengthy = run(4000);
  std::cout << "peak " << brief << " MiB after 200 frames, " << lengthy << " MiB after 4000\n";
  // The beads of 3800 more frames would take 73 MiB in memory.
  EXPECT_LE(lengthy - brief, 8);
}

}  // namespace twincell::tracking_test
