// Phase boundaries, from runs whose phases are set by hand.
#include "analysis/runs/phase_boundaries.hpp"

#include <gtest/gtest.h>

namespace twincell::analysis::phase_boundaries_test {
namespace {

Run run(Side side, double gamma, BedPhase phase, double n_l = 20, const std::string& start = {}) {
  Run r;
  r.side = side;
  r.gamma = gamma;
  r.phase = phase;
  r.n_l = n_l;
  r.start = start;
  return r;
}

const PhaseBoundary* find(const std::vector<PhaseBoundary>& all, Side side, BedPhase onset,
                          const std::string& start = {}) {
  for (const PhaseBoundary& b : all)
    if (b.side == side && b.onset == onset && b.start == start) return &b;
  return nullptr;
}

constexpr auto kRest = BedPhase::co_moving, kBounce = BedPhase::bouncing, kFlow = BedPhase::convecting;

}  // namespace

TEST(Boundaries, LieBetweenTheStrongestWithoutAndTheWeakestWith) {
  const auto all = find_boundaries({run(Side::experiment, 0.9, kRest), run(Side::experiment, 1.1, kRest),
                                    run(Side::experiment, 1.5, kBounce), run(Side::experiment, 2.5, kFlow),
                                    run(Side::simulation, 3, kBounce)});
  const PhaseBoundary* bounce = find(all, Side::experiment, kBounce);
  ASSERT_NE(bounce, nullptr);
  EXPECT_DOUBLE_EQ(bounce->gamma().value(), 1.3);
  EXPECT_DOUBLE_EQ(bounce->half_width().value(), 0.2);
  EXPECT_EQ(boundary_text(*bounce), "between 1.1 and 1.5");
  const PhaseBoundary* flow = find(all, Side::experiment, kFlow);
  EXPECT_DOUBLE_EQ(flow->gamma().value(), 2.0);
  EXPECT_EQ(boundary_text(*find(all, Side::simulation, kFlow)), "above 3");
  EXPECT_EQ(boundary_text(*find(all, Side::simulation, kBounce)), "below 3");
  EXPECT_FALSE(find(all, Side::simulation, kFlow)->gamma());
}

TEST(Boundaries, SeedsThatDisagreeAtTheLastStrengthBracketNothing) {
  const auto all = find_boundaries({run(Side::simulation, 1.5, kBounce), run(Side::simulation, 2.1, kBounce),
                                    run(Side::simulation, 2.1, kFlow)});
  const PhaseBoundary* flow = find(all, Side::simulation, kFlow);
  EXPECT_TRUE(flow->overlap);
  EXPECT_FALSE(flow->gamma());
  EXPECT_EQ(boundary_text(*flow), "above 1.5");
  const auto first = find_boundaries({run(Side::simulation, 2.1, kBounce), run(Side::simulation, 2.1, kFlow),
                                      run(Side::simulation, 3, kFlow)});
  EXPECT_EQ(boundary_text(*find(first, Side::simulation, kFlow)), "below 3");
  const auto nowhere = find_boundaries({run(Side::simulation, 2, kFlow), run(Side::simulation, 2.4, kBounce),
                                        run(Side::simulation, 2.4, kFlow)});
  EXPECT_EQ(boundary_text(*find(nowhere, Side::simulation, kFlow)), "undetermined (runs differ)");
}

TEST(Boundaries, WhereSeedsDisagreeTheBracketReachesToTheNextThatAgree) {
  const auto all = find_boundaries({run(Side::simulation, 1.6, kBounce), run(Side::simulation, 2.5, kBounce),
                                    run(Side::simulation, 2.5, kFlow), run(Side::simulation, 3.1, kFlow)});
  const PhaseBoundary* flow = find(all, Side::simulation, kFlow);
  EXPECT_TRUE(flow->overlap);
  EXPECT_NEAR(flow->gamma().value(), (1.6 + 3.1) / 2, 1e-12);
  EXPECT_NEAR(flow->half_width().value(), (3.1 - 1.6) / 2, 1e-12);
}

TEST(Boundaries, LayersAndStartsAreKeptApartAndTheUndeterminedLeftOut) {
  const auto all = find_boundaries(
      {run(Side::simulation, 1, kRest, 20, "random"), run(Side::simulation, 2, kFlow, 21, "random"),
       run(Side::simulation, 2, kFlow, 40, "random"), run(Side::simulation, 2, kFlow, 20, "crystal_a"),
       run(Side::simulation, 1.5, BedPhase::undetermined, 20, "random")});
  std::size_t flows = 0;
  for (const PhaseBoundary& b : all) flows += b.onset == kFlow ? 1 : 0;
  EXPECT_EQ(flows, 3U);
  const PhaseBoundary* random = find(all, Side::simulation, kFlow, "random");
  EXPECT_EQ(random->n_runs, 2U);
  EXPECT_DOUBLE_EQ(random->n_l, 20.5);
  EXPECT_EQ(boundary_of(*random), "simulation (random)");
}

}  // namespace twincell::analysis::phase_boundaries_test
