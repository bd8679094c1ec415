// Frames from outside the project with published reference positions: back-lit opaque beads in a narrow flume
// (Lafaye de Micheaux, Ducottet, Frey, Machine Vision and Applications 29 (2018) 735), reduced by half to
// beads of 14 px. The reference is accurate to 0.05 px.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <iostream>
#include <map>

#include "imaging/benchmark/score.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/stack/open_frames.hpp"
#include "imaging/track/locate_stack.hpp"
#include "imaging/track/track.hpp"

namespace twincell::real_images_test {

using namespace imaging;

TEST(RealImages, BedloadIsFoundLinkedAndRepeats) {
  const std::filesystem::path folder = TWINCELL_SOURCE_DIR "/../shared/real_images/bedload_left_half";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "The real images are not beside the source tree.";
  const auto truth = read_truth(folder);
  ASSERT_EQ(truth.size(), 20U);
  LocatorOptions locator;
  locator.diameter_px = 14.1;
  const auto frames = open_frames(folder);
  const TrackedStack stack = track_stack(*frames, {}, {.locator = locator});
  ASSERT_EQ(stack.frames.size(), truth.size());
  const ScoredRows rows{30, 147.5};  // between the water surface and the glued base
  Scorer scorer(rows);
  std::map<std::int64_t, TrackedBead> before;
  double squares = 0;
  std::size_t resting = 0;
  for (std::size_t f = 0; f < truth.size(); ++f) {
    std::vector<FoundBead> found;
    std::map<std::int64_t, TrackedBead> now;
    for (const TrackedBead& b : stack.frames[f]) {
      found.push_back({b.x_px, b.y_px, b.track});
      if (b.y_px < rows.first || b.y_px > rows.last) continue;
      now[b.track] = b;
      const auto old = before.find(b.track);
      if (old == before.end()) continue;
      const double dx = b.x_px - old->second.x_px, dy = b.y_px - old->second.y_px;
      if (std::hypot(dx, dy) > 0.15) continue;  // the bead moves
      squares += (dx * dx + dy * dy) / 4;       // a difference has twice the variance of a position
      ++resting;
    }
    scorer.add(truth[f], found);
    before = std::move(now);
  }
  const Score s = scorer.score();
  ASSERT_GT(resting, 1000U);
  const double repeat = std::sqrt(squares / static_cast<double>(resting));
  std::cout << "recall " << s.recall() << ", precision " << s.precision() << ", rms " << s.rms << " px ("
            << s.rms_sure << " px of the " << s.sure << " whose truth is surest), bias " << s.bias_x << " "
            << s.bias_y << " px, " << s.wrong_links << " of " << s.links
            << " links wrong, repeatability of resting beads " << repeat << " px\n";
  EXPECT_EQ(s.recall(), 1);
  EXPECT_EQ(s.precision(), 1);
  EXPECT_LE(s.rms, 0.08);
  EXPECT_GT(s.sure, 2000U);
  EXPECT_LE(s.rms_sure, 0.05);  // the accuracy of the reference
  EXPECT_GT(s.links, 2500U);
  EXPECT_EQ(s.wrong_links, 0U);
  EXPECT_LE(repeat, 0.02);
}

// One photograph of 29 photoelastic discs of two sizes, bright on dark, with fringes (PEGS, J. Kollmer). The
// discs are counted by eye; the reference centres are accurate to a pixel. Only the file name is given.
TEST(RealImages, PhotoelasticDiscsOfTwoSizesAreFoundUnasked) {
  const std::filesystem::path folder = TWINCELL_SOURCE_DIR "/../shared/real_images/photoelastic_29";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "The real images are not beside the source tree.";
  const auto truth = read_truth(folder / "truth.csv");
  ASSERT_EQ(truth.size(), 1U);
  LocatorOptions locator;
  locator.polarity_known = false;
  const auto frames = open_frames(folder / "Step09-0001.jpg");
  Scorer scorer;
  FramesAhead ahead(*frames);
  const LocatorOptions settled = configure_locator(ahead, locator).locator;
  locate_stack(ahead, settled, 1, [&](std::int64_t, const cv::Mat&, const Located& located) {
    std::vector<FoundBead> found;
    for (const Detection& b : located.beads) {
      found.push_back({b.x, b.y, -1});
      EXPECT_FALSE(b.tracer);
    }
    scorer.add(truth[0], found);
  });
  const Score s = scorer.score();
  std::cout << "photoelastic: recall " << s.recall() << ", precision " << s.precision() << ", rms " << s.rms
            << " px, diameters " << settled.diameter_px << " px";
  for (const double other : settled.other_diameters_px) std::cout << " and " << other << " px";
  std::cout << '\n';
  EXPECT_EQ(s.truths, 29U);
  EXPECT_EQ(s.recall(), 1);
  EXPECT_EQ(s.precision(), 1);
  EXPECT_LE(s.rms, 1.0);
  EXPECT_TRUE(settled.preprocess.bright);
  EXPECT_EQ(settled.refine.method, "edges");
  EXPECT_NEAR(settled.diameter_px, 147.2, 1.5);  // of the reference radii, the mean of each size
  ASSERT_EQ(settled.other_diameters_px.size(), 1U);
  EXPECT_NEAR(settled.other_diameters_px[0], 103.2, 1.5);
}

}  // namespace twincell::real_images_test
