// Crystals of small beads that fill the picture, with vacancies, located without options. The gaps between
// such beads are weak, and the vacancies are the strongest objects of the picture.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "imaging/benchmark/score.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/settings/auto_configuration.hpp"
#include "imaging/settings/settings_choice.hpp"
#include "imaging/settings/settings_doubts.hpp"
#include "tests/zoo/imaging/kinds.hpp"

namespace twincell::zoo::vacancies_test {
namespace {

/// Side of a picture that is twenty beads wide, px; of large beads, fewer suffice.
int side_for(double diameter) {
  return static_cast<int>(std::min(20 * diameter, 240.0));
}

Exhibit crystal(double diameter, double vacancies, std::uint64_t seed, double blur = kBlur) {
  const int side = side_for(diameter);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  Places places;
  for (int row = 0; row * 0.8660254 * diameter < side + 2 * diameter; ++row)
    for (int k = 0; k * diameter < side + 2 * diameter; ++k) {
      if (uniform(random) < vacancies) continue;
      places.push_back({(k + 0.5 * (row % 2)) * diameter - 0.9 * diameter + 0.02 * normal(random),
                        0.8660254 * row * diameter - 0.8 * diameter + 0.02 * normal(random), 0.5 * diameter});
    }
  Painter canvas(side, kLight);
  paint_opaque(canvas, places);
  return {canvas.exposed(blur, kNoise, seed), truth_of(places)};
}

TEST(Vacancies, AreNotTakenForBeads) {
  for (const double diameter : {7.0, 10.0, 14.0})
    for (const double vacancies : {0.02, 0.2}) {
      const Exhibit exhibit = crystal(diameter, vacancies, 5);
      imaging::LocatorOptions open;
      open.polarity_known = false;
      const auto found = imaging::find_settings(exhibit.picture, open);
      ASSERT_TRUE(found) << diameter << ' ' << vacancies;
      std::vector<imaging::FoundBead> beads;
      for (const imaging::Detection& b :
           imaging::locate(exhibit.picture, imaging::completed(*found, open)).beads)
        beads.push_back({b.x, b.y, -1});
      const int side = side_for(diameter);
      std::vector<imaging::TruthBead> inside;
      for (imaging::TruthBead t : exhibit.truth) {
        if (t.x < -0.5 || t.y < -0.5 || t.x > side - 0.5 || t.y > side - 0.5) continue;
        t.counts = std::min({t.x, t.y, side - 1 - t.x, side - 1 - t.y}) > 0.5 * diameter;
        inside.push_back(t);
      }
      imaging::Scorer scorer;
      scorer.add(inside, beads);
      const imaging::Score score = scorer.score();
      std::printf("%2g px, %.0f %% vacancies: recall %.3f, precision %.3f, diameter %.2f px\n", diameter,
                  100 * vacancies, score.recall(), score.precision(), found->diameter_px);
      EXPECT_FALSE(found->bright) << diameter << ' ' << vacancies;
      EXPECT_GE(score.recall(), 0.95) << diameter << ' ' << vacancies;
      EXPECT_GE(score.precision(), 0.99) << diameter << ' ' << vacancies;
    }
}

// Of blurred beads of 6 px the vacancies are taken for beads, and a doubt names the crystal.
TEST(Vacancies, TakenForBeadsAreDoubted) {
  imaging::LocatorOptions open;
  open.polarity_known = false;
  const imaging::SettingsChoice choice = imaging::choose_settings(crystal(6, 0.02, 5, 0.9).picture, open);
  ASSERT_FALSE(choice.tried.empty());
  EXPECT_LT(choice.tried.front().beads, 20U);
  EXPECT_NEAR(choice.uncovered_lattice_px, 6, 0.2);
  const std::vector<std::string> doubts = imaging::settings_doubts(choice, "exact");
  EXPECT_TRUE(std::any_of(doubts.begin(), doubts.end(), [](const std::string& said) {
    return said.find("as a crystal of beads of this diameter does") != std::string::npos;
  }));
  EXPECT_EQ(imaging::choose_settings(crystal(8, 0.02, 5).picture, open).uncovered_lattice_px, 0);
}

}  // namespace
}  // namespace twincell::zoo::vacancies_test
