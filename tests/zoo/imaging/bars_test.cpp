// Beads in a cell whose walls and plate are straight bars with light behind them (straight_bars.hpp).

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "imaging/benchmark/score.hpp"
#include "imaging/cell/cell_edges.hpp"
#include "imaging/cell/plate_row.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/preprocess/straight_bars.hpp"
#include "tests/zoo/imaging/kinds.hpp"

namespace twincell::zoo::bars_test {
namespace {

/// A bar from a to b.
struct Bar {
  cv::Point2d a, b;
  double thickness;
  bool round;  // ends

  [[nodiscard]] bool contains(double x, double y) const {
    const cv::Point2d axis = b - a, from = cv::Point2d(x, y) - a;
    const double length = std::hypot(axis.x, axis.y), along = from.dot(axis) / length,
                 across = (from.x * axis.y - from.y * axis.x) / length;
    const double beyond = std::max({-along, along - length, 0.0});
    return round ? std::hypot(beyond, across) < 0.5 * thickness
                 : beyond == 0 && std::abs(across) < 0.5 * thickness;
  }
};

struct Cell {
  double diameter = 22, thickness = 12, tilt_degrees = 0, plate_px = 0;
  bool round = false, bright = false;
  bool through_border = false;  // walls run out of the picture, below
  bool one_frame = false;       // the plate joins the walls, which end at its lower side
  double light = kLight, dark = 20;
};

struct Scene {
  std::vector<Bar> bars;
  Exhibit exhibit;
};

/// Two walls and a plate. Beads touch them: a column along either wall, rows on the plate, some above.
Scene scene_of(const Cell& cell) {
  const double d = cell.diameter, t = cell.thickness, margin = 26;
  constexpr int kColumns = 8, kRows = 5;
  const double width = kColumns * d + 0.5, left = margin + t;
  const int side = static_cast<int>(width + 2 * (t + margin));
  const double plate = side - margin - t - 6 - cell.plate_px;
  const double angle = cell.tilt_degrees * std::numbers::pi / 180, middle = 0.5 * side;
  const auto turned = [&](double x, double y) {
    return cv::Point2d(middle + (x - middle) * std::cos(angle) - (y - middle) * std::sin(angle),
                       middle + (x - middle) * std::sin(angle) + (y - middle) * std::cos(angle));
  };
  const double cap = cell.round ? 0.5 * t : 0;
  Scene scene;
  const double foot = cell.through_border ? side + t : cell.one_frame ? plate + t : side - 12 - cap;
  for (const double x : {left - 0.5 * t, left + width + 0.5 * t})
    scene.bars.push_back({turned(x, 14 + cap), turned(x, foot), t, cell.round});
  const double inset = cell.one_frame ? -t : 1 + cap;
  scene.bars.push_back(
      {turned(left + inset, plate + 0.5 * t), turned(left + width - inset, plate + 0.5 * t), t, cell.round});
  Places places;
  for (int row = 0; row < kRows; ++row)
    for (int k = 0; k < kColumns; ++k) {
      if (row > 2 && (k + row) % 3 == 0 && k > 0 && k + 1 < kColumns) continue;
      const double x = k + 1 == kColumns ? left + width - d / 2 : left + d / 2 + k * d;
      const cv::Point2d at = turned(x, plate - d / 2 - row * d);
      places.push_back({at.x, at.y, d / 2});
    }
  Painter canvas(side, cell.light);
  canvas.everywhere([&](double x, double y, double below) {
    for (const Bar& bar : scene.bars)
      if (bar.contains(x, y)) return cell.dark;
    return below;
  });
  for (const Place& p : places)
    canvas.disc(p.x, p.y, p.radius, [&](double, double, double) { return cell.dark; });
  scene.exhibit = {canvas.exposed(kBlur, kNoise, 3), truth_of(places)};
  return scene;
}

class Bars : public testing::TestWithParam<double> {};

TEST_P(Bars, BeadsThatTouchThemAreAllFound) {
  for (const double tilt : {0.0, 1.0, 2.0})
    for (const bool round : {false, true})
      for (const bool bright : {false, true}) {
        Cell cell{.thickness = GetParam(), .tilt_degrees = tilt, .round = round, .bright = bright};
        if (bright) std::swap(cell.light, cell.dark);
        const Scene scene = scene_of(cell);
        imaging::LocatorOptions options;
        options.diameter_px = cell.diameter;
        options.preprocess.bright = bright;
        const imaging::Located located = imaging::locate(scene.exhibit.picture, options);
        std::vector<imaging::FoundBead> found;
        for (const imaging::Detection& b : located.beads) found.push_back({b.x, b.y, -1});
        imaging::Scorer scorer;
        scorer.add(scene.exhibit.truth, found);
        const imaging::Score score = scorer.score();
        SCOPED_TRACE(fmt::format("thickness {} px, tilt {}, {} ends, {} beads", cell.thickness, tilt,
                                 round ? "round" : "square", bright ? "bright" : "dark"));
        std::printf("%2g px, tilt %g, %s ends, %s beads: recall %.3f, precision %.3f, rms %.4f px\n",
                    cell.thickness, tilt, round ? "round" : "square", bright ? "bright" : "dark",
                    score.recall(), score.precision(), score.rms);
        EXPECT_EQ(score.found, scene.exhibit.truth.size());
        EXPECT_EQ(score.false_finds, 0U);
        EXPECT_LT(score.rms, 0.02);
        // No candidate survives on a bar, whatever the reason: its dark is not there to be explained.
        const imaging::Prepared image =
            imaging::prepare(scene.exhibit.picture, options.preprocess, 0.5 * cell.diameter);
        ASSERT_FALSE(image.opaque.empty());
        double on_bars = 0, marked = 0, beads = 0, bead_pixels = 0;
        for (int y = 0; y < image.opaque.rows; ++y)
          for (int x = 0; x < image.opaque.cols; ++x) {
            const bool opaque = image.opaque(y, x) != 0;
            for (const Bar& bar : scene.bars)
              if (bar.contains(x, y)) {
                on_bars += 1, marked += opaque ? 1 : 0;
                break;
              }
            for (const imaging::TruthBead& b : scene.exhibit.truth)
              if (std::hypot(x - b.x, y - b.y) < b.r) bead_pixels += 1, beads += opaque ? 1 : 0;
          }
        EXPECT_GT(marked, 0.99 * on_bars);
        EXPECT_LT(beads, 0.04 * bead_pixels);  // where they touch a bar
      }
}

INSTANTIATE_TEST_SUITE_P(Thickness, Bars, testing::Values(5, 8, 12, 18, 22, 28, 40));

// The sides of a row of touching beads, and of a crystal, bend within a bead.
TEST(BarsOnly, RowsOfBeadsAreNotBars) {
  for (const double d : {8.0, 9.0, 12.0, 22.0, 40.0})
    for (const double blur : {0.7, 1.2})
      for (const double tilt : {0.0, 0.03}) {
        Painter canvas(static_cast<int>(16 * d), kLight);
        for (int row = 0; row < 3; ++row)  // a crystal above, a column at either side, a row below
          for (int k = 0; k < 12; ++k) {
            const double x = (2 + k + 0.5 * (row % 2)) * d, y = (5 + 0.8660254 * row) * d + tilt * x;
            canvas.disc(x, y, d / 2, [](double, double, double) { return 20.0; });
          }
        for (int k = 0; k < 12; ++k) {
          canvas.disc((2 + k) * d, 13 * d + tilt * k * d, d / 2, [](double, double, double) { return 20.0; });
          canvas.disc(d + tilt * k * d, (1 + k) * d, d / 2, [](double, double, double) { return 20.0; });
        }
        const cv::Mat1b grey = canvas.exposed(blur, kNoise, 5);
        const imaging::Prepared image = imaging::prepare(grey, {}, d / 2);
        EXPECT_TRUE(image.opaque.empty()) << d << " px, blur " << blur << ", tilt " << tilt;
      }
}

// A wall that runs through the lower border has its end there, which is no plate.
TEST(BarsOnly, WallsThroughTheLowerBorderHaveEdges) {
  for (const double tilt : {0.0, 1.0, -2.0}) {
    const Scene scene = scene_of({.thickness = 22, .tilt_degrees = tilt, .through_border = true});
    const imaging::CellEdges edges = imaging::find_cell_edges(scene.exhibit.picture, {.diameter_px = 22});
    EXPECT_GE(edges.left.size(), 40U) << tilt;
    EXPECT_GE(edges.right.size(), 40U) << tilt;
    EXPECT_GE(edges.plate.size(), 40U) << tilt;
  }
}

// Walls and plate of one frame: the rows of the plate show no wall, only the far side of the other one.
TEST(BarsOnly, APlateThatJoinsTheWallsHasAnEdge) {
  for (const double tilt : {0.0, 0.4, -2.0}) {
    const Scene scene = scene_of({.thickness = 18, .tilt_degrees = tilt, .one_frame = true});
    const imaging::CellEdges edges = imaging::find_cell_edges(scene.exhibit.picture, {.diameter_px = 22});
    EXPECT_GE(edges.left.size(), 40U) << tilt;
    EXPECT_GE(edges.right.size(), 40U) << tilt;
    ASSERT_GE(edges.plate.size(), 40U) << tilt;
    const Bar& plate = scene.bars.back();
    for (const imaging::EdgePoint& p : edges.plate) {
      const cv::Point2d axis = (plate.b - plate.a) / cv::norm(plate.b - plate.a),
                        from = cv::Point2d(p.at.x_px, p.at.y_px) - plate.a;
      EXPECT_NEAR(axis.y * from.x - axis.x * from.y, 0.5 * plate.thickness, 0.5) << tilt;
    }
  }
}

// The upper side of a moving bar, seen between beads.
TEST(BarsOnly, ThePlateIsFollowed) {
  std::vector<double> off;
  for (const double height : {0.0, 1.3, 2.75, 6.5}) {
    const Scene scene = scene_of({.thickness = 12, .plate_px = height});
    const double seen = imaging::plate_height_px(scene.exhibit.picture, false);
    // From the centre of the lowest row to the upper side of the bar.
    off.push_back(seen - (26 + 12 + 6 + height - 1));
    std::printf("plate raised by %.2f px: seen %.3f px too high\n", height, off.back());
    EXPECT_NEAR(off.back(), 0, 0.15);
  }
}

}  // namespace
}  // namespace twincell::zoo::bars_test
