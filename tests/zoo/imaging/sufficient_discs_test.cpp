// Plain discs that explain nearly all of a picture are chosen without a trial of the other models. Where
// something is left to explain, the others are tried.

#include <gtest/gtest.h>

#include "imaging/settings/auto_configuration.hpp"
#include "tests/zoo/imaging/kinds.hpp"

namespace twincell::zoo::sufficient_discs_test {
namespace {

imaging::SettingsChoice choice_on(const Exhibit& exhibit) {
  imaging::LocatorOptions open;
  open.polarity_known = false;
  return imaging::choose_settings(exhibit.picture, open);
}

TEST(SufficientDiscs, AreChosenAlone) {
  for (const double diameter : {14.0, 20.0}) {
    const imaging::SettingsChoice choice = choice_on(opaque(diameter));
    ASSERT_EQ(choice.tried.size(), 1U) << diameter;
    EXPECT_TRUE(choice.suffices) << diameter;
    EXPECT_NEAR(choice.tried.front().settings.diameter_px, diameter, 0.02 * diameter);
    EXPECT_FALSE(choice.tried.front().settings.bright) << diameter;
  }
}

TEST(SufficientDiscs, AreNotThoseThatLeaveSomething) {
  for (const Exhibit& exhibit : {clear(14), steel(14), two_layers(14), photoelastic(40)}) {
    const imaging::SettingsChoice choice = choice_on(exhibit);
    EXPECT_FALSE(choice.suffices);
    EXPECT_GT(choice.tried.size(), 1U);
  }
}

/// A crystal of which only the middles of the beads are seen, as on steel beads under a ring of lamps.
Exhibit crystal_of_middles(double diameter) {
  constexpr double kDark = 12, kLit = 150, kMiddle = 0.7;
  Painter canvas(side_of(diameter), kDark);
  const Places places = crystal(diameter, inner(canvas.side(), 0.7 * diameter), 1000, 3);
  for (const Place& p : places)
    canvas.disc(p.x, p.y, kMiddle * p.radius, [&](double, double, double) { return kLit; });
  return {canvas.exposed(kBlur, kNoise, 3), truth_of(places)};
}

TEST(SufficientDiscs, AreNotTheMiddlesOfTheBeadsOfACrystal) {
  const imaging::SettingsChoice choice = choice_on(crystal_of_middles(12));
  EXPECT_FALSE(choice.suffices);
  EXPECT_GT(choice.tried.size(), 1U);
}

}  // namespace
}  // namespace twincell::zoo::sufficient_discs_test
