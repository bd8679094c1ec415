// Stacks whose first frame shows no beads, or something else: settings come from a later frame, or none are
// reported.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/error.hpp"
#include "imaging/benchmark/picture.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/stack/open_frames.hpp"
#include "imaging/track/locate_stack.hpp"
#include "tests/support/pictures.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::imaging::shown_later_test {
namespace {

using rendered::Disc;
using rendered::Picture;

Picture frame_with(std::vector<Disc> discs) {
  Picture p;
  p.width = 240, p.height = 200;
  p.discs = std::move(discs);
  return p;
}

Disc disc(double x, double y, double radius) {
  Disc d;
  d.x = x, d.y = y, d.radius = radius;
  return d;
}

/// Beads per frame of a stack, and the settings found.
struct Seen {
  std::vector<std::vector<Detection>> beads;
  LocatorConfiguration configured;
  std::int64_t frames = 0;
};
Seen locate_all(const std::vector<Picture>& pictures) {
  const TemporaryFolder folder;
  for (std::size_t f = 0; f < pictures.size(); ++f)
    write_picture(folder.path() / ("frame_" + std::to_string(100 + f) + ".png"),
                  rendered::expose(rendered::expected(pictures[f]), pictures[f], 51, f + 1));
  Seen seen;
  LocatorOptions options;
  options.polarity_known = false;
  const auto frames = open_frames(folder.path().string());
  FramesAhead ahead(*frames);
  seen.configured = configure_locator(ahead, options);
  seen.frames = locate_stack(
      ahead, seen.configured.locator, 2,
      [&](std::int64_t, const cv::Mat&, const Located& located) { seen.beads.push_back(located.beads); });
  return seen;
}

TEST(ShownLater, TheFirstFramesMayBeBare) {
  const Picture bare = frame_with({});
  const Picture beads = frame_with(
      {disc(40.3, 50.2, 7.5), disc(80.6, 120.4, 7.5), disc(150.1, 60.8, 7.5), disc(200.7, 150.3, 7.5)});
  const Seen seen = locate_all({bare, bare, bare, beads, beads, bare, beads});
  ASSERT_EQ(seen.frames, 7);
  EXPECT_EQ(seen.configured.frame, 4);  // frames 0, 1, 2, 4 are examined
  EXPECT_NEAR(seen.configured.locator.diameter_px, 15, 0.3);
  EXPECT_FALSE(seen.configured.locator.preprocess.bright);
  for (const std::size_t f : {0, 1, 2, 5}) EXPECT_TRUE(seen.beads[f].empty()) << f;
  for (const std::size_t f : {3, 4, 6}) EXPECT_EQ(seen.beads[f].size(), 4U) << f;
}

TEST(ShownLater, WhereNoFrameShowsADiscNoneIsClaimed) {
  const Picture bare = frame_with({});
  EXPECT_THROW(locate_all({bare}), InputError);
  EXPECT_THROW(locate_all({bare, bare, bare}), InputError);
}

// A disc wider than the first search range. The discs are few, so their rims do not cover a fifth of the
// frame.
TEST(ShownLater, OneLargeDiscIsFoundUnasked) {
  for (const double diameter : {100.0, 140.0}) {
    Picture p = frame_with({disc(150.3, 160.6, 0.5 * diameter)});
    p.width = 480, p.height = 400;
    const Seen seen = locate_all({p});
    ASSERT_EQ(seen.beads[0].size(), 1U) << diameter;
    EXPECT_NEAR(seen.beads[0][0].x, 150.3, 0.02);
    EXPECT_NEAR(seen.beads[0][0].y, 160.6, 0.02);
    EXPECT_NEAR(2 * seen.beads[0][0].radius, diameter, 0.1);
  }
}

/// Discs of one radius on a square lattice.
Picture lattice_of(double radius, double spacing) {
  std::vector<Disc> discs;
  for (double y = spacing / 2; y < 200; y += spacing)
    for (double x = spacing / 2; x < 240; x += spacing) discs.push_back(disc(x + 0.3, y + 0.2, radius));
  return frame_with(std::move(discs));
}

// A scale held before the cell in one frame, the first or a later one.
TEST(ShownLater, OneStrangeFrameDoesNotDecide) {
  const Picture beads = lattice_of(7.5, 22), scale = lattice_of(15, 48);
  for (const std::size_t strange : {0, 2, 4}) {
    std::vector<Picture> pictures(5, beads);
    pictures[strange] = scale;
    const Seen seen = locate_all(pictures);
    EXPECT_NEAR(seen.configured.locator.diameter_px, 15, 0.1) << strange;
    EXPECT_EQ(seen.configured.frame, strange == 0 ? 2 : 0);
    for (std::size_t f = 0; f < 5; ++f) {
      if (f == strange) continue;
      EXPECT_EQ(seen.beads[f].size(), beads.discs.size()) << strange << ", " << f;
    }
  }
}

}  // namespace
}  // namespace twincell::imaging::shown_later_test
