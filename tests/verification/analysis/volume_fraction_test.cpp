// Volume fractions, and the volume mean of the temperature, of beds whose values can be counted by hand.
#include "analysis/gas/volume_fraction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/validation.hpp"

namespace twincell::volume_fraction_test {

using namespace analysis;

namespace {

MemoryTrajectory two_rows(int dimension) {
  TrajectoryInfo info;
  info.n_beads = 20;
  info.columns.velocity = info.columns.phase = true;
  info.phases_per_cycle = 1;
  info.box.dimension = dimension;
  info.box.upper = Vec3(10, 2, 50);
  MemoryTrajectory trajectory(info);
  for (int j = 0; j < 40; ++j) {
    Frame frame;
    frame.cycle = j;
    frame.phase = 0;
    for (int i = 0; i < 20; ++i) {
      const bool upper = i >= 15;
      frame.position.emplace_back(i % 10 + 0.5, 1, upper ? 3.5 : 0.5);
      // m <w'^2> is 1 below and 9 above, about slab means of 0.
      frame.velocity.emplace_back(0, 0, ((i + j) % 2 == 0 ? 1 : -1) * (upper ? 3 : 1));
    }
    trajectory.append(frame);
  }
  return trajectory;
}

}  // namespace

TEST(VolumeFraction, OfTwoRowsUpToTheTopAndToTwiceTheCentre) {
  for (const int dimension : {2, 3}) {
    const auto results = analyze(two_rows(dimension), {.only = {"phi_top", "phi_cm", "T_z_volume"}});
    const double beads = dimension == 2 ? 20 * std::numbers::pi / 4 / 10 : 20 * std::numbers::pi / 6 / 20;
    const std::string of = " of two rows, " + std::to_string(dimension) + "D";
    test::validate({"V5.16", "volume fraction up to the highest bead" + of, beads / 4, 1e-12, "closed form"},
                   find_result(results, "phi_top").value());
    test::validate(
        {"V5.16", "volume fraction up to twice the centre of mass" + of, beads / 2.5, 1e-12, "closed form"},
        find_result(results, "phi_cm").value());
    // The mean over beads would be 3: three of four beads are in the cold slab.
    test::validate({"V5.16", "mean over volume of T_z(z)" + of, 5, 1e-12, "closed form"},
                   find_result(results, "T_z_volume").value());
  }
}

TEST(VolumeFraction, OfABedThatSinksWithThePlateIsAbsent) {
  TrajectoryInfo info;
  info.n_beads = 10;
  info.box.upper = Vec3(10, 1, 10);
  MemoryTrajectory bed(info);
  for (const double plate : {0.0, -0.9}) {
    Frame frame;
    for (int i = 0; i < 10; ++i) frame.position.emplace_back(i + 0.5, 0, plate + 0.5);
    bed.append(frame);
  }
  const auto results = analyze(bed, {.only = {"phi_top"}});
  EXPECT_NE(find_result(results, "phi_top").absent.find("moves with the plate"), std::string::npos);
}

TEST(VolumeFraction, OfNoBeadsIsAbsent) {
  TrajectoryInfo info;
  info.box.upper = Vec3(10, 1, 10);
  MemoryTrajectory empty(info);
  empty.append(Frame{});
  const auto results = analyze(empty, {.only = {"phi_top", "T_z_volume"}});
  EXPECT_FALSE(find_result(results, "phi_top").present());
  EXPECT_FALSE(find_result(results, "T_z_volume").present());
}

}  // namespace twincell::volume_fraction_test
