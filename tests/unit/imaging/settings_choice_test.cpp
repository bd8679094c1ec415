// Choice among settings by their evidence.
#include "imaging/settings/settings_choice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace twincell::imaging::settings_choice_test {
namespace {

TriedSettings tried(double diameter, double evidence, std::size_t beads, std::vector<double> others = {}) {
  FoundSettings settings;
  settings.diameter_px = diameter;
  settings.other_diameters_px = std::move(others);
  return {settings, evidence, beads, 0, 0, {}};
}

double chosen(std::vector<TriedSettings> all) {
  const SettingsChoice choice = choose(std::move(all));
  return choice.tried.empty() ? 0 : choice.tried.front().settings.diameter_px;
}

TEST(SettingsChoice, LargestEvidenceWinsUnlessThePreferredSuffice) {
  EXPECT_EQ(chosen({tried(10, 1000, 10), tried(20, 1240, 5)}), 10);
  EXPECT_EQ(chosen({tried(10, 1000, 10), tried(20, 1260, 5)}), 20);
  EXPECT_EQ(chosen({tried(10, -1, 10), tried(20, 26, 5)}), 20);
  EXPECT_EQ(chosen({tried(10, 0, 10), tried(20, 24, 5)}), 0);
  EXPECT_EQ(chosen({}), 0);
}

// Bright discs may be highlights: wider ones with a common profile that explain a little more are the beads.
TEST(SettingsChoice, WiderDiscsReplaceTheirHighlights) {
  const auto bright = [](double diameter, double evidence, std::size_t beads) {
    TriedSettings t = tried(diameter, evidence, beads);
    t.settings.bright = true;
    t.settings.method = "profile";
    return t;
  };
  EXPECT_EQ(chosen({bright(10, 1000, 100), bright(20, 1060, 100)}), 20);
  EXPECT_EQ(chosen({bright(10, 1000, 100), bright(20, 1060, 70)}), 20) << "spots between the beads";
  EXPECT_EQ(chosen({bright(10, 1000, 100), bright(20, 1040, 100)}), 10);
  EXPECT_EQ(chosen({bright(10, 1000, 100), bright(20, 1060, 30)}), 10) << "other discs";
  EXPECT_EQ(chosen({bright(10, 1000, 100), bright(11, 1060, 100)}), 10) << "the same discs";
  EXPECT_EQ(chosen({bright(10, 1000, 100), tried(20, 1060, 100)}), 10);
}

// A further size must gain the share of three discs.
TEST(SettingsChoice, AFurtherSizeMustGain) {
  EXPECT_EQ(choose({tried(10, 10000, 100), tried(10, 10290, 105, {14})})
                .tried[0]
                .settings.other_diameters_px.size(),
            0U);
  EXPECT_EQ(choose({tried(10, 10000, 100), tried(10, 10500, 105, {14})})
                .tried[0]
                .settings.other_diameters_px.size(),
            1U);
}

// What is not round is never chosen, however much it explains, and no other discs are its runner-up.
TEST(SettingsChoice, OnlyRoundDiscsAreChosen) {
  TriedSettings squares = tried(10, 5000, 10);
  squares.rim_variation = 0.09;
  EXPECT_EQ(chosen({squares, tried(20, 2600, 5), tried(30, 2500, 5)}), 20);
  const SettingsChoice choice = choose({squares, tried(20, 2600, 5)});
  EXPECT_EQ(choice.tried[1].not_chosen,
            "not round: levels at the rims vary by 0.09 with the direction, those of beads by at most 0.03");
  EXPECT_EQ(runner_up(choice), 0U);
  EXPECT_TRUE(choice.refused.empty());
  TriedSettings hexagons = tried(10, 5000, 10);
  hexagons.rim_shift = 0.0312;
  EXPECT_EQ(choose({hexagons, tried(20, 2600, 5)}).tried[1].not_chosen,
            "not round: rims deviate from circles by 0.031 radii, those of beads by at most 0.028");
  // Round parts of objects that explain twice as much are no beads.
  const SettingsChoice none = choose({squares, tried(20, 2400, 5)});
  EXPECT_TRUE(none.tried.empty());
  ASSERT_NE(not_round(none), nullptr);
  EXPECT_EQ(not_round(none)->rim_variation, 0.09);
  squares.evidence = 40;  // 4 nats a disc: no sign of anything
  EXPECT_EQ(not_round(choose({squares})), nullptr);
}

// If none are chosen, each says why, those that are not round first.
TEST(SettingsChoice, WhatIsRefusedSaysWhy) {
  TriedSettings squares = tried(10, 5000, 10);
  squares.rim_variation = 0.09;
  const SettingsChoice none = choose({tried(20, 2400, 5), tried(30, 4, 1), squares, tried(40, 2450, 9)});
  ASSERT_EQ(none.refused.size(), 4U);
  std::vector<double> diameters;
  std::vector<std::string> reasons;
  for (const TriedSettings& t : none.refused) {
    diameters.push_back(t.settings.diameter_px);
    reasons.push_back(t.not_chosen);
  }
  EXPECT_EQ(diameters, (std::vector<double>{10, 40, 20, 30}));
  EXPECT_EQ(reasons[0].substr(0, 10), "not round:");
  EXPECT_EQ(reasons[1], "less than 0.5 of the evidence of what is not round");
  EXPECT_EQ(reasons[2], reasons[1]);
  EXPECT_EQ(reasons[3], "less than 5 nats a bead");
}

// Settings with more evidence than the chosen ones say why they were not chosen, and only they do.
TEST(SettingsChoice, MoreEvidenceIsExplained) {
  const auto reason = [](const SettingsChoice& choice) { return choice.tried.at(1).not_chosen; };
  EXPECT_EQ(reason(choose({tried(10, 1000, 10), tried(20, 1240, 5)})),
            "less than 1.25 times the evidence of the preferred ones");
  EXPECT_EQ(reason(choose({tried(10, 1000, 100), tried(20, 1500, 50)}, kMinAdvantageInCrystal)),
            "less than 1.6 times the evidence of the preferred ones, because the gaps of a crystal resemble "
            "each other "
            "as its discs do");
  EXPECT_EQ(choose({tried(10, 1000, 100), tried(20, 1700, 50)}, kMinAdvantageInCrystal).tried[0].evidence,
            1700);
  EXPECT_EQ(reason(choose({tried(40, 1000, 100), tried(10, 9000, 300)})),
            "less than half of the area of the preferred ones");
  EXPECT_EQ(reason(choose({tried(10, 10000, 100), tried(10, 10290, 105, {14})})),
            "a further size gains less than three discs");
  EXPECT_EQ(reason(choose({tried(10, 1000, 10), tried(20, 900, 5)})), "");
}

TEST(SettingsChoice, RunnerUpHasOtherDiscs) {
  const SettingsChoice clear = choose({tried(10, 1000, 100), tried(10.5, 990, 101), tried(16, 500, 60)});
  EXPECT_EQ(clear.tried[runner_up(clear)].settings.diameter_px, 16);
  EXPECT_EQ(narrow_runner_up(clear), 0U);
  const SettingsChoice narrow = choose({tried(10, 1000, 100), tried(16, 950, 60)});
  EXPECT_EQ(narrow.tried[narrow_runner_up(narrow)].settings.diameter_px, 16);
  TriedSettings profile = tried(16, 990, 100);
  profile.settings.method = "profile";
  EXPECT_EQ(runner_up(choose({tried(10, 1000, 100), profile})), 0U) << "the same discs, which have no rim";
  profile.beads = 50;
  EXPECT_EQ(runner_up(choose({tried(10, 1000, 100), profile})), 1U);
  EXPECT_EQ(runner_up(choose({tried(10, 1000, 100), tried(10.5, 990, 101)})), 0U);
  EXPECT_EQ(runner_up(choose({tried(10, 1000, 100), tried(10.5, 990, 90)})), 0U) << "some of the same discs";
  EXPECT_EQ(runner_up(choose({tried(10, 1000, 100), tried(10.5, 990, 110)})), 1U) << "more discs";
  EXPECT_EQ(runner_up(choose({tried(10, 1000, 100), tried(10.5, 1010, 90)})), 1U) << "more evidence";
  EXPECT_EQ(runner_up(choose({tried(10, 1040, 101, {60}), tried(10, 1000, 100)})), 0U) << "without one disc";
  EXPECT_EQ(runner_up(choose({tried(10, 1400, 110, {14}), tried(10, 1000, 100)})), 1U);
}

}  // namespace
}  // namespace twincell::imaging::settings_choice_test
