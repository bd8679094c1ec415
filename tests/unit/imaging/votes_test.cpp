#include "imaging/find/votes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace twincell::votes_test {

using namespace imaging;

namespace {

// A picture without order, smooth enough that some gradients are large enough to vote and some are not.
cv::Mat1f picture(int width, int height) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> darkness(-0.2F, 1.2F);
  cv::Mat1f coarse(height, width), smooth(height, width);
  for (float& v : coarse) v = darkness(random);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float sum = 0;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          sum += coarse(std::clamp(y + dy, 0, height - 1), std::clamp(x + dx, 0, width - 1));
      smooth(y, x) = sum / 9;
    }
  return smooth;
}

// The votes as defined in votes.hpp, pixel by pixel, without omitting any to save memory.
cv::Mat1d smoothed_votes(const cv::Mat1f& darkness, const cv::Mat1b& ignore, const VoteOptions& o) {
  const auto at = [&](int y, int x) {
    return static_cast<double>(
        darkness(std::clamp(y, 0, darkness.rows - 1), std::clamp(x, 0, darkness.cols - 1)));
  };
  constexpr std::array<double, 5> kSmooth = {1, 4, 6, 4, 1}, kSlope = {-1, -2, 0, 2, 1};
  constexpr int kTail = 4;
  const int border = o.pad + kTail;
  cv::Mat1d votes = cv::Mat1d::zeros(darkness.rows + 2 * border, darkness.cols + 2 * border);
  for (int y = 0; y < darkness.rows; ++y)
    for (int x = 0; x < darkness.cols; ++x) {
      double gx = 0, gy = 0;
      for (int j = -2; j <= 2; ++j)
        for (int i = -2; i <= 2; ++i) {
          const double along = kSmooth.at(static_cast<std::size_t>(j + 2)),
                       across = kSlope.at(static_cast<std::size_t>(i + 2));
          gx += along * across * at(y + j, x + i) / 128;
          gy += along * across * at(y + i, x + j) / 128;
        }
      const double g = std::hypot(gx, gy);
      if (g <= 0.05 || (!ignore.empty() && ignore(y, x) != 0)) continue;
      votes(y + border + static_cast<int>(std::lrint(o.radius_px * gy / g)),
            x + border + static_cast<int>(std::lrint(o.radius_px * gx / g))) += g;
    }
  std::array<double, kTail + 1> weights{};
  double sum = 0;
  for (int k = 0; k <= kTail; ++k) {
    weights.at(static_cast<std::size_t>(k)) = std::exp(-0.5 * k * k / (o.smoothing * o.smoothing));
    sum += (k > 0 ? 2 : 1) * weights.at(static_cast<std::size_t>(k));
  }
  cv::Mat1d smooth(darkness.rows + 2 * o.pad, darkness.cols + 2 * o.pad);
  for (int y = 0; y < smooth.rows; ++y)
    for (int x = 0; x < smooth.cols; ++x) {
      double v = 0;
      for (int j = -kTail; j <= kTail; ++j)
        for (int i = -kTail; i <= kTail; ++i)
          v += weights.at(static_cast<std::size_t>(std::abs(j))) *
               weights.at(static_cast<std::size_t>(std::abs(i))) * votes(y + kTail + j, x + kTail + i);
      smooth(y, x) = v / (sum * sum);
    }
  return smooth;
}

struct Case {
  int width, height;
  double radius;
  bool ignores;
  std::size_t tops;  // minimum number
};

class Votes : public testing::TestWithParam<Case> {};

TEST_P(Votes, AreThoseOfTheDefinition) {
  const Case c = GetParam();
  const cv::Mat1f darkness = picture(c.width, c.height);
  cv::Mat1b ignore;
  if (c.ignores) {
    ignore = cv::Mat1b::zeros(darkness.size());
    ignore(cv::Rect(c.width / 3, 0, c.width / 3, c.height / 2 + 1)).setTo(1);
  }
  const VoteOptions options{c.radius, std::min(kVoteSmoothing, c.radius / 3),
                            static_cast<int>(std::ceil(c.radius)) + 2};
  const cv::Mat1d expected = smoothed_votes(darkness, ignore, options);
  int rows = 0;
  double worst = 0;
  std::vector<cv::Point> tops;
  std::vector<std::int32_t> room;
  constexpr float kMinVotes = 0.1F;
  over_smoothed_votes(darkness, ignore, options, [&](int y, const VoteLines& lines) {
    ASSERT_EQ(y, rows++);
    for (int x = 0; x < expected.cols; ++x)
      worst = std::max(worst, std::abs(static_cast<double>(lines[2][x]) - expected(y, x)));
    if (y < 2) return;
    for (const std::int32_t x :
         tops_of_votes(lines, static_cast<std::size_t>(expected.cols), kMinVotes, room))
      tops.emplace_back(x, y - 1);
  });
  EXPECT_EQ(rows, expected.rows);
  EXPECT_LT(worst, 1e-5);

  std::vector<cv::Point> larger;
  for (int y = 1; y + 1 < expected.rows; ++y)
    for (int x = 1; x + 1 < expected.cols; ++x) {
      bool top = expected(y, x) >= static_cast<double>(kMinVotes);
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i)
          top = top && ((i == 0 && j == 0) || expected(y, x) > expected(y + j, x + i));
      if (top) larger.emplace_back(x, y);
    }
  EXPECT_EQ(tops, larger);
  EXPECT_GE(tops.size(), c.tops);
}

// No integer or half-integer radii: a vertical vote would fall halfway between two pixels, and rounding would
// decide which of them receives it.
INSTANTIATE_TEST_SUITE_P(OfPictures, Votes,
                         testing::Values(Case{97, 61, 3.1, false, 50}, Case{120, 90, 7.4, true, 10},
                                         Case{64, 140, 20.3, false, 5}, Case{5, 4, 4.2, false, 0},
                                         Case{1, 1, 1.6, false, 0}),
                         [](const auto& of) { return "Of" + std::to_string(of.param.width) + "Columns"; });

TEST(Tops, OfEqualOnesTheFirst) {
  constexpr std::size_t kWide = 40, kSpare = 16;
  std::array<std::array<float, kWide + kSpare>, 3> rows{};
  rows[1][7] = rows[1][8] = rows[2][8] = 2;  // a plateau that begins in the middle row
  rows[0][20] = rows[1][21] = 3;             // a plateau that begins above the middle row
  rows[1][0] = rows[1][kWide - 1] = 9;       // at the border
  rows[1][kWide] = 99;                       // outside the border
  std::vector<std::int32_t> room;
  const auto tops = tops_of_votes({rows[0].data(), rows[1].data(), rows[2].data()}, kWide, 1, room);
  EXPECT_EQ(std::vector<std::int32_t>(tops.begin(), tops.end()), std::vector<std::int32_t>{7});
}

}  // namespace

}  // namespace twincell::votes_test
