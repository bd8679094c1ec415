// Round regions that are larger than the beads and that no bead explains.
#include "imaging/settings/larger_discs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace twincell::imaging::larger_discs_test {
namespace {

constexpr double kBead = 12;  // px

Detection bead(double x, double y) {
  Detection b;
  b.x = x, b.y = y, b.radius = 0.5 * kBead;
  return b;
}

/// Beads on a square grid of 18 px, but not nearer to a place than a distance.
std::vector<Detection> beads_around(cv::Point2d place, double distance) {
  std::vector<Detection> beads;
  for (int x = 12; x < 290; x += 18)
    for (int y = 12; y < 230; y += 18)
      if (std::hypot(x - place.x, y - place.y) > distance) beads.push_back(bead(x, y));
  return beads;
}

/// A picture of discs of a level on a ground of 150, and a larger one of a level of its own.
cv::Mat1b picture_of(const std::vector<Detection>& beads, double level, const Detection& larger,
                     double larger_level) {
  cv::Mat1b picture(240, 300, uchar{150});
  const auto paint = [&](const Detection& d, double of) {
    for (int y = 0; y < picture.rows; ++y)
      for (int x = 0; x < picture.cols; ++x) {
        const double covered = std::clamp(d.radius - std::hypot(x - d.x, y - d.y) + 0.5, 0.0, 1.0);
        if (covered > 0)
          picture(y, x) = cv::saturate_cast<uchar>(picture(y, x) + covered * (of - picture(y, x)));
      }
  };
  for (const Detection& b : beads) paint(b, level);
  if (larger.radius > 0) paint(larger, larger_level);
  cv::GaussianBlur(picture, picture, {0, 0}, 0.8);
  cv::Mat1f noise(picture.size());
  cv::RNG random(3);
  random.fill(noise, cv::RNG::NORMAL, 0, 2);
  picture += noise;
  return picture;
}

TEST(LargerDiscs, AnIntruderAmongBeadsIsFound) {
  for (const double radius : {15.0, 24.0, 40.0})
    for (const double level : {20.0, 240.0}) {
      Detection intruder = bead(141.3, 118.6);
      intruder.radius = radius;
      const std::vector<Detection> beads = beads_around({intruder.x, intruder.y}, radius + 0.5 * kBead + 0.5);
      const std::vector<LargerDisc> found =
          larger_discs(picture_of(beads, 20, intruder, level), beads, kBead);
      ASSERT_EQ(found.size(), 1U) << radius << " px, level " << level;
      EXPECT_NEAR(found[0].x, intruder.x, 0.5);
      EXPECT_NEAR(found[0].y, intruder.y, 0.5);
      EXPECT_NEAR(found[0].diameter_px, 2 * radius, 1);
      EXPECT_EQ(found[0].bright, level > 150);
    }
}

TEST(LargerDiscs, BeadsAloneAndTheirContainerAreNone) {
  const Detection nothing;
  const std::vector<Detection> all = beads_around({0, 0}, 0);
  EXPECT_TRUE(larger_discs(picture_of(all, 20, nothing, 0), all, kBead).empty());
  EXPECT_TRUE(larger_discs(picture_of(all, 20, nothing, 0), {}, kBead).empty());
  // Missed beads are no larger disc.
  const std::vector<Detection> some = beads_around({141, 118}, 30);
  EXPECT_TRUE(larger_discs(picture_of(all, 20, nothing, 0), some, kBead).empty());
  // A round cell that contains the beads.
  Detection cell = bead(150, 120);
  cell.radius = 95;
  std::vector<Detection> inside;
  for (const Detection& b : all)
    if (std::hypot(b.x - cell.x, b.y - cell.y) < cell.radius - kBead) inside.push_back(b);
  cv::Mat1b picture = picture_of(inside, 20, nothing, 0);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x)
      if (std::hypot(x - cell.x, y - cell.y) > cell.radius) picture(y, x) = 30;
  EXPECT_TRUE(larger_discs(picture, inside, kBead).empty());
}

}  // namespace
}  // namespace twincell::imaging::larger_discs_test
