#include "analysis/motion/tracers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "analysis/runs/match_verdict.hpp"
#include "analysis/runs/phase_diagram.hpp"
#include "tests/support/rigid_bed.hpp"

namespace twincell::tracers_test {

using namespace analysis;

TEST(Tracers, OfACrystalAreTheMiddleRow) {
  const MemoryTrajectory bed = test::rigid_bed({.gamma = 1.5, .columns = 20, .rows = 11});
  Frame first = bed.frames().front();
  const TracerChoice choice = choose_tracers(bed.info(), first);
  ASSERT_EQ(choice.slots.size(), 19U);  // the sixth of 11 rows has one bead fewer
  for (const std::size_t i : choice.slots)
    EXPECT_NEAR(first.position[i].z(), 0.5 + 5 * std::sqrt(3.0) / 2, 1e-12);
  first.position.back().z() = 90;  // a single bead high above the bed does not shift the middle
  EXPECT_EQ(choose_tracers(bed.info(), first).slots, choice.slots);
  std::mt19937_64 generator(1);
  std::normal_distribution<double> noise(0, 0.03);
  for (Vec3& r : first.position) r += Vec3(noise(generator), 0, noise(generator));
  EXPECT_EQ(choose_tracers(bed.info(), first).slots, choice.slots);  // with the position noise of a camera
}

TEST(Tracers, OfARandomBedAreOnePerColumnNearMidHeight) {
  TrajectoryInfo info;
  info.box.upper = Vec3(20, 1, 40);
  Frame frame;
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> x(0, 20), z(0, 20);
  for (int i = 0; i < 400; ++i) frame.position.emplace_back(x(generator), 0, z(generator));
  const TracerChoice choice = choose_tracers(info, frame);
  ASSERT_EQ(choice.slots.size(), 20U);
  double bottom = 1e9, sum = 0;
  for (const Vec3& r : frame.position) bottom = std::min(bottom, r.z());
  for (std::size_t c = 0; c < choice.slots.size(); ++c) {
    EXPECT_EQ(std::floor(frame.position[choice.slots[c]].x()), static_cast<double>(c));
    sum += frame.position[choice.slots[c]].z();
  }
  EXPECT_NEAR(sum / 20, (bottom + 19.8) / 2, 0.5);
}

TEST(Tracers, WholePeriodsChangeNothing) {
  TrajectoryInfo info;
  info.box.upper = Vec3(20, 1, 40);
  info.box.boundary[0] = Boundary::periodic;
  Frame frame;
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> x(0, 20), z(0, 20);
  std::uniform_int_distribution<int> turns(-1, 1);
  for (int i = 0; i < 400; ++i) frame.position.emplace_back(x(generator), 0, z(generator));
  const std::vector<std::size_t> slots = choose_tracers(info, frame).slots;
  EXPECT_EQ(slots.size(), 20U);
  for (Vec3& r : frame.position) r.x() += 20 * turns(generator);
  EXPECT_EQ(choose_tracers(info, frame).slots, slots);
}

TEST(Tracers, MarkedOnesAreTaken) {
  MemoryTrajectory bed = test::rigid_bed({.gamma = 1.5});
  bed.info().tracer.assign(bed.info().n_beads, 0);
  bed.info().tracer[3] = bed.info().tracer[17] = 1;
  EXPECT_EQ(choose_tracers(bed.info(), bed.frames().front()).slots, (std::vector<std::size_t>{3, 17}));
}

TEST(Tracers, UnsetMarksAreIgnored) {
  MemoryTrajectory bed = test::rigid_bed({.gamma = 1.5, .columns = 20, .rows = 11});
  const std::vector<std::size_t> line = choose_tracers(bed.info(), bed.frames().front()).slots;
  bed.info().tracer.assign(bed.info().n_beads, 0);
  EXPECT_EQ(choose_tracers(bed.info(), bed.frames().front()).slots, line);
}

TEST(Tracers, GivenByIdOrByBand) {
  const MemoryTrajectory bed = test::rigid_bed({.gamma = 1.5, .columns = 20, .rows = 11});
  const Frame& first = bed.frames().front();
  EXPECT_EQ(choose_tracers(bed.info(), first, {{17, 3}, {}}).slots, (std::vector<std::size_t>{3, 17}));
  const TracerChoice band = choose_tracers(bed.info(), first, {{}, {{0, 1.5}}});
  EXPECT_EQ(band.slots.size(), 39U);  // the two lowest rows
  EXPECT_NE(band.how.find("39 beads"), std::string::npos);
  const auto refusal = [&](const TracerWish& wish) -> std::string {
    try {
      choose_tracers(bed.info(), first, wish);
    } catch (const ConfigError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(refusal({{3, 9999}, {}}).find("9999"), std::string::npos);
  EXPECT_NE(refusal({{3, 3}, {}}).find("twice"), std::string::npos);
  EXPECT_NE(refusal({{}, {{50, 60}}}).find("reaches from 0.5"), std::string::npos);
  EXPECT_NE(refusal({{}, {{2, 1}}}).find("not a band"), std::string::npos);
  EXPECT_FALSE(refusal({{3}, {{1, 2}}}).empty());
}

TEST(MatchRuns, ByGammaWithinTheToleranceAndByLayers) {
  const auto run = [](Side side, double gamma, double n_l, BedPhase phase) {
    twincell::analysis::Run r;
    r.side = side;
    r.gamma = gamma;
    r.n_l = n_l;
    r.phase = phase;
    return r;
  };
  const std::vector<twincell::analysis::Run> runs = {run(Side::experiment, 1.51, 20, BedPhase::bouncing),
                                                     run(Side::simulation, 1.50, 20, BedPhase::bouncing),
                                                     run(Side::simulation, 1.50, 20, BedPhase::convecting),
                                                     run(Side::simulation, 1.50, 40, BedPhase::bouncing),
                                                     run(Side::experiment, 1.20, 20, BedPhase::co_moving),
                                                     run(Side::simulation, 1.54, 20, BedPhase::bouncing)};
  const auto matches = match_runs(runs, 0.02);
  ASSERT_EQ(matches.size(), 4U);
  EXPECT_EQ(matches[0].experiments, std::vector<std::size_t>{4});
  EXPECT_EQ(verdict_word(runs, matches[0]), "only experiment");
  EXPECT_EQ(matches[1].simulations, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(matches[1].experiments, std::vector<std::size_t>{0});
  EXPECT_EQ(verdict_word(runs, matches[1]), "undetermined");       // the two seeds disagree
  EXPECT_EQ(matches[2].simulations, std::vector<std::size_t>{3});  // different number of layers
  EXPECT_EQ(matches[3].simulations, std::vector<std::size_t>{5});  // differs by 2.7 %
}

}  // namespace twincell::tracers_test
