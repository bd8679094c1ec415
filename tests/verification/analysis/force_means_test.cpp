// Time means of the forces of a driven bed: their support is the weight, whatever the number of frames.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/observable/observable.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/validation.hpp"
#include "trajectory/bed_forces.hpp"

namespace twincell::sim {
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

TEST(ForceMeans, AreThoseOfDenseFrames) {
  const MemoryTrajectory sparse = landing_bed(20, "samples = 400\n", 2, "20.452"),
                         dense = landing_bed(400, "samples = 0\n", 2, "20.452");
  ASSERT_FALSE(dense.info().columns.force_mean);
  ASSERT_EQ(dense.frames()[20].step, sparse.frames()[1].step);
  double largest = 0;
  for (std::size_t f = 1; f < sparse.n_frames(); ++f) {
    BedForces sum = BedForces::zero(dense.info().walls.size());
    for (std::size_t k = 20 * f - 18; k <= 20 * f; k += 2)
      sum.add(bed_forces(dense.frames()[k], dense.info()), 1.0 / 10);
    const BedForces& mean = sparse.frames()[f].force_mean;
    ASSERT_TRUE(mean.known());
    largest = std::max(largest, mean.stress.norm());
    const double tolerance = 1e-5 * (1 + mean.stress.norm());  // frames keep forces in single precision
    EXPECT_LE((mean.stress - sum.stress).norm(), tolerance) << f;
    EXPECT_LE((mean.kinetic - sum.kinetic).norm(), 1e-12 * (1 + mean.kinetic.norm())) << f;
    for (std::size_t w = 0; w < sum.wall_force.size(); ++w) {
      EXPECT_LE((mean.wall_force[w] - sum.wall_force[w]).norm(), 1e-5 * (1 + sum.wall_force[w].norm()));
      EXPECT_NEAR(mean.wall_normal_force[w], sum.wall_normal_force[w],
                  1e-5 * (1 + std::abs(sum.wall_normal_force[w])));
    }
    EXPECT_NEAR(mean.in_contact, sum.in_contact, 1e-12);
    EXPECT_NEAR(mean.normal_force, sum.normal_force, 1e-5 * (1 + std::abs(sum.normal_force)));
    EXPECT_NEAR(mean.tangential_force, 0, 1e-12);
  }
  EXPECT_GT(largest, 1);
}

TEST(ForceMeans, AreStoredOnlyWithContacts) {
  const Simulation run(
      read_scene_text("preset = \"fortini-huang-2015\"\n[beads]\ncount = 40\n[drive]\ngamma = "
                      "1.5\n[time]\ndiscard = 0\ncycles = 1\n",
                      "s"));
  EXPECT_TRUE(run.trajectory_info().columns.time_mean);
  EXPECT_FALSE(run.trajectory_info().columns.force_mean);
}

}  // namespace twincell::sim
