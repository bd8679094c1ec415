#include "imaging/refine/size_assignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace twincell::size_assignment_test {

using namespace imaging;

namespace {

constexpr double kBlur = 0.85;

/// Darkness of blurred discs that do not overlap.
Prepared discs(const std::vector<Proposal>& all, double blur = kBlur) {
  Prepared image;
  image.darkness = cv::Mat1f::zeros(80, 90);
  for (int y = 0; y < image.darkness.rows; ++y)
    for (int x = 0; x < image.darkness.cols; ++x)
      for (const Proposal& d : all)
        image.darkness(y, x) += static_cast<float>(
            0.5 * std::erfc((std::hypot(x - d.x, y - d.y) - d.radius) / (std::numbers::sqrt2 * blur)));
  return image;
}

}  // namespace

TEST(SizeChoice, NothingIsMissingOfADiscOrOfWhatLiesInIt) {
  const Proposal disc{40.3, 38.8, 0.5, 12};
  const Prepared image = discs({disc});
  EXPECT_NEAR(missing_share(image, disc, kBlur, 0), 0, 1e-4);
  EXPECT_NEAR(missing_share(image, {42, 38, 0.5, 7}, kBlur, 0), 0, 1e-4);
}

// For sharp rims the missing share is the fraction of the outer annulus, from R/2 to R, that is outside the
// actual disc.
TEST(SizeChoice, OversizedDiscReportsMissingRim) {
  constexpr double kSharp = 0.1;
  const Prepared image = discs({{40, 40, 0.5, 28}}, kSharp);
  EXPECT_NEAR(missing_share(image, {40, 40, 0.5, 34}, kSharp, 0), (34.0 * 34 - 28 * 28) / (34 * 34 - 17 * 17),
              0.03);
}

TEST(SizeChoice, HiddenDiscIsAllMissing) {
  EXPECT_EQ(missing_share(discs({}), {-40, -40, 0.5, 6}, kBlur, 0), 1);
}

// A large disc and, next to it, two small ones that touch, with proposals as they arise from votes: small
// ones inside the large disc, and a large one over the small discs.
TEST(SizeChoice, TheTrueSizesStay) {
  const Proposal large{30, 40, 0.10, 12}, one{52, 34, 0.10, 6}, other{52, 46, 0.10, 6};
  const Prepared image = discs({large, one, other});
  const std::vector<Proposal> kept =
      assign_sizes(image, {{33, 41, 0.13, 6}, {52, 40, 0.14, 12}, large, one, other, {27, 38, 0.12, 6}});
  ASSERT_EQ(kept.size(), 3U);
  for (const Proposal& p : {large, one, other})
    EXPECT_EQ(
        std::count_if(kept.begin(), kept.end(),
                      [&](const Proposal& k) { return k.x == p.x && k.y == p.y && k.radius == p.radius; }),
        1);
}

TEST(BlurOf, IsThatOfTheEdges) {
  for (const double s : {0.8, 1.5, 2.5, 4.0})
    EXPECT_NEAR(blur_of(discs({{40, 40, 0.5, 25}}, s).darkness), s, 0.2 * s) << s;
  EXPECT_EQ(blur_of(cv::Mat1f::zeros(50, 50)), 0.5);
  // Discs of half the darkness have the same blur.
  EXPECT_NEAR(blur_of(0.5 * discs({{40, 40, 0.5, 25}}, 1.5).darkness), 1.5, 0.3);
}

}  // namespace twincell::size_assignment_test
