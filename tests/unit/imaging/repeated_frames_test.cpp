// Frames that equal the frame before them to the bit: repeated by a conversion, or of a scene that stands
// still.
#include "imaging/stack/repeated_frames.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "imaging/phase/phases_of_repeated_frames.hpp"

namespace twincell::repeated_frames_test {

using namespace imaging;

namespace {

/// A dark bar whose edge is at `height` px, blurred over one pixel.
cv::Mat bar(double height, double noise = 0, unsigned seed = 0) {
  cv::Mat frame(60, 21, CV_8U);
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  for (int y = 0; y < frame.rows; ++y)
    for (int x = 0; x < frame.cols; ++x)
      frame.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(
          40 + 160 / (1 + std::exp(-2 * (y - height))) + noise * normal(generator));
  return frame;
}

double sine(double frame, double period) {
  return 30 + 8 * std::sin(2 * std::numbers::pi * frame / period);
}

std::vector<std::uint8_t> repeats_of(const std::vector<cv::Mat>& film) {
  RepeatedFrames watch;
  for (const cv::Mat& frame : film) watch.add(frame);
  return watch.repeats();
}

}  // namespace

TEST(RepeatedFrames, AConversionOfTheFrameRateIsFound) {
  for (const double noise : {0.0, 2.0}) {
    std::vector<cv::Mat> film;
    std::vector<std::uint8_t> truth;
    for (unsigned f = 0; f < 80; ++f)
      for (int copy = 0; copy < (f % 5 == 4 ? 2 : 1); ++copy) {
        film.push_back(bar(sine(f, 20), noise, f));
        truth.push_back(copy == 0 ? 0 : 1);
      }
    EXPECT_EQ(repeats_of(film), truth) << noise;
    const std::string said = repeats_in_words(repeats_of(film));
    EXPECT_NE(said.find("16 of 96 frames equal the frame before them to the bit, the first of them frame 5"),
              std::string::npos)
        << said;
  }
}

TEST(RepeatedFrames, WhatStandsStillIsNotRepeated) {
  EXPECT_TRUE(repeats_of({}).empty());
  EXPECT_TRUE(repeats_of({bar(30)}).empty());
  EXPECT_TRUE(repeats_of(std::vector<cv::Mat>(50, bar(30))).empty()) << "a film of a bed at rest";
  std::vector<cv::Mat> begins(40, bar(30));  // the shaker starts after 40 frames
  for (int f = 0; f < 60; ++f) begins.push_back(bar(sine(f, 20)));
  EXPECT_TRUE(repeats_of(begins).empty());
  // Without noise, a plate that turns round half-way between two frames looks the same in both.
  for (const double period : {4.0, 8.0, 20.0, 400.0}) {
    std::vector<cv::Mat> turns;
    for (int f = 0; f < 3 * period; ++f) turns.push_back(bar(sine(f + 0.5, period)));
    EXPECT_TRUE(repeats_of(turns).empty()) << period;
  }
  EXPECT_EQ(repeats_in_words({}), "");
}

TEST(RepeatedFrames, TheyTakeThePhaseOfTheFrameBefore) {
  LockEvidence evidence;
  for (int f = 0; f < 80; ++f)
    for (int copy = 0; copy < (f % 5 == 4 ? 2 : 1); ++copy) {
      evidence.plate_px.push_back(sine(f, 20));
      evidence.repeats.push_back(copy == 0 ? 0 : 1);
    }
  const PhaseTable table = with_repeats(check_lock({20, 0}, without_repeats(evidence)), evidence.repeats);
  EXPECT_EQ(table.checked_by, "the plate");
  EXPECT_EQ(table.doubled, 16);
  EXPECT_EQ(table.dropped, 0);
  ASSERT_EQ(table.frames.size(), 96U);
  for (int f = 0, frame = 0; f < 80; ++f)
    for (int copy = 0; copy < (f % 5 == 4 ? 2 : 1); ++copy, ++frame) {
      EXPECT_EQ(table.at(frame).phase, f % 20) << frame;
      EXPECT_EQ(table.at(frame).cycle, f / 20) << frame;
      EXPECT_EQ(table.is_used(frame), copy == 0) << frame;
    }
}

// Thirty frames of a film that were copied behind it under other names.
TEST(RepeatedFrames, APartThatIsInTheStackTwiceIsFound) {
  RepeatedFrames twice, once, periodic;
  for (unsigned f = 0; f < 60; ++f) twice.add(bar(sine(f, 20), 2, f));
  for (unsigned f = 20; f < 50; ++f) twice.add(bar(sine(f, 20), 2, f));
  EXPECT_EQ(
      twice.copied().find("frames 60 to 89 equal frames 20 to 49 to the bit: this part of the film is in "
                          "the stack twice"),
      0U)
      << twice.copied();
  for (unsigned f = 0; f < 60; ++f) once.add(bar(sine(f, 20), 2, f));
  EXPECT_EQ(once.copied(), "");
  for (unsigned f = 0; f < 60; ++f) periodic.add(bar(sine(f % 20, 20)));
  EXPECT_EQ(periodic.copied(), "") << "a film without noise repeats its cycles";
}

}  // namespace twincell::repeated_frames_test
