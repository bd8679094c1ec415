// Matte spheres in front of a dark ground: their levels fall towards the rims, as the cosine of the angle
// between the light and the surface.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "imaging/locate/locator.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/settings/settings_doubts.hpp"
#include "tests/support/one_picture.hpp"
#include "tests/zoo/imaging/kinds.hpp"

namespace twincell::zoo::shaded_test {
namespace {

struct Shaded {
  std::vector<imaging::Detection> beads;
  std::string doubts;
};

Shaded located_shaded(const cv::Mat1b& picture) {
  imaging::OnePicture stack(picture);
  imaging::FramesAhead ahead(stack);
  imaging::LocatorOptions open;
  open.polarity_known = false;
  const imaging::LocatorConfiguration settings = imaging::configure_locator(ahead, open);
  Shaded found{imaging::locate(picture, settings.locator).beads, {}};
  for (const std::string& doubt : imaging::settings_doubts(settings.choice, "exact"))
    found.doubts += doubt + "\n";
  return found;
}

/// Spheres lit from the direction (-across, -across, 1) to the camera.
cv::Mat1b matte(const Places& places, int side, double across) {
  Painter canvas(side, 25);
  for (const Place& p : places)
    canvas.disc(p.x, p.y, p.radius, [&](double u, double v, double) {
      const double w = std::sqrt(std::max(0.0, 1 - u * u - v * v));
      return 45 + 150 * std::max(0.0, w - across * (u + v)) / std::sqrt(1 + 2 * across * across);
    });
  return canvas.exposed(0.8, kNoise, 3);
}

/// Beads of two sizes at rest, half of each.
Places two_sizes_at_rest(double diameter, double ratio, int side) {
  std::mt19937_64 random(4);
  const auto n = static_cast<std::size_t>(0.5 * side * side / (diameter * diameter * (1 + ratio * ratio)));
  std::vector<double> radii(n, 0.5 * diameter);
  radii.resize(2 * n, 0.5 * ratio * diameter);
  std::shuffle(radii.begin(), radii.end(), random);
  Places places;
  for (const Place& p : places_of(imaging::rendered::deposited(radii, inner(side, diameter), random)))
    if (p.y - p.radius > diameter) places.push_back(p);
  return places;
}

/// Number of beads with a disc of about their size within a fifth of their radius. The light shifts centres
/// and makes spheres seem smaller.
std::size_t seen(const std::vector<imaging::Detection>& beads, const Places& places) {
  return static_cast<std::size_t>(std::count_if(places.begin(), places.end(), [&](const Place& p) {
    return std::any_of(beads.begin(), beads.end(), [&](const imaging::Detection& b) {
      return std::hypot(b.x - p.x, b.y - p.y) < 0.2 * p.radius && std::abs(b.radius / p.radius - 0.9) < 0.14;
    });
  }));
}

// Before, only those of one size were found.
TEST(ShadedSpheres, OfTwoSizesAreFound) {
  constexpr double kDiameter = 18, kRatio = 1.4;
  constexpr int kSide = 306;
  const Places places = two_sizes_at_rest(kDiameter, kRatio, kSide);
  const Shaded found = located_shaded(matte(places, kSide, 0.25));
  std::printf("shaded spheres of %g and %g px: %zu of %zu, %zu discs\n", kDiameter, kRatio * kDiameter,
              seen(found.beads, places), places.size(), found.beads.size());
  EXPECT_GE(places.size(), 80U);
  EXPECT_EQ(seen(found.beads, places), places.size());
  EXPECT_EQ(found.beads.size(), places.size());
}

// Large ones do not seem round among their neighbours, so that only one size is located. The doubt names the
// options that locate both.
TEST(ShadedSpheres, OfTwoLargeSizesAreDoubted) {
  constexpr double kDiameter = 24, kRatio = 1.4;
  constexpr int kSide = 408;
  const Places places = two_sizes_at_rest(kDiameter, kRatio, kSide);
  const cv::Mat1b picture = matte(places, kSide, 0.2);
  const std::string doubts = located_shaded(picture).doubts, named = "with that of --diameter ";
  const std::size_t at = doubts.find(named);
  ASSERT_NE(doubts.find("of several sizes"), std::string::npos) << doubts;
  ASSERT_NE(at, std::string::npos);
  imaging::LocatorOptions stated;
  stated.preprocess.bright = true;
  const std::size_t end = at + named.size();
  std::size_t used = 0;
  stated.diameter_px = std::stod(doubts.substr(end), &used);
  stated.other_diameters_px = {std::stod(doubts.substr(end + used))};
  EXPECT_EQ(seen(imaging::locate(picture, stated).beads, places), places.size()) << doubts;
}

// Light from one side moves the fitted centres by some standard deviations, all alike, without larger errors.
TEST(ShadedSpheres, AreDoubtedIfLitFromOneSide) {
  const std::string lit = "lit from one side";
  constexpr int kSide = 240;
  const Places places = at_rest(15, inner(kSide, 10), 0.7, 4);
  EXPECT_NE(located_shaded(matte(places, kSide, 0.3)).doubts.find(lit), std::string::npos);
  EXPECT_EQ(located_shaded(matte(places, kSide, 0)).doubts.find(lit), std::string::npos);
  // A highlight well inside the rim moves nothing.
  Painter canvas(kSide, kLight);
  for (const Place& p : places)
    canvas.disc(p.x, p.y, p.radius, [](double u, double v, double) {
      return 25 + 150 * std::exp(-((u + 0.25) * (u + 0.25) + (v + 0.3) * (v + 0.3)) / 0.03);
    });
  EXPECT_EQ(located_shaded(canvas.exposed(0.8, kNoise, 4)).doubts.find(lit), std::string::npos);
}

}  // namespace
}  // namespace twincell::zoo::shaded_test
