// Beads that were located before: what a table must have, and what is read of it.
#include "imaging/track/located_table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "tests/support/complaint.hpp"

namespace twincell::imaging::located_table_test {
namespace {

Table table_of(const std::vector<std::string>& names, const std::vector<std::vector<double>>& columns) {
  return {.file = "beads.csv", .names = names, .columns = columns, .texts = {}, .marks = {}};
}

TEST(LocatedTable, FramesAreNumbersAndMayBeEmpty) {
  // Rows in any order; frame 4 has no bead.
  const LocatedTable all =
      read_located(table_of({"x", "frame", "y", "mass"}, {{7, 5, 6}, {5, 3, 3}, {70, 50, 60}, {1, 1, 1}}),
                   {.columns = {}, .diameter_px = 4, .picture = {}}, {});
  ASSERT_EQ(all.frames.size(), 3U);
  EXPECT_EQ(all.range.first, 3);
  EXPECT_EQ(all.frames.count(0), 2U);
  EXPECT_EQ(all.frames.count(1), 0U);
  EXPECT_EQ(all.frames[0][1].x_px, 6);
  EXPECT_EQ(all.frames[2][0].y_px, 70);
  EXPECT_EQ(all.frames[2][0].radius_px, 2);
  EXPECT_EQ(all.width_px, 10);  // 7 + 2 + half a pixel, rounded up
  EXPECT_EQ(all.height_px, 73);
  EXPECT_FALSE(all.has_errors);
  EXPECT_TRUE(std::isnan(all.frames[0][0].sigma_x_px));
}

TEST(LocatedTable, SizesErrorsAndTracersAreThoseOfTheTable) {
  const Table table =
      table_of({"t", "x", "y", "radius", "sigma_x", "sigma_y", "tracer"},
               {{0, 0, 0}, {1, 20, 40}, {1, 1, 1}, {4, 5, 6}, {0.1, 0.1, 0.2}, {0.2, 0.2, 0.2}, {0, 1, 0}});
  const LocatedTable all =
      read_located(table, {.columns = {{"frame", "t"}}, .diameter_px = {}, .picture = {}}, {});
  EXPECT_EQ(all.diameter_px, 10);
  EXPECT_TRUE(all.has_errors);
  EXPECT_EQ(all.frames[0][2].radius_px, 6);
  EXPECT_EQ(all.frames[0][2].sigma_x_px, 0.2);
  EXPECT_TRUE(all.frames[0][1].tracer);
  EXPECT_FALSE(all.frames[0][2].tracer);
}

TEST(LocatedTable, ErrorsThatAreNotUsedAreNamed) {
  const auto read = [](const std::vector<std::string>& names,
                       const std::vector<std::vector<double>>& columns) {
    return read_located(table_of(names, columns), {.columns = {}, .diameter_px = 10, .picture = {}}, {});
  };
  const LocatedTable one = read({"frame", "x", "y", "sigma_x"}, {{0, 0}, {1, 20}, {1, 1}, {0.1, 0.1}});
  EXPECT_FALSE(one.has_errors);
  ASSERT_EQ(one.doubts.size(), 1U);
  EXPECT_NE(one.doubts[0].find("the column sigma_x is not used, because there is no column sigma_y"),
            std::string::npos);
  const LocatedTable exact =
      read({"frame", "x", "y", "sigma_x", "sigma_y"}, {{0, 0}, {1, 20}, {1, 1}, {0, 0.1}, {0, 0.1}});
  ASSERT_EQ(exact.doubts.size(), 1U);
  EXPECT_NE(exact.doubts[0].find("1 row has a standard error of 0"), std::string::npos) << exact.doubts[0];
  EXPECT_TRUE(std::isnan(exact.frames[0][0].sigma_x_px));
  EXPECT_EQ(exact.frames[0][1].sigma_x_px, 0.1);
  EXPECT_TRUE(read({"frame", "x", "y", "sigma_x", "sigma_y"}, {{0}, {1}, {1}, {0.1}, {0.1}}).doubts.empty());
}

TEST(LocatedTable, ADiameterThatIsNotTwiceTheRadiusIsRefused) {
  const auto said = [](double diameter) {
    const Table table = table_of({"frame", "x", "y", "radius", "diameter"}, {{0}, {1}, {1}, {5}, {diameter}});
    return complaint_of([&] { (void)read_located(table, {}, {}); });
  };
  EXPECT_EQ(said(10), "");
  EXPECT_EQ(said(10.2), "") << "rounded";
  EXPECT_NE(
      said(5).find("diameter: row 1: the radius is 5 and the diameter 5, which is not twice the radius."),
      std::string::npos)
      << said(5);
}

TEST(LocatedTable, BeadsThatAreTooCloseForTheirSizeAreDoubtful) {
  const Table table =
      table_of({"frame", "x", "y"}, {{0, 0, 0, 0, 0, 0}, {0, 10, 20, 30, 40, 50}, {0, 0, 0, 0, 0, 0}});
  const auto doubt = [&](double diameter) {
    return read_located(table, {.columns = {}, .diameter_px = diameter, .picture = {}}, {}).spacing_doubt;
  };
  EXPECT_EQ(doubt(10), "");
  EXPECT_EQ(doubt(3), "");
  EXPECT_NE(doubt(20).find("the nearest neighbours in the first frame are 0.5 bead diameters of 20 px apart"),
            std::string::npos);
}

TEST(LocatedTable, BeadsThatAreListedTwiceAreDoubtful) {
  const Table table = table_of({"frame", "x", "y"},
                               {{0, 0, 0, 3, 3, 3, 3}, {0, 10, 20, 0, 10, 20, 12.5}, {0, 0, 0, 0, 0, 0, 1}});
  const LocatedTable all = read_located(table, {.columns = {}, .diameter_px = 10, .picture = {}}, {});
  EXPECT_EQ(all.spacing_doubt,
            "1 bead, the first in frame 3, lies closer than 0.3 diameters to another bead: are beads listed "
            "twice?");
}

TEST(LocatedTable, WhatIsNoTableOfBeadsIsNamed) {
  const auto said = [](const Table& table, LocatedTableOptions options = {}) {
    if (!options.diameter_px) options.diameter_px = 4;
    return complaint_of([&] { (void)read_located(table, options, {}); });
  };
  const std::vector<std::string> names = {"frame", "x", "y"};
  EXPECT_EQ(said(table_of(names, {{0}, {1}, {1}})), "");
  EXPECT_NE(said(table_of({"frame", "X", "y"}, {{0}, {1}, {1}}))
                .find("beads.csv: x: this column is missing; --columns x=NAME states another name. The "
                      "columns are: frame, "
                      "X, y."),
            std::string::npos);
  for (const double frame : {-1.0, 0.5, std::nan("")})
    EXPECT_NE(said(table_of(names, {{0, frame}, {1, 2}, {1, 2}})).find("frame: row 2: "), std::string::npos)
        << frame;
  EXPECT_NE(said(table_of(names, {{0, 2e7}, {1, 2}, {1, 2}})).find("more than 1e+07 frames after the first"),
            std::string::npos);
  EXPECT_NE(said(table_of(names, {{0, 200002}, {1, 2}, {1, 2}}))
                .find("the 200001 frames between 0 and 200002 contain no bead; check frame number 200002."),
            std::string::npos);
  EXPECT_NE(said(table_of(names, {{0, 1}, {1, std::nan("")}, {1, 2}}))
                .find("x: row 2: nan is not a valid position."),
            std::string::npos);
  EXPECT_NE(
      said(table_of(names, {{0, 1}, {1, 1}, {1, -1e7}})).find("y: row 2: -1e+07 is not a valid position."),
      std::string::npos);
  EXPECT_NE(
      said(table_of({"frame", "x", "y", "radius"}, {{0, 1}, {1, 1}, {1, 1}, {2, 0}}), {.diameter_px = {}})
          .find("radius: row 2: 0 is not a valid size of a bead."),
      std::string::npos);
  EXPECT_NE(
      said(table_of({"frame", "x", "y", "tracer"}, {{0}, {1}, {1}, {2}})).find("tracer: row 1: 2 is neither"),
      std::string::npos);
  EXPECT_NE(said(table_of({"frame", "x", "y", "sigma_x", "sigma_y"}, {{0}, {1}, {1}, {-1}, {1}}))
                .find("a standard error is negative"),
            std::string::npos);
  EXPECT_NE(said(table_of(names, {{0}, {1}, {1}}), {.columns = {{"colour", "x"}}})
                .find("there is no quantity 'colour'"),
            std::string::npos);
  EXPECT_NE(said(table_of(names, {{0, 0}, {1, 90}, {1, 2}}), {.picture = std::array{80, 60}})
                .find("x: row 2: the bead at 90, 2 is outside the picture of 80 x 60 px"),
            std::string::npos);
  EXPECT_NE(complaint_of([&] {
              (void)read_located(table_of(names, {{0}, {1}, {1}}), {}, {});
            }).find("beads.csv: has no column radius or diameter; state the bead diameter (--diameter, px)"),
            std::string::npos);
}

TEST(LocatedTable, BeadsOutsideTheCellAreSaidToBeOfATable) {
  CellDescription cell;
  cell.origin = PixelPoint{20, 200};
  cell.pixels_per_sigma = 10;
  cell.width = 10;
  const Table table = table_of({"frame", "x", "y"}, {{0, 0}, {300, 400}, {100, 100}});
  const std::string said = complaint_of([&] {
    (void)track_located(read_located(table, {.columns = {}, .diameter_px = 10, .picture = {}}, {}), {}, cell,
                        {}, {});
  });
  EXPECT_NE(said.find("none of the 2 located beads lies inside the cell of width 10"), std::string::npos)
      << said;
  EXPECT_NE(said.find("or write the table in px with y downwards"), std::string::npos) << said;
  EXPECT_EQ(said.find("--roi"), std::string::npos) << said;
}

// Rotation and distortion are about the centre of the picture, which a table does not tell.
TEST(LocatedTable, ATurnedCameraNeedsThePicture) {
  CellDescription cell;
  cell.rotation_deg = 1;
  const Table table = table_of({"frame", "x", "y"}, {{0, 1}, {1, 1}, {1, 1}});
  const auto tracked = [&](const LocatedTableOptions& options) {
    return track_located(read_located(table, options, {}), {}, cell, {}, {});
  };
  LocatedTableOptions options{.columns = {}, .diameter_px = 4, .picture = {}};
  expect_refusal<ConfigError>([&] { (void)tracked(options); }, "--picture-size: is needed");
  options.picture = {80, 60};
  const TrackedStack stack = tracked(options);
  EXPECT_EQ(stack.width_px, 80);
  EXPECT_EQ(stack.links.links, 1);
}

}  // namespace
}  // namespace twincell::imaging::located_table_test
