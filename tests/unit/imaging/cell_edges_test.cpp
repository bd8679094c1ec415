// Edges of walls and plate in pictures drawn sharply on a fine grid and then blurred, as a lens does it.
#include "imaging/cell/cell_edges.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

namespace twincell::cell_edges_test {

using namespace imaging;

namespace {

constexpr double kRadius_px = 7.5, kLeft_px = 20.37, kRight_px = 200.81, kPlate_px = 160.23;
constexpr int kFine = 8;  // grid points a pixel

/// A cell with a column of beads along either wall and a row on the plate, each `gap_px` from it.
/// \param thickness_px of walls and plate, which transmit a tenth and a fifth of the light; light is behind
/// them. Infinite: they are opaque
/// \param through share of the light that the beads transmit
/// \param core further light in the middle of the beads, as in glass
cv::Mat cell_with_beads(double gap_px, double blur_px, double noise, double thickness_px = HUGE_VAL,
                        float through = 0, double core = 0) {
  const cv::Size size(221, 181);
  cv::Mat1f fine(size * kFine, 1.0F);
  const auto at = [](int i) { return (i + 0.5) / kFine - 0.5; };
  std::vector<cv::Point2d> beads;
  for (double y = kPlate_px - kRadius_px - gap_px; y > 20; y -= 2 * kRadius_px + 3) {
    beads.emplace_back(kLeft_px + kRadius_px + gap_px, y);
    beads.emplace_back(kRight_px - kRadius_px - gap_px, y);
  }
  for (double x = kLeft_px + 4 * kRadius_px; x < kRight_px - 4 * kRadius_px; x += 2 * kRadius_px + 3)
    beads.emplace_back(x, kPlate_px - kRadius_px - gap_px);
  for (int j = 0; j < fine.rows; ++j)
    for (int i = 0; i < fine.cols; ++i)
      if (at(i) < kLeft_px || at(i) > kRight_px || at(j) > kPlate_px) {
        const double into = std::max({kLeft_px - at(i), at(i) - kRight_px}), below = at(j) - kPlate_px;
        const bool plate = below > 0 && below<thickness_px, wall = into> 0 && into < thickness_px;
        fine(j, i) = std::isinf(thickness_px) ? 0 : plate ? 0.2F : wall ? 0.1F : 1.0F;
      }
  for (const cv::Point2d& b : beads)
    for (int j = static_cast<int>((b.y - kRadius_px - 1) * kFine); at(j) < b.y + kRadius_px; ++j)
      for (int i = static_cast<int>((b.x - kRadius_px - 1) * kFine); at(i) < b.x + kRadius_px; ++i)
        if (const double r = std::hypot(at(i) - b.x, at(j) - b.y) / kRadius_px; r < 1)
          fine(j, i) = through + static_cast<float>(core * std::exp(-std::pow(r / 0.45, 4)));
  cv::GaussianBlur(fine, fine, {}, blur_px * kFine, blur_px * kFine, cv::BORDER_REPLICATE);
  cv::Mat1f light;
  cv::resize(fine, light, size, 0, 0, cv::INTER_AREA);
  std::mt19937_64 generator(5);
  std::normal_distribution<float> normal(0, static_cast<float>(noise));
  cv::Mat1b grey(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      grey(y, x) = cv::saturate_cast<uchar>(10 + 200 * light(y, x) + normal(generator));
  return grey;
}

/// Mean distance of an edge's points from the truth, px.
template <class Coordinate>
double offset_of(const std::vector<EdgePoint>& edge, double truth, Coordinate coordinate) {
  double sum = 0, weight = 0;
  for (const EdgePoint& p : edge) {
    sum += (coordinate(p) - truth) / (p.sigma * p.sigma);
    weight += 1 / (p.sigma * p.sigma);
  }
  return sum / weight;
}

}  // namespace

TEST(CellEdges, BeadsThatTouchTheEdgesDoNotMoveThem) {
  constexpr double kBound_px = 0.0125;  // a product of the two lights errs by 0.017
  const auto x = [](const EdgePoint& p) { return p.at.x_px; };
  const auto y = [](const EdgePoint& p) { return p.at.y_px; };
  for (const double gap_px : {0.0, 0.5, 1.5})
    for (const double blur_px : {0.7, 1.0}) {
      const CellEdges edges =
          find_cell_edges(cell_with_beads(gap_px, blur_px, 1), {.diameter_px = 2 * kRadius_px});
      ASSERT_GE(edges.left.size(), 40U) << gap_px;
      ASSERT_GE(edges.right.size(), 40U) << gap_px;
      ASSERT_GE(edges.plate.size(), 40U) << gap_px;
      // The edge of the drawing lies on the grid, within half a step of the stated position.
      const auto drawn = [](double edge) { return std::round((edge + 0.5) * kFine) / kFine - 0.5; };
      EXPECT_NEAR(offset_of(edges.left, drawn(kLeft_px), x), 0, kBound_px) << gap_px << ' ' << blur_px;
      EXPECT_NEAR(offset_of(edges.right, drawn(kRight_px), x), 0, kBound_px) << gap_px << ' ' << blur_px;
      EXPECT_NEAR(offset_of(edges.plate, drawn(kPlate_px), y), 0, kBound_px) << gap_px << ' ' << blur_px;
    }
}

// Walls that are darker than the beads have a level of their own, also where beads touch them (before, edges
// moved by 0.16 px).
TEST(CellEdges, BeadsThatArePalerThanTheWallsDoNotMoveThem) {
  constexpr double kBound_px = 0.0125;
  const auto x = [](const EdgePoint& p) { return p.at.x_px; };
  const auto y = [](const EdgePoint& p) { return p.at.y_px; };
  const auto drawn = [](double edge) { return std::round((edge + 0.5) * kFine) / kFine - 0.5; };
  for (const float through : {0.06F, 0.15F, 0.3F}) {
    const CellEdges edges =
        find_cell_edges(cell_with_beads(0, 0.9, 1, HUGE_VAL, through), {.diameter_px = 2 * kRadius_px});
    ASSERT_GE(edges.left.size(), 40U) << through;
    ASSERT_GE(edges.right.size(), 40U) << through;
    ASSERT_GE(edges.plate.size(), 40U) << through;
    EXPECT_NEAR(offset_of(edges.left, drawn(kLeft_px), x), 0, kBound_px) << through;
    EXPECT_NEAR(offset_of(edges.right, drawn(kRight_px), x), 0, kBound_px) << through;
    EXPECT_NEAR(offset_of(edges.plate, drawn(kPlate_px), y), 0, kBound_px) << through;
  }
}

// Glass beads have a dark rim and a bright middle. Those on the plate hide its edge, as dark ones do (before,
// the plate was up to 2 px too high while the bed lay on it).
TEST(CellEdges, GlassBeadsDoNotMoveThem) {
  constexpr double kBound_px = 0.02;
  const auto x = [](const EdgePoint& p) { return p.at.x_px; };
  const auto y = [](const EdgePoint& p) { return p.at.y_px; };
  const auto drawn = [](double edge) { return std::round((edge + 0.5) * kFine) / kFine - 0.5; };
  const CellEdges edges = find_cell_edges(cell_with_beads(0, 0.7, 1, HUGE_VAL, 0.08F, 0.97),
                                          {.diameter_px = 2 * kRadius_px, .refine = "profile"});
  ASSERT_GE(edges.left.size(), 40U);
  ASSERT_GE(edges.right.size(), 40U);
  ASSERT_GE(edges.plate.size(), 40U);
  EXPECT_NEAR(offset_of(edges.left, drawn(kLeft_px), x), 0, kBound_px);
  EXPECT_NEAR(offset_of(edges.right, drawn(kRight_px), x), 0, kBound_px);
  EXPECT_NEAR(offset_of(edges.plate, drawn(kPlate_px), y), 0, kBound_px);
}

// Walls and plate are bars with light behind them. The bound is wider than above, because the level of a bar
// is known from few pixels.
TEST(CellEdges, BarsWithLightBehindThemAreWalls) {
  constexpr double kBound_px = 0.04;
  const auto x = [](const EdgePoint& p) { return p.at.x_px; };
  const auto y = [](const EdgePoint& p) { return p.at.y_px; };
  for (const double thickness_px : {8.0, 14.0}) {
    const CellEdges edges =
        find_cell_edges(cell_with_beads(0.5, 1.0, 1, thickness_px), {.diameter_px = 2 * kRadius_px});
    ASSERT_GE(edges.left.size(), 40U) << thickness_px;
    ASSERT_GE(edges.right.size(), 40U) << thickness_px;
    ASSERT_GE(edges.plate.size(), 40U) << thickness_px;
    EXPECT_NEAR(offset_of(edges.left, kLeft_px, x), 0, kBound_px + 0.5 / kFine) << thickness_px;
    EXPECT_NEAR(offset_of(edges.right, kRight_px, x), 0, kBound_px + 0.5 / kFine) << thickness_px;
    EXPECT_NEAR(offset_of(edges.plate, kPlate_px, y), 0, kBound_px + 0.5 / kFine) << thickness_px;
  }
}

// A row of touching beads on a plate that is not seen, and a column of them, have straight tangents but no
// straight sides.
TEST(CellEdges, RowsOfBeadsAreNoBars) {
  for (const double diameter_px : {9.0, 15.0, 24.0}) {
    cv::Mat1f fine(cv::Size(200, 200) * kFine, 1.0F);
    for (int row = 0; row < 3; ++row)
      for (double at = 15; at < 190; at += diameter_px)
        for (const cv::Point2d& b :
             {cv::Point2d(at, 180 - row * diameter_px), cv::Point2d(20 + row * diameter_px, at)})
          cv::circle(fine, (b + cv::Point2d(0.5, 0.5)) * kFine, cvRound(diameter_px * kFine / 2), 0,
                     cv::FILLED);
    cv::GaussianBlur(fine, fine, {}, 0.8 * kFine);
    cv::Mat1f light;
    cv::resize(fine, light, cv::Size(200, 200), 0, 0, cv::INTER_AREA);
    cv::Mat1b grey;
    light.convertTo(grey, CV_8U, 200, 10);
    const CellEdges edges = find_cell_edges(grey, {.diameter_px = diameter_px});
    EXPECT_TRUE(edges.left.empty()) << diameter_px;
    EXPECT_TRUE(edges.right.empty()) << diameter_px;
    EXPECT_TRUE(edges.plate.empty()) << diameter_px;
  }
}

}  // namespace twincell::cell_edges_test
