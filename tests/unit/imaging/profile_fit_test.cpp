// Properties of the common profile of the discs: the position of the rim, and whether it is the profile of
// plain discs.

#include "imaging/refine/profile_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace twincell::imaging::profile_fit_test {
namespace {

/// Superposed plain discs, given as (radius, level), with blurred edges.
DiscProfile profile_of(const std::vector<std::pair<double, double>>& discs, double blur) {
  DiscProfile profile;
  profile.radius_px = discs[0].first;
  for (double r = 0; r <= profile.radius_px + 6 * blur; r += 1 / DiscProfile::kPerPixel) {
    double level = 0;
    for (const auto& [radius, own] : discs)
      level += 0.5 * own * std::erfc((r - radius) / (blur * std::numbers::sqrt2));
    profile.levels.push_back(static_cast<float>(level));
  }
  profile.levels.back() = 0;
  return profile;
}

// An error function is steepest where its argument is 0.
TEST(DiscProfile, ThePlainDiscsRimIsWhereItsEdgeIs) {
  for (const double radius : {5.0, 7.3, 16.0})
    for (const double blur : {0.8, 1.5, 3.0})
      EXPECT_NEAR(profile_of({{radius, 0.9}}, blur).rim(), radius, 0.1) << radius << ' ' << blur;
}

// The rim of a body below its highlight is kept if its size is known; a disc that ends inside has another
// size.
TEST(DiscProfile, TheRimOfAKnownSizeIsNearIt) {
  DiscProfile glossy = profile_of({{6.7, 0.35}, {2.2, 0.6}}, 1.6);
  EXPECT_NEAR(glossy.rim_of_known(), 6.7, 0.35);
  DiscProfile sloping = glossy;  // no shoulder: the highlight falls most steeply
  for (std::size_t k = 0; k < sloping.levels.size(); ++k)
    sloping.levels[k] = static_cast<float>(std::max(
        0.0, 0.95 * std::exp(-0.2 * static_cast<double>(k) / 2) * (1 - static_cast<double>(k) / 2 / 9)));
  EXPECT_LT(sloping.rim(), 0.8 * 6.7);
  EXPECT_NEAR(sloping.rim_of_known(), 6.7, 0.2 * 6.7 + 0.5);
  DiscProfile small = profile_of({{6.7, 1e-3}, {2.2, 0.9}}, 0.8);
  EXPECT_NEAR(small.rim(), 2.2, 0.2);
  EXPECT_EQ(small.rim_of_known(), 0);
}

TEST(DiscProfile, PlainDiscsOfAnyBlurArePlain) {
  for (const double radius : {5.0, 7.3, 16.0})
    for (const double blur : {0.5, 0.8, 1.5, 3.0}) {
      EXPECT_LT(profile_of({{radius, 0.9}}, blur).difference_from_plain(), 1e-3) << radius << ' ' << blur;
      EXPECT_GE(profile_of({{radius, 0.9}}, blur).difference_from_plain(), 0) << radius << ' ' << blur;
    }
}

// A bright spot covers a twenty-fifth of the area of the disc, where (1 - b)^2 of the squared darkness
// remains. The best constant level leaves the fraction q (1 - q) b^2/(1 - 2 q b + q b^2) of the squares, q =
// 1/25, b = 1/2: 0.0099.
TEST(DiscProfile, ASmallSpotOfLightMakesNoOtherDisc) {
  const double unlike = profile_of({{16, 0.9}, {3.2, -0.45}}, 0.5).difference_from_plain();
  EXPECT_LT(unlike, 0.012);
  EXPECT_GT(unlike, 0.006);
}

// The same formula with q = (1 - w)^2, for a rim of width w R. It is derived for sharp edges, and blurred
// edges give nearly the same value.
TEST(DiscProfile, AHollowDiscIsUnlikeAPlainOneByItsArea) {
  const double q = 0.64, b = 0.8, sharp = q * (1 - q) * b * b / (1 - 2 * q * b + q * b * b);
  EXPECT_NEAR(profile_of({{30, 0.9}, {24, -0.72}}, 0.5).difference_from_plain(), sharp, 0.05 * sharp);
  EXPECT_NEAR(profile_of({{30, 0.9}, {24, -0.72}}, 0.5).rim(), 30, 0.1);
}

// A ring half as dark as the core still counts as the rim; a ring a tenth as dark does not.
TEST(DiscProfile, AFaintRingIsTheRim) {
  EXPECT_NEAR(profile_of({{16, 0.4}, {13, -0.4}, {8, 0.9}}, 0.6).rim(), 16, 0.2);
  EXPECT_NEAR(profile_of({{16, -0.4}, {13, 0.4}, {8, 0.9}}, 0.6).rim(), 16, 0.2);
  EXPECT_NEAR(profile_of({{16, 0.09}, {13, -0.09}, {8, 0.9}}, 0.6).rim(), 8, 0.2);
}

}  // namespace
}  // namespace twincell::imaging::profile_fit_test
