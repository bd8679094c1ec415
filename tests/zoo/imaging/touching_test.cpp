// Shaded spheres fade outwards and are located too small; where they touch, the distance of neighbours is
// their diameter, and a note says so.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "imaging/settings/configure_locator.hpp"
#include "imaging/settings/settings_doubts.hpp"
#include "tests/support/one_picture.hpp"
#include "tests/zoo/imaging/kinds.hpp"

namespace twincell::zoo::touching_test {
namespace {

constexpr int kSide = 170;
constexpr double kDiameter = 11;

imaging::SettingsChoice settings_of(const cv::Mat1b& picture) {
  imaging::OnePicture stack(picture);
  imaging::FramesAhead ahead(stack);
  imaging::LocatorOptions open;
  open.polarity_known = false;
  return imaging::configure_locator(ahead, open).choice;
}

/// White spheres under a lamp, on a dark ground.
cv::Mat1b spheres(const Places& places) {
  Painter canvas(kSide, 40);
  for (const Place& p : places)
    canvas.disc(p.x, p.y, p.radius, [](double u, double v, double) {
      const double w = std::sqrt(std::max(0.0, 1 - u * u - v * v));
      return 40 + 160 * std::max(0.0, -0.35 * u - 0.35 * v + 0.87 * w);
    });
  return canvas.exposed(kBlur, kNoise, 4);
}

TEST(Touching, ShadedSpheresNameTheirDiameter) {
  const cv::Rect2d room = inner(kSide, 0.7 * kDiameter);
  const imaging::SettingsChoice touch = settings_of(spheres(at_rest(kDiameter, room, 0.75, 4)));
  EXPECT_LT(touch.tried.front().rim_px, kDiameter / 1.15);
  EXPECT_NEAR(touch.touching_px, kDiameter, 0.2);
  const std::vector<std::string> doubts = imaging::settings_doubts(touch, "exact");
  EXPECT_TRUE(std::any_of(doubts.begin(), doubts.end(), [](const std::string& said) {
    return said.find("px from their nearest neighbour") != std::string::npos &&
           said.find("--diameter 11.0") != std::string::npos;
  }));
  EXPECT_EQ(settings_of(spheres(apart(kDiameter, room, 1.5, 2))).touching_px, 0) << "they do not touch";
}

// Whose rims are sharp: their diameter is certain.
TEST(Touching, ACrystalOfPlainDiscsWithGapsIsNone) {
  for (const bool bright : {true, false}) {
    Painter canvas(kSide, bright ? 40 : kLight);
    Places places = crystal(1.3 * kDiameter, inner(kSide, 0.7 * kDiameter), 100, 2);
    for (Place& p : places) p.radius = 0.5 * kDiameter;
    paint_opaque(canvas, places, bright ? kLight : kBlack);
    for (const double noise : {kNoise, 4 * kNoise})
      EXPECT_EQ(settings_of(canvas.exposed(kBlur, noise, 2)).touching_px, 0) << bright << ' ' << noise;
  }
}

}  // namespace
}  // namespace twincell::zoo::touching_test
