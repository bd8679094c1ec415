// What the figures of the first paper derive from their runs: regions, barriers, beds that came to rest.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reproduce/is_arrested.hpp"
#include "reproduce/p1_sweep.hpp"
#include "reproduce/reproduction.hpp"

namespace twincell::reproduce::targets_test {
namespace {

TEST(Targets, ABedThatRearrangedOnceCameToRest) {
  // From a bed of 20 layers at Gamma = 2.2: tracers separate during the first cycles and then keep their
  // distance.
  std::vector<double> once(200, 1.44);
  for (std::size_t j = 0; j < 10; ++j) once[j] = 0.14 * static_cast<double>(j);
  EXPECT_TRUE(is_arrested(once));
  once[150] = 1.53;
  EXPECT_TRUE(is_arrested(once));
  once[150] = 1.55;
  EXPECT_FALSE(is_arrested(once));
  once[150] = std::nan("");
  EXPECT_TRUE(is_arrested(once));
  // In a convecting bed tracers separate as in diffusion.
  std::vector<double> on;
  for (int j = 0; j < 200; ++j) on.push_back(std::sqrt(0.1 * j));
  EXPECT_FALSE(is_arrested(on));
  EXPECT_FALSE(is_arrested({1, 1, 1}));
  EXPECT_FALSE(is_arrested({}));
  EXPECT_FALSE(is_arrested(std::vector<double>(10, std::nan(""))));
}

/// A crystal whose slip probability follows the paper's barriers: no slips up to K_m = 6, barrier 130 up to
/// 9, barrier 7 above.
std::vector<SweepRun> paper_like_crystal() {
  std::vector<SweepRun> runs;
  for (const double gamma :
       {1.1, 1.4, 1.8, 2.2, 2.4, 2.5, 2.6, 2.7, 2.8, 2.9, 3.1, 3.3, 3.6, 4.0, 4.5, 5.0}) {
    const double k_m = gamma * gamma, trials = 1e9;
    const double p_s = k_m < 6 ? 0 : k_m < 9 ? std::exp(-130 / k_m + 130. / 9 - 7. / 9) : std::exp(-7 / k_m);
    runs.push_back({gamma, exact(1e-4 * k_m), gamma > 1.16 ? 1.0 : 0.0, k_m < 9 ? 0.1 : 2.0,
                    std::round(p_s * trials), trials});
  }
  return runs;
}

TEST(Targets, TheSweepFindsTheRegionsAndBarriersThatWerePutIn) {
  auto runs = paper_like_crystal();
  std::reverse(runs.begin(), runs.end());  // the order of the runs must not matter
  const StrengthSweep sweep = make_strength_sweep("crystal_a", runs);
  ASSERT_TRUE(sweep.first_slips && sweep.convection);
  EXPECT_NEAR(*sweep.first_slips->low, 2.4 * 2.4, 1e-12);
  EXPECT_NEAR(*sweep.first_slips->high, 2.5 * 2.5, 1e-12);
  EXPECT_GT(sweep.convection->value, 2.9 * 2.9);
  EXPECT_LT(sweep.convection->value, 3.1 * 3.1);
  std::vector<calibration::DataPoint> a2, b;
  for (const SweepPoint& r : sweep.points)
    if (r.slips > 0) (r.k_m() < sweep.convection->value ? a2 : b).push_back({r.k_m(), r.p_s(), 0, 0});
  const auto steep = fitted("arrhenius", a2), flat = fitted("arrhenius", b);
  ASSERT_TRUE(steep && flat);
  EXPECT_NEAR(parameter(*steep, "E_b").value, 130, 1e-3);
  EXPECT_NEAR(parameter(*flat, "E_b").value, 7, 1e-3);
  EXPECT_FALSE(fitted("arrhenius", {a2.front()}));
}

TEST(Targets, ASweepWithSlipsFromTheFirstBouncingPointHasNoRegionA1) {
  auto runs = paper_like_crystal();
  for (SweepRun& run : runs)
    if (run.gamma > 1.16) run.slips = std::max(run.slips, 1.0);
  EXPECT_FALSE(make_strength_sweep("crystal_a", runs).first_slips);
  EXPECT_FALSE(make_strength_sweep("crystal_a", {}).first_slips);
  EXPECT_FALSE(make_strength_sweep("crystal_a", {}).convection);
}

// One height has the barriers that the paper states, the other one slips from the first bouncing point on.
TEST(Targets, OfSeveralHeightsTheOneThatMeetsMostCounts) {
  auto slipping = paper_like_crystal();
  for (SweepRun& run : slipping)
    if (run.gamma > 1.16) run.slips = std::max(run.slips, 1.0);
  const HeightSweeps other{20, make_strength_sweep("random", {}), make_strength_sweep("crystal_a", slipping)},
      paper{40, make_strength_sweep("random", {}), make_strength_sweep("crystal_a", paper_like_crystal())};
  const StrengthSweeps both{.heights = {other, paper}};
  ASSERT_EQ(counted_height(both), 1);
  EXPECT_EQ(counted_height({.heights = {paper, other}}), 0);
  EXPECT_EQ(counted_height({.heights = {paper, paper}}), 0);
  const auto counted = targets_at_heights(both, slip_targets), alone = slip_targets(paper);
  ASSERT_EQ(counted.size(), alone.size());
  for (std::size_t k = 0; k < counted.size(); ++k) {
    EXPECT_EQ(counted[k].name, alone[k].name);
    EXPECT_EQ(counted[k].verdict, alone[k].verdict) << counted[k].name;
    EXPECT_NE(counted[k].measured.find("N_l = 20: "), std::string::npos) << counted[k].measured;
    EXPECT_NE(counted[k].measured.find("; N_l = 40: " + alone[k].measured), std::string::npos)
        << counted[k].measured;
  }
  const StrengthSweeps one{.heights = {paper}};
  EXPECT_EQ(targets_at_heights(one, slip_targets).front().measured, alone.front().measured);
}

}  // namespace
}  // namespace twincell::reproduce::targets_test
