// Time means of the forces of a driven bed: their support is the weight, whatever the number of frames.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/observable/observable.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/column.hpp"
#include "tests/support/validation.hpp"
#include "trajectory/bed_forces.hpp"

namespace twincell::sim::force_means_test {
namespace {

constexpr int kBeads = 60;

MemoryTrajectory landing_bed(int phases, const std::string& samples, int cycles,
                             const std::string& steps = "20") {
  Simulation run(read_scene_text(
      fmt::format("[cell]\nwidth = 10.0\nheight = 60.0\n[beads]\ncount = {}\n[contact]\nk_n = 2e4\n"
                  "restitution = 0.5\ntangential = \"none\"\nmu = 0.0\n[drive]\ngamma = 2.0\nomega = 1.0\n"
                  "[start]\nkind = \"random\"\nseed = 1\n[time]\ndiscard = 5\ncycles = {}\nphases = {}\n"
                  "contacts = true\n{}steps_per_contact = {}\n",
                  kBeads, cycles, phases, samples, steps),
      "landing"));
  MemoryTrajectory t(run.trajectory_info());
  run.run(t);
  return t;
}

const analysis::Result& result(const std::vector<analysis::Result>& all, const char* name) {
  return analysis::find_result(all, name);
}

}  // namespace

// Smooth side walls carry no vertical force, so in a steady state the mean force of the floor is N m g.
TEST(ForceMeans, OfTheFloorOfADrivenBedIsTheWeight) {
  analysis::AnalysisOptions options;
  options.only = {"wall_force", "wall_force_low", "wall_force_high", "wall_support", "pressure"};
  double pressure = 0, worst_of_frames = 0;
  for (const int phases : {10, 20, 40}) {
    const MemoryTrajectory t = landing_bed(phases, "", 40);
    ASSERT_TRUE(t.info().columns.force_mean);
    const auto floor = static_cast<std::size_t>(
        std::find(t.info().walls.begin(), t.info().walls.end(), "bottom") - t.info().walls.begin());
    const auto all = analysis::analyze(t, options);
    const double low = result(all, "wall_force_low").values.at(floor),
                 high = result(all, "wall_force_high").values.at(floor);
    test::validate({"V2.30", fmt::format("mean force of the floor over N m g, {} phases", phases), 1, 0.1,
                    "momentum balance"},
                   result(all, "wall_force").values[floor] / kBeads);
    EXPECT_LT(low, kBeads);
    EXPECT_GT(high, kBeads);
    EXPECT_LT(high - low, 0.3 * kBeads);
    EXPECT_NEAR(result(all, "wall_support").value(), result(all, "wall_force").values[floor] / kBeads, 1e-9);
    // The same bed with other frames: the dynamics is that of the same steps.
    if (pressure == 0) pressure = result(all, "pressure").value();
    EXPECT_NEAR(result(all, "pressure").value() / pressure, 1, 0.1) << phases;
    ASSERT_TRUE(result(all, "pressure").interval);
    EXPECT_LT(result(all, "pressure").interval->low, pressure);
    EXPECT_GT(result(all, "pressure").interval->high, pressure);

    // Without the time means the same frames are aliased, and the analysis claims no interval.
    MemoryTrajectory frames(t.info());
    frames.info().columns.force_mean = false;
    for (Frame f : t.frames()) {
      f.force_mean = {};
      frames.append(f);
    }
    const auto aliased = analysis::analyze(frames, options);
    worst_of_frames = std::max(worst_of_frames, std::abs(result(aliased, "wall_support").value() - 1));
    for (const char* name : {"pressure", "wall_support"}) {
      EXPECT_FALSE(result(aliased, name).interval) << name;
      EXPECT_NE(result(aliased, name).convention.find("miss the landings"), std::string::npos) << name;
    }
  }
  EXPECT_GT(worst_of_frames, 0.2);  // the beds do land between the frames
}

// Samples at random steps between those of the temperature; frames at 2000 phases miss little of a landing.
TEST(ForceMeans, AreThoseOfDenseFrames) {
  constexpr int kEvery = 100;
  const MemoryTrajectory sparse = landing_bed(20, "samples = 2000\n", 5, "20.452"),
                         dense = landing_bed(20 * kEvery, "samples = 0\n", 5, "20.452");
  ASSERT_FALSE(dense.info().columns.force_mean);
  ASSERT_EQ(dense.frames()[kEvery].step, sparse.frames()[1].step);
  BedForces of_means = BedForces::zero(dense.info().walls.size()), of_frames = of_means;
  for (std::size_t f = 1; f < sparse.n_frames(); ++f) {
    ASSERT_TRUE(sparse.frames()[f].force_mean.known());
    of_means.add(sparse.frames()[f].force_mean, 1.0 / static_cast<double>(sparse.n_frames() - 1));
    for (std::size_t k = kEvery * (f - 1) + 1; k <= kEvery * f; ++k)
      of_frames.add(bed_forces(dense.frames()[k], dense.info()),
                    1.0 / static_cast<double>(kEvery * (sparse.n_frames() - 1)));
  }
  EXPECT_GT(of_frames.stress.trace(), 1);
  EXPECT_NEAR(of_means.stress.trace() / of_frames.stress.trace(), 1, 0.05);
  EXPECT_NEAR(of_means.kinetic.trace() / of_frames.kinetic.trace(), 1, 0.01);
  EXPECT_NEAR(of_means.in_contact, of_frames.in_contact, 0.02);
  EXPECT_NEAR(of_means.normal_force / of_frames.normal_force, 1, 0.05);
  for (std::size_t w = 0; w < of_frames.wall_force.size(); ++w)
    EXPECT_NEAR(of_means.wall_normal_force[w], of_frames.wall_normal_force[w], 0.05 * kBeads);
}

// In a column at rest every sample is the same.
TEST(ForceMeans, OfAColumnAtRestAreItsWeight) {
  const MemoryTrajectory t = column_at_rest(2);
  const Frame& last = t.frames().back();
  ASSERT_TRUE(last.force_mean.known());
  const BedForces now = bed_forces(last, t.info());
  for (std::size_t w = 0; w < t.info().walls.size(); ++w) {
    const double weight = t.info().walls[w] == "bottom" ? kColumnBeads : 0;
    EXPECT_NEAR(last.force_mean.wall_normal_force[w], weight, 1e-5);
    EXPECT_NEAR(last.force_mean.wall_force[w].z(), -weight, 1e-5);
  }
  EXPECT_LE((last.force_mean.stress - now.stress).norm(), 1e-5 * now.stress.norm());
  EXPECT_EQ(last.force_mean.in_contact, 1);
}

TEST(ForceMeans, AreStoredOnlyWithContacts) {
  const Simulation run(
      read_scene_text("preset = \"fortini-huang-2015\"\n[beads]\ncount = 40\n[drive]\ngamma = "
                      "1.5\n[time]\ndiscard = 0\ncycles = 1\n",
                      "s"));
  EXPECT_TRUE(run.trajectory_info().columns.time_mean);
  EXPECT_FALSE(run.trajectory_info().columns.force_mean);
}

}  // namespace twincell::sim::force_means_test
