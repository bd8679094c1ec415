// Discs centred outside the frame that darken its border, and beads in the corners of the frame.

#include "imaging/refine/out_of_frame_discs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "imaging/benchmark/picture.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/refine/missed_discs.hpp"

namespace twincell::imaging::out_of_frame_discs_test {
namespace {

constexpr double kRadius = 7.5;

rendered::Picture picture_of(std::vector<rendered::Disc> discs) {
  rendered::Picture p;
  p.width = 100;
  p.height = 80;
  p.discs = std::move(discs);
  return p;
}

std::vector<Proposal> beyond(const rendered::Picture& p) {
  const cv::Mat1d light = rendered::expected(p);
  cv::Mat1f darkness(p.height, p.width + kSpareColumns, kUnseen), model = cv::Mat1f::zeros(darkness.size());
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x)
      darkness(y, x) = static_cast<float>(1 - (light(y, x) - p.pedestal) / p.light);
  RingArgs args;
  args.picture = &darkness;
  args.model = &model;
  args.blur.variance = p.blur * p.blur + 1.0 / 12;
  return out_of_frame_discs(args, kRadius, kRadius + 1, kMissedDarkness);
}

TEST(OutOfFrameDiscs, DiscsAreSeenByTheirSlivers) {
  // From half a disc to half a pixel of a disc visible, at each border.
  const std::vector<rendered::Disc> discs = {{30, -3, kRadius}, {70.4, -6.8, kRadius},  {-5.5, 30.3, kRadius},
                                             {-7, 60, kRadius}, {105.2, 20.2, kRadius}, {60, 86, kRadius}};
  const std::vector<Proposal> found = beyond(picture_of(discs));
  for (const rendered::Disc& d : discs) {
    // The best proposal for a disc is the first one near it.
    const auto first = std::find_if(found.begin(), found.end(), [&](const Proposal& p) {
      return std::hypot(p.x - d.x, p.y - d.y) < kRadius;
    });
    ASSERT_NE(first, found.end()) << d.x << ' ' << d.y;
    EXPECT_LE(std::hypot(first->x - d.x, first->y - d.y), 0.8) << d.x << ' ' << d.y;
  }
  for (const Proposal& p : found) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const rendered::Disc& d : discs) nearest = std::min(nearest, std::hypot(p.x - d.x, p.y - d.y));
    EXPECT_LE(nearest, 1.5 * kRadius) << p.x << ' ' << p.y;
  }
}

TEST(OutOfFrameDiscs, AnEmptyBorderHasNone) {
  EXPECT_TRUE(beyond(picture_of({{50, 40, kRadius}})).empty());
  // Its blurred rim ends outside the frame.
  EXPECT_TRUE(beyond(picture_of({{50, -11.5, kRadius}})).empty());
}

// Three beads touch a disc of which three pixels are visible. Without that disc in the fit, each of the three
// moved by 0.1 to 0.3 px.
TEST(OutOfFrameDiscs, ItsNeighboursAreNotMoved) {
  const double y = 40, x = 92;
  rendered::Picture p = picture_of({{x, y, kRadius},
                                    {x + 15, y, kRadius},
                                    {x + 7.5, y - 7.5 * std::sqrt(3.0), kRadius},
                                    {x + 7.5, y + 7.5 * std::sqrt(3.0), kRadius}});
  for (const double left : {20.0, 45.0})
    for (const double down : {15.0, 40.0, 65.0}) p.discs.push_back({left, down, kRadius});
  LocatorOptions options;
  options.diameter_px = 2 * kRadius;
  const Located located = locate(rendered::expose(rendered::expected(p), p, 164, 5), options);
  EXPECT_EQ(located.beads.size(), p.discs.size() - 1);
  for (const rendered::Disc& d : p.discs) {
    if (d.x > p.width) continue;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Detection& b : located.beads) nearest = std::min(nearest, std::hypot(b.x - d.x, b.y - d.y));
    EXPECT_LE(nearest, 0.02) << d.x << ' ' << d.y;
  }
}

// Beyond a corner the frame is extended as dark only where a wall reaches the corner.
TEST(OutOfFrameDiscs, ABeadInACornerIsNoWall) {
  rendered::Picture p =
      picture_of({{1.2, 0.7, kRadius}, {98.4, 78.6, kRadius}, {30, 30, kRadius}, {60, 50, kRadius}});
  cv::Mat1b frame = rendered::expose(rendered::expected(p), p, 51, 6);
  LocatorOptions options;
  options.diameter_px = 2 * kRadius;
  EXPECT_EQ(locate(frame, options).beads.size(), 4U);
  // A plate along the bottom counts as a wall up to its end.
  frame.rowRange(72, 80).setTo(20);
  const cv::Mat1b walls = prepare(frame, {}, kRadius).opaque;
  ASSERT_FALSE(walls.empty());
  EXPECT_EQ(cv::countNonZero(walls.row(78)), walls.cols);
  EXPECT_EQ(cv::countNonZero(walls.row(60)), 0);
}

}  // namespace
}  // namespace twincell::imaging::out_of_frame_discs_test
