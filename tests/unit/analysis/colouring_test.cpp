// Numbers by which beads are coloured, against closed forms.

#include "analysis/colouring/colouring.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.hpp"

namespace twincell::analysis::colouring_test {
namespace {

/// Hexagonal flower of 7 touching beads, two frames one cycle apart; all beads move by (0.3, 0, 0.4).
MemoryTrajectory flower() {
  TrajectoryInfo info;
  info.n_beads = 7;
  info.box.lower = Vec3(-5, 0, -5);
  info.box.upper = Vec3(5, 1, 5);
  info.columns = {.velocity = true, .spin = true, .phase = true, .contact_forces = true};
  info.phases_per_cycle = 1;
  info.radius.assign(7, 0.5);
  MemoryTrajectory trajectory(info);
  for (int f = 0; f < 2; ++f) {
    Frame frame;
    frame.step = f, frame.cycle = f, frame.phase = 0;
    const Vec3 shift = f * Vec3(0.3, 0, 0.4);
    frame.position.push_back(shift);
    for (int k = 0; k < 6; ++k)
      frame.position.push_back(shift + Vec3(std::cos(k * M_PI / 3), 0, std::sin(k * M_PI / 3)));
    frame.velocity.assign(7, Vec3(3, 0, -4));
    frame.spin.assign(7, Vec3(0, -2, 0));
    frame.contact_forces = {{.i = 0, .j = 1, .normal = Vec3(-1, 0, 0), .normal_force = 2},
                            {.i = 0, .j = -1, .normal = Vec3(0, 0, 1), .normal_force = 5}};
    trajectory.append(frame);
  }
  return trajectory;
}

std::vector<double> numbers(const std::string& word, const MemoryTrajectory& t, std::size_t index = 1) {
  return colouring_named(word, t, "--colour").of({.source = t, .index = index, .frame = t.frames()[index]});
}

TEST(Colouring, NumbersAreThoseOfTheFrame) {
  const MemoryTrajectory t = flower();
  EXPECT_DOUBLE_EQ(numbers("speed", t)[3], 5);
  EXPECT_DOUBLE_EQ(numbers("vx", t)[3], 3);
  EXPECT_DOUBLE_EQ(numbers("vz", t)[3], -4);
  EXPECT_DOUBLE_EQ(numbers("spin", t)[3], 2);
  EXPECT_DOUBLE_EQ(numbers("radius", t)[3], 0.5);
  EXPECT_NEAR(numbers("q6", t)[0], 0.74083, 1e-5);
  EXPECT_NEAR(numbers("psi6", t)[0], 1, 1e-12);
  EXPECT_DOUBLE_EQ(numbers("force", t)[0], 7);
  EXPECT_DOUBLE_EQ(numbers("force", t)[1], 2);
  EXPECT_DOUBLE_EQ(numbers("force", t)[2], 0);
  EXPECT_NEAR(numbers("cycle-displacement", t)[6], 0.5, 1e-12);
  EXPECT_NEAR(numbers("height", t)[2], 0.4 + std::sqrt(0.75), 1e-12);
  EXPECT_DOUBLE_EQ(numbers("contacts", t)[0], 2);
  EXPECT_DOUBLE_EQ(numbers("contacts", t)[1], 1);
  EXPECT_DOUBLE_EQ(numbers("contacts", t)[2], 0);
  EXPECT_TRUE(std::isnan(numbers("cycle-displacement", t, 0)[6]));
}

TEST(Colouring, EveryWordOfTheTableNeedsItsData) {
  MemoryTrajectory bare = flower();
  bare.info().columns = {};
  bare.info().radius.clear();
  bare.info().box.dimension = 3;
  for (const Colouring& colouring : colourings()) {
    const std::string word = colouring.word;
    MemoryTrajectory whole = flower();
    if (word == "vy") whole.info().box.dimension = 3;
    EXPECT_EQ(numbers(word, whole).size(), 7U) << word;
    if (word == "height") continue;  // of positions alone
    EXPECT_THROW(colouring_named(word, bare, "--colour"), ConfigError) << word;
  }
  EXPECT_THROW(colouring_named("sped", bare, "--colour"), ConfigError);
}

}  // namespace
}  // namespace twincell::analysis::colouring_test
