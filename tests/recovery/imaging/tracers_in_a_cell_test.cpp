// Beds with tracers between opaque walls, located without options: the first frames of the shipped films,
// whose beads are known (data_samples/demo/SOURCE.md), and the same in grey levels of a colour film.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "imaging/stack/open_frames.hpp"
#include "imaging/track/track.hpp"
#include "tests/support/look_at_picture.hpp"

namespace twincell::imaging::tracers_in_a_cell_test {
namespace {

const std::filesystem::path kDemo = TWINCELL_SOURCE_DIR "/data_samples/demo";

/// The first frame of a stack.
cv::Mat first_frame(const std::filesystem::path& stack) {
  cv::Mat frame;
  open_frames(stack)->next(frame);
  return frame;
}

// Six layers in a cell of ten diameters: a quarter of the beads show a third of their rims, and most of those
// lie at the walls or the plate.
TEST(TracersInACell, OfSixLayersAreFoundWithPlainDiscs) {
  for (const char* film : {"gamma-0.9.tif", "gamma-1.6.tif", "gamma-2.8.tif"}) {
    const Seen seen = look(first_frame(kDemo / "six-layers" / film));
    EXPECT_EQ(seen.settings.refine.method, "exact") << film;
    EXPECT_NEAR(seen.settings.diameter_px, 12, 0.02) << film;
    EXPECT_EQ(seen.beads, 60U) << film;
    EXPECT_EQ(seen.tracers, 10U) << film;
  }
}

// Red beads, walls and plate before white light: grey levels of 0.3 of the light. The tracers have 0.42 of
// its darkness, near the 0.4 below which discs usually do not count.
TEST(TracersInACell, RedTracersAreFound) {
  for (const char* film : {"gamma-0.9", "gamma-1.6"}) {
    const cv::Mat black = first_frame(kDemo / film / "frame_00000.png");
    double light = 0;
    cv::minMaxLoc(black, nullptr, &light);
    cv::Mat red;
    black.convertTo(red, CV_8U, 0.7, 0.3 * light);
    const Seen seen = look(red);
    EXPECT_EQ(seen.settings.refine.method, "exact") << film;
    EXPECT_NEAR(seen.settings.diameter_px, 12, 0.05) << film;
    EXPECT_EQ(seen.beads, 100U) << film;
    EXPECT_EQ(seen.tracers, 10U) << film;
  }
}

// A profile fit of the wrong diameter leaves all tracers out. They are counted, and nothing is where all are
// found.
TEST(TracersInACell, ThatAreLeftOutAreCounted) {
  for (const bool plain : {false, true}) {
    const auto frames = open_frames(kDemo / "six-layers/gamma-0.9.tif");
    LocatorOptions options;
    options.diameter_px = 12;
    if (!plain) options.refine.method = "profile";
    const TrackedStack stack = track_stack(*frames, {}, {.locator = options});
    const auto n = static_cast<double>(stack.frames.size());
    if (plain) {
      EXPECT_EQ(stack.n_tracks, 60);
      EXPECT_EQ(stack.paler, 0U);
      EXPECT_EQ(stack.paler_doubt(), "");
    } else {
      EXPECT_LE(stack.n_tracks, 52);
      EXPECT_NEAR(static_cast<double>(stack.paler) / n, 10, 1);
      EXPECT_NE(stack.paler_doubt().find("paler discs in a frame were left out"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace twincell::imaging::tracers_in_a_cell_test
