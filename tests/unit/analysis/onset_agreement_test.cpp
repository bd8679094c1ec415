// Sentences on onsets of both sides.
#include "analysis/runs/onset_agreement.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace twincell::analysis::onset_agreement_test {
namespace {

PhaseBoundary onset(Side side, std::optional<double> below, std::optional<double> above, double n_l = 10) {
  return {
      .side = side, .onset = BedPhase::convecting, .n_l = n_l, .n_runs = 3, .below = below, .above = above};
}

std::string said(const std::vector<PhaseBoundary>& boundaries) {
  return fmt::format("{}", fmt::join(onset_sentences(boundaries), " "));
}

TEST(OnsetAgreement, IntervalsWithACommonPointAreCompatible) {
  const PhaseBoundary e = onset(Side::experiment, 1.6, 2.5);
  EXPECT_EQ(agreement_of(e, onset(Side::simulation, 2.49, 3)), OnsetAgreement::compatible);
  // At 2.5 the one bed convects and the other one does not.
  EXPECT_EQ(agreement_of(e, onset(Side::simulation, 2.5, 3)), OnsetAgreement::different);
  EXPECT_EQ(agreement_of(onset(Side::experiment, {}, 0.16), onset(Side::simulation, 0.16, {})),
            OnsetAgreement::different);
  EXPECT_EQ(agreement_of(e, onset(Side::simulation, 2.51, 3)), OnsetAgreement::different);
  EXPECT_EQ(agreement_of(e, onset(Side::simulation, 1, 1.59)), OnsetAgreement::different);
  EXPECT_EQ(agreement_of(e, onset(Side::simulation, 2, {})), OnsetAgreement::compatible);
  EXPECT_EQ(agreement_of(e, onset(Side::simulation, 2.6, {})), OnsetAgreement::different);
  EXPECT_EQ(agreement_of(e, onset(Side::simulation, {}, 1.5)), OnsetAgreement::different);
  EXPECT_EQ(agreement_of(e, onset(Side::simulation, {}, {})), OnsetAgreement::unknown);
}

TEST(OnsetAgreement, TheSentenceStatesBothIntervals) {
  EXPECT_EQ(said({onset(Side::experiment, 1.6, 2.5), onset(Side::simulation, 2.6, {})}),
            "Onset of convection: Gamma between 1.6 and 2.5 in the experiment and above 2.6 in the "
            "simulation, different.");
}

TEST(OnsetAgreement, LimitsOnTheSameSideGiveNoStatement) {
  PhaseBoundary twins = onset(Side::simulation, 1.6, {});
  twins.start = "trajectory";
  EXPECT_EQ(said({onset(Side::experiment, 1.6, {}), twins}),
            "Onset of convection: Gamma above 1.6 in the experiment and above 1.6 in the twins, not "
            "bracketed on either side.");
}

TEST(OnsetAgreement, BedsOfOtherHeightsAreNotCompared) {
  EXPECT_EQ(said({onset(Side::experiment, 1.6, 2.5), onset(Side::simulation, 2.6, 3, 20)}), "");
}

TEST(OnsetAgreement, HeightsAreNamedIfThereAreSeveral) {
  const auto both = [](double below, double n_l) {
    return std::vector{onset(Side::experiment, below, 2.5, n_l), onset(Side::simulation, 1.5, 2.5, n_l)};
  };
  const auto joined = [](std::vector<PhaseBoundary> a, const std::vector<PhaseBoundary>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return said(a);
  };
  EXPECT_EQ(joined(both(1.5, 6), both(1.5, 10)),
            "Onset of convection at N_l = 6 and 10: Gamma between 1.5 and 2.5 in the experiment and between "
            "1.5 and 2.5 in the "
            "simulation, compatible.");
  const std::string apart = joined(both(1.5, 6), both(1.7, 10));
  EXPECT_NE(apart.find("at N_l = 6: Gamma between 1.5 and 2.5 in the experiment"), std::string::npos)
      << apart;
  EXPECT_NE(apart.find("at N_l = 10: Gamma between 1.7 and 2.5 in the experiment"), std::string::npos)
      << apart;
}

TEST(OnsetAgreement, ASweepIsUsedWithoutTwins) {
  PhaseBoundary sweep = onset(Side::simulation, 2, 2.2);
  sweep.sweep = true;
  EXPECT_NE(said({onset(Side::experiment, 1.6, 2.5), sweep}).find("in the sweep, compatible"),
            std::string::npos);
  EXPECT_EQ(said({onset(Side::experiment, 1.6, 2.5), sweep, onset(Side::simulation, 2.6, 3)}).find("sweep"),
            std::string::npos);
}

}  // namespace
}  // namespace twincell::analysis::onset_agreement_test
