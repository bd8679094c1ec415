// One large disc among small beads, as in experiments on the Brazil-nut effect, and beds in which few beads
// are of the size of most: located without options.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "imaging/locate/locator.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/settings/settings_doubts.hpp"
#include "tests/support/one_picture.hpp"
#include "tests/zoo/imaging/kinds.hpp"

namespace twincell::zoo::intruder_test {
namespace {

struct Found {
  std::vector<imaging::Detection> beads;
  std::string doubts;
};

Found located(const cv::Mat1b& picture) {
  imaging::OnePicture stack(picture);
  imaging::FramesAhead ahead(stack);
  imaging::LocatorOptions open;
  open.polarity_known = false;
  const imaging::LocatorConfiguration settings = imaging::configure_locator(ahead, open);
  Found found{imaging::locate(picture, settings.locator).beads, {}};
  for (const std::string& doubt : imaging::settings_doubts(settings.choice, "exact"))
    found.doubts += doubt + "\n";
  return found;
}

/// Number of beads whose centre and radius are found to a tenth of the radius.
std::size_t right(const std::vector<imaging::Detection>& beads, const Places& places) {
  return static_cast<std::size_t>(std::count_if(places.begin(), places.end(), [&](const Place& p) {
    return std::any_of(beads.begin(), beads.end(), [&](const imaging::Detection& b) {
      return std::hypot(b.x - p.x, b.y - p.y) < 0.1 * p.radius &&
             std::abs(b.radius - p.radius) < 0.1 * p.radius;
    });
  }));
}

/// Small beads at rest around a large disc that hides none of them.
Places around(const Place& large, double diameter, int side) {
  Places places = {large};
  for (const Place& p : at_rest(diameter, inner(side, diameter), 0.9, 5))
    if (std::hypot(p.x - large.x, p.y - large.y) > p.radius + large.radius) places.push_back(p);
  return places;
}

// Before, it was left out without a word: one disc of a size has no weight in the search for sizes.
TEST(Intruder, IsFoundAmongSmallBeads) {
  constexpr int kSide = 320;
  for (const double diameter : {10.0, 16.0})
    for (const double times : {2.5, 5.0}) {
      const Places places = around({0.5 * kSide, 0.62 * kSide, 0.5 * times * diameter}, diameter, kSide);
      Painter canvas(kSide, kLight);
      paint_opaque(canvas, places);
      const Found found = located(canvas.exposed(kBlur, kNoise, 5));
      EXPECT_EQ(right(found.beads, places), places.size()) << diameter << " px, " << times << " times";
      EXPECT_EQ(found.beads.size(), places.size());
      EXPECT_EQ(found.doubts.find("no bead explains"), std::string::npos) << found.doubts;
    }
}

// A bright one among dark beads is not located with them. The doubt names its place and its size.
TEST(Intruder, IsDoubtedIfItDoesNotLookLikeTheBeads) {
  constexpr int kSide = 320;
  const Place large{150, 190, 32};
  const Places places = around(large, 14, kSide);
  Painter canvas(kSide, 130);
  paint_opaque(canvas, {places.begin() + 1, places.end()});
  canvas.disc(large.x, large.y, large.radius,
              [](double u, double v, double) { return 230 - 40 * (u * u + v * v); });
  const Found found = located(canvas.exposed(kBlur, kNoise, 6));
  EXPECT_EQ(found.beads.size(), places.size() - 1);
  EXPECT_NE(found.doubts.find("larger than the beads: 64 px wide at (150, 190):"), std::string::npos)
      << found.doubts;
}

// Before, those below 0.8 and above 1.2 of the mean were left out, 1 of 20.
TEST(BroadSizes, AllBeadsAreFound) {
  constexpr int kSide = 420, kLeftOut = 150;
  constexpr double kDiameter = 18, kSpread = 0.11;
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  std::vector<double> radii;
  for (int k = 0; k < 330; ++k)
    radii.push_back(0.5 * kDiameter * (1 + kSpread * std::clamp(normal(random), -2.7, 2.7)));
  Places places;  // of the lower left part of the packing
  for (const Place& p : places_of(imaging::rendered::deposited(radii, inner(kSide, kDiameter), random)))
    if (p.x < kSide - kLeftOut - kDiameter && p.y > kLeftOut + kDiameter)
      places.push_back({p.x, p.y - kLeftOut, p.radius});
  EXPECT_GE(std::count_if(places.begin(), places.end(),
                          [](const Place& p) { return std::abs(2 * p.radius / kDiameter - 1) > 0.2; }),
            5);
  Painter canvas(kSide - kLeftOut, kLight);
  paint_opaque(canvas, places);
  const Found found = located(canvas.exposed(kBlur, kNoise, 7));
  EXPECT_EQ(right(found.beads, places), places.size());
  EXPECT_EQ(found.beads.size(), places.size());
}

// Two layers that cover half of the picture each, of beads that let half of the light through. Before, the
// picture was refused, as discs of one layer that are fitted to it are not round.
TEST(TwoLayers, AreFoundInADenseProjection) {
  constexpr int kSide = 200;
  constexpr double kDiameter = 16;
  Places places = apart(kDiameter, inner(kSide, kDiameter), 1.25, 31);
  for (const Place& p : apart(kDiameter, inner(kSide, 0.7 * kDiameter), 1.25, 32)) places.push_back(p);
  Painter canvas(kSide, kLight);
  for (const Place& p : places)
    canvas.disc(p.x, p.y, p.radius, [](double, double, double below) { return 0.55 * below; });
  const Found found = located(canvas.exposed(kBlur, kNoise, 9));
  const double recall = static_cast<double>(right(found.beads, places)) / static_cast<double>(places.size());
  std::printf("%zu beads in two layers: %zu found, recall %.3f\n", places.size(), found.beads.size(), recall);
  EXPECT_GE(recall, 0.97);
  EXPECT_LE(found.beads.size(), places.size());
}

}  // namespace
}  // namespace twincell::zoo::intruder_test
