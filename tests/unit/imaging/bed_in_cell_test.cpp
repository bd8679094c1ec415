// Gaps between the beads of a film and the stated cell.

#include "imaging/track/bed_in_cell.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "trajectory/trajectory.hpp"

namespace twincell::imaging::bed_in_cell_test {
namespace {

/// What is said of a bed 10 beads wide and 4 high that rests on its plate in half of each cycle, if the cell
/// is stated to be so wide and begins so far left and below.
std::string said(double width, double left = 0, double low = 0, double origin_row = 200, int layers = 4,
                 std::string* contradiction = nullptr, int width_px = 300) {
  CellDescription cell;
  cell.origin = PixelPoint{20, origin_row};
  cell.pixels_per_sigma = 12;
  cell.width = width;
  TrajectoryInfo info;
  info.n_beads = static_cast<std::size_t>(10 * layers);
  info.columns.plate_height = true;
  info.box.boundary[0] = Boundary::wall;
  MemoryTrajectory out(info);
  BedInCell watched(out, info, cell, width_px, 240);
  for (int f = 0; f < 40; ++f) {
    Frame frame;
    frame.step = f;
    frame.plate_height = 0.5 * std::sin(0.3 * f);
    const double flight = f % 20 < 10 ? 0 : 0.4;
    for (int i = 0; i < 10 * layers; ++i)
      frame.position.emplace_back(0.5 + i % 10 + left, 0, 0.5 + i / 10 + flight + frame.plate_height + low);
    watched.append(frame);
  }
  EXPECT_EQ(out.n_frames(), 40U);
  std::string all;
  for (const std::string& doubt : watched.doubts()) all += doubt + "\n";
  if (contradiction != nullptr) *contradiction = watched.contradiction();
  return all;
}

TEST(BedInCell, ABedThatFillsItsCellRaisesNoDoubt) {
  EXPECT_EQ(said(10), "");
  EXPECT_EQ(said(10.3), "");
  EXPECT_EQ(said(10, 0.3), "");
  EXPECT_EQ(said(10, 0, 0.3), "");
}

TEST(BedInCell, WallsThatNoBeadTouchesAreDoubtful) {
  EXPECT_NE(said(11).find("the beads come no closer to the right wall than 1.00 bead diameters"),
            std::string::npos);
  EXPECT_NE(said(11, 1).find("no closer to the left wall than 1.00"), std::string::npos);
  EXPECT_NE(said(9.5).find("the beads reach 0.50 bead diameters into the right wall"), std::string::npos);
  EXPECT_EQ(said(11, 0, 0, 200, 1), "") << "a single layer need not reach the walls";
}

// A width of 100 in place of 10, as by a wrong power of ten: the wall is not in the picture, and the bed ends
// within it. A picture of the middle of a wide cell cuts its bed.
TEST(BedInCell, AWallOutsideThePictureIsDoubtfulWhereTheBedEndsInIt) {
  EXPECT_NE(said(100).find("no closer to the right wall than 90.00"), std::string::npos) << said(100);
  std::string contradiction;
  EXPECT_EQ(said(100, 0, 0, 200, 4, &contradiction, 20 + 124), "");
  EXPECT_EQ(contradiction, "");
}

TEST(BedInCell, PeriodicSidesAtWhichTheBedStopsAreDoubtful) {
  const auto said_of = [](double across, int layers) {
    CellDescription cell;
    cell.origin = PixelPoint{20, 200};
    cell.pixels_per_sigma = 12;
    cell.width = 10;
    TrajectoryInfo info;
    info.n_beads = static_cast<std::size_t>(10 * layers);
    info.box.boundary[0] = Boundary::periodic;
    MemoryTrajectory out(info);
    BedInCell watched(out, info, cell, 300, 240);
    for (int f = 0; f < 40; ++f) {
      Frame frame;
      frame.step = f;
      for (int i = 0; i < 10 * layers; ++i)  // every other row is shifted
        frame.position.emplace_back(std::fmod(0.5 + i % 10 + across * (i / 10 % 2), 10), 0, 0.5 + i / 10);
      watched.append(frame);
    }
    std::string all;
    for (const std::string& doubt : watched.doubts()) all += doubt + "\n";
    return all;
  };
  EXPECT_NE(said_of(0.1, 5).find("stop at the periodic sides of the cell as at walls"), std::string::npos);
  EXPECT_EQ(said_of(0.5, 5), "");
  EXPECT_EQ(said_of(0.1, 3), "") << "of few layers, none may lie across";
}

TEST(BedInCell, ABedOfLayersABeadAwayContradictsTheCell) {
  const auto contradiction = [](double width, double left, double low, int layers = 4) {
    std::string found;
    (void)said(width, left, low, 200, layers, &found);
    return found;
  };
  EXPECT_EQ(contradiction(10, 0, 0), "");
  EXPECT_EQ(contradiction(10.9, 0, 0), "") << "doubtful, but possible";
  EXPECT_NE(contradiction(11.2, 0, 0).find("right wall than 1.20 bead diameters"), std::string::npos);
  EXPECT_NE(contradiction(8.8, 0, 0).find("1.20 bead diameters into the right wall"), std::string::npos);
  EXPECT_NE(contradiction(10, 0, 2.85).find("or the picture is upside down"), std::string::npos);
  EXPECT_NE(contradiction(10, 0, -1.5).find("beneath the plate"), std::string::npos);
  EXPECT_EQ(contradiction(10, 0, 2.85, 1), "") << "a few beads may fly";
}

TEST(BedInCell, APlateOnWhichTheBedDoesNotRestIsDoubtful) {
  EXPECT_NE(said(10, 0, 0.75).find("the lowest bead comes no closer to the plate than 0.75"),
            std::string::npos);
  EXPECT_NE(said(10, 0, -0.6).find("beads are up to 0.60 bead diameters beneath the plate"),
            std::string::npos);
  EXPECT_EQ(said(10, 0, 0.75, 300), "") << "the plate is below the picture";
}

}  // namespace
}  // namespace twincell::imaging::bed_in_cell_test
