// Choice among settings by their evidence.
#include "imaging/settings/settings_choice.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace twincell::imaging {
namespace {

TriedSettings tried(double diameter, double evidence, std::size_t beads, std::vector<double> others = {}) {
  FoundSettings settings;
  settings.diameter_px = diameter;
  settings.other_diameters_px = std::move(others);
  return {settings, evidence, beads};
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
}

}  // namespace
}  // namespace twincell::imaging
