#include "imaging/cell/plate_row.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace twincell::imaging::plate_row_test {
namespace {

constexpr int kWidth = 288, kHeight = 200;

/// A dark plate whose edge is at a height, beads that hide three quarters of it, and walls at both sides.
cv::Mat1b picture(double height) {
  cv::Mat1b grey(kHeight, kWidth, uchar{200});
  for (int y = 0; y < kHeight; ++y) {
    // Height of the pixel's centre above the lowest row; the edge is blurred over two pixels.
    const double above = kHeight - 1 - y - height;
    const double share = std::clamp(0.5 - 0.5 * above, 0.0, 1.0);
    grey.row(y).setTo(200 - 170 * share);
  }
  for (int x = 20; x < kWidth - 20; x += 16)
    cv::rectangle(grey, {x, 0}, {x + 11, kHeight - 1}, cv::Scalar(30), cv::FILLED);
  cv::rectangle(grey, {0, 0}, {17, kHeight - 1}, cv::Scalar(25), cv::FILLED);
  cv::rectangle(grey, {kWidth - 18, 0}, {kWidth - 1, kHeight - 1}, cv::Scalar(25), cv::FILLED);
  return grey;
}

TEST(PlateRow, IsReadBesideTheBeads) {
  for (const double height : {12.0, 20.4, 31.7})
    EXPECT_NEAR(plate_height_px(picture(height), false), height, 0.3);
}

// A frame counter in the plate takes up a quarter of the width.
TEST(PlateRow, DigitsInThePlateAreNotItsEdge) {
  for (const double height : {16.0, 20.4, 31.7}) {
    cv::Mat1b grey = picture(height);
    cv::putText(grey, "f0009.png", {4, kHeight - 5}, cv::FONT_HERSHEY_SIMPLEX, 0.4, cv::Scalar(255), 1);
    EXPECT_NEAR(plate_height_px(grey, false), height, 0.3) << height;
  }
}

// Turned by a degree.
TEST(PlateRow, ATurnedPlateHasTheHeightOfItsLowerPart) {
  cv::Mat1b grey;
  const cv::Mat turn = cv::getRotationMatrix2D({kWidth / 2.0F, kHeight / 2.0F}, 1, 1);
  cv::warpAffine(picture(25), grey, turn, {kWidth, kHeight}, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  const double seen = plate_height_px(grey, false);
  EXPECT_GT(seen, 25 - 0.5 * kWidth * std::tan(0.01745) - 1);
  EXPECT_LT(seen, 25);
}

}  // namespace
}  // namespace twincell::imaging::plate_row_test
