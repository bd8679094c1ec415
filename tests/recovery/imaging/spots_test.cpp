// Discs so small that they may be the highlights of larger beads, or the gaps between them, are doubted.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "imaging/benchmark/picture.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/settings/settings_doubts.hpp"
#include "tests/support/one_picture.hpp"

namespace twincell::imaging::spots_test {
namespace {

/// The doubts about the settings found for discs of one width on a lattice.
std::vector<std::string> doubts_about(double width_px) {
  rendered::Picture p;
  p.width = 150, p.height = 120;
  for (double y = width_px; y < p.height; y += 1.6 * width_px)
    for (double x = width_px; x < p.width; x += 1.6 * width_px) {
      rendered::Disc disc;
      disc.x = x + 0.3, disc.y = y + 0.2, disc.radius = width_px / 2;
      p.discs.push_back(disc);
    }
  OnePicture stack(rendered::expose(rendered::expected(p), p, 51, 1));
  FramesAhead ahead(stack);
  LocatorOptions open;
  open.polarity_known = false;
  return settings_doubts(configure_locator(ahead, open).choice, open.refine.method);
}

TEST(Spots, OfLessThanFivePixelsAreDoubted) {
  const auto about_highlights = [](const std::string& doubt) {
    return doubt.find("discs this small may be highlights of larger beads") != std::string::npos;
  };
  const std::vector<std::string> small = doubts_about(4), large = doubts_about(7);
  EXPECT_EQ(std::count_if(small.begin(), small.end(), about_highlights), 1);
  EXPECT_EQ(std::count_if(large.begin(), large.end(), about_highlights), 0);
}

}  // namespace
}  // namespace twincell::imaging::spots_test
