// Larger discs that were found in a region of the picture are stated in the whole picture, and a mask hides
// those that it cuts.
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "imaging/track/locating_request.hpp"

namespace twincell::imaging::larger_discs_in_region_test {
namespace {

TEST(LargerDiscs, FoundInARegionAreThoseOfTheWholePicture) {
  SettingsChoice choice;
  choice.larger = {{.x = 50, .y = 40, .diameter_px = 30}, {.x = 120, .y = 40, .diameter_px = 30}};
  Region region{.roi = {100, 200, 180, 90}, .mask = {}};
  const SettingsChoice shifted = in_whole_picture(choice, region);
  ASSERT_EQ(shifted.larger.size(), 2U);
  EXPECT_EQ(shifted.larger[0].x, 150);
  EXPECT_EQ(shifted.larger[0].y, 240);

  region.mask = cv::Mat1b(400, 400, uchar{255});
  region.mask(240, 225) = 0;  // within the second one
  const SettingsChoice seen = in_whole_picture(choice, region);
  ASSERT_EQ(seen.larger.size(), 1U);
  EXPECT_EQ(seen.larger[0].x, 150);
}

}  // namespace
}  // namespace twincell::imaging::larger_discs_in_region_test
