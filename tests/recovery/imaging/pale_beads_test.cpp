// Beads that let light through, in a cell with opaque walls, located without options: the walls are darker
// than the beads. Opaque beads among them are tracers.
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <vector>

#include "tests/support/look_at_picture.hpp"

namespace twincell::imaging::pale_beads_test {
namespace {

constexpr int kRows = 9, kColumns = 12, kWall_px = 12, kFine = 8;  // kFine: samples of a pixel along a side
constexpr double kDiameter_px = 14, kSpacing_px = 14.2, kLight = 205;

/// A loose triangular bed between walls and a plate, in grey levels. Each bead absorbs `bead` of the light,
/// and `n_tracers` of them, chosen at random, `tracer` instead.
cv::Mat1b bed(double bead, double tracer, int n_tracers) {
  const double height = kSpacing_px * std::sqrt(0.75);
  const cv::Size size(cvCeil((kColumns + 0.5) * kSpacing_px) + 2 * kWall_px, 220);
  cv::Mat1f fine(kFine * size.height, kFine * size.width, static_cast<float>(kLight));
  const auto fill = [&](const cv::Rect& r) { fine(r & cv::Rect({}, fine.size())) = 0.03 * kLight; };
  fill({0, 0, kFine * kWall_px, fine.rows});
  fill({fine.cols - kFine * kWall_px, 0, kFine * kWall_px, fine.rows});
  fill({0, fine.rows - kFine * kWall_px, fine.cols, kFine * kWall_px});
  std::mt19937_64 random(5);
  std::vector<bool> is_tracer(static_cast<std::size_t>(kRows) * kColumns, false);
  std::fill_n(is_tracer.begin(), n_tracers, true);
  std::shuffle(is_tracer.begin(), is_tracer.end(), random);
  std::uniform_real_distribution<double> shift(-0.1, 0.1);  // px
  for (int row = 0; row < kRows; ++row)
    for (int k = 0; k < kColumns; ++k) {
      const int n = row * kColumns + k;
      const double absorbed = is_tracer[static_cast<std::size_t>(n)] ? tracer : bead;
      const double x = kWall_px + kSpacing_px * (k + (row % 2 == 0 ? 0.5 : 1.0)) + shift(random),
                   y = size.height - kWall_px - kSpacing_px / 2 - row * height + shift(random);
      // The pixel (0, 0) has its centre at 0.
      cv::circle(fine, {cvRound(kFine * x), cvRound(kFine * y)}, cvRound(kFine * kDiameter_px / 2),
                 (1 - absorbed) * kLight, cv::FILLED);
    }
  cv::Mat1f picture;
  cv::resize(fine, picture, size, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(picture, picture, {0, 0}, 0.8);
  std::normal_distribution<float> noise(0, 1.5F);
  for (float& v : picture) v += noise(random);
  cv::Mat1b grey;
  picture.convertTo(grey, CV_8U);
  return grey;
}

TEST(PaleBeads, AreFoundBetweenOpaqueWalls) {
  for (const double absorbed : {0.35, 0.4}) {
    const Seen seen = look(bed(absorbed, 0, 0));
    EXPECT_EQ(seen.settings.refine.method, "exact") << absorbed;
    EXPECT_NEAR(seen.settings.diameter_px, kDiameter_px, 0.1) << absorbed;
    EXPECT_EQ(seen.beads, static_cast<std::size_t>(kRows * kColumns)) << absorbed;
    EXPECT_EQ(seen.tracers, 0U) << absorbed;
  }
}

TEST(PaleBeads, OpaqueOnesAmongThemAreTracers) {
  for (const double absorbed : {0.42}) {
    const Seen seen = look(bed(absorbed, 0.95, 13));
    EXPECT_EQ(seen.settings.refine.method, "exact") << absorbed;
    EXPECT_EQ(seen.beads, static_cast<std::size_t>(kRows * kColumns)) << absorbed;
    EXPECT_EQ(seen.tracers, 13U) << absorbed;
  }
}

}  // namespace
}  // namespace twincell::imaging::pale_beads_test
