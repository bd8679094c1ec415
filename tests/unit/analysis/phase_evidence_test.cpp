// Phases, onsets and verdicts of runs whose intervals contain a threshold.
#include "analysis/runs/phase_evidence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "analysis/report/conclusion.hpp"
#include "analysis/runs/match_verdict.hpp"
#include "analysis/runs/phase_boundaries.hpp"

namespace twincell::analysis::phase_evidence_test {
namespace {

using Phases = std::vector<BedPhase>;
using Runs = std::vector<Run>;  // in the body of a test `Run` is a name of googletest

using enum BedPhase;

Result measure(const std::string& name, double low, double value, double high) {
  Result r{.name = name, .values = {value}};
  r.unit = "sigma";
  r.interval = Interval{.low = low, .high = high, .level = 0.95, .method = "set"};
  return r;
}

Run run(Side side, double gamma, const Result& s_b, const Result& s_c, const std::string& drift = "mixing") {
  Run r;
  r.side = side;
  r.gamma = gamma;
  r.n_l = 8;
  r.start = side == Side::simulation ? "trajectory" : "";
  r.phase = bed_phase(s_b.value(), s_c.value());
  r.results = {s_b, s_c, Result{.name = "drift", .text = drift}};
  return r;
}

const Result kBounces = measure("s_b", 0.8, 0.9, 1), kRests = measure("s_b", 0, 1e-4, 2e-4),
             kHolds = measure("s_c", 0, 0.04, 0.05), kConvects = measure("s_c", 2, 3, 4),
             kNearConvection = measure("s_c", 0.787, 1.175, 1.836);

}  // namespace

TEST(PhaseEvidence, AnIntervalOnOneSideOfItsThresholdDecides) {
  EXPECT_EQ(possible_phases(run(Side::simulation, 2, kBounces, kConvects)), Phases{convecting});
  EXPECT_EQ(possible_phases(run(Side::simulation, 2, kBounces, kHolds)), Phases{bouncing});
  EXPECT_EQ(possible_phases(run(Side::simulation, 2, kRests, kNearConvection)), Phases{co_moving});
  auto unknown = Runs(1).front();
  EXPECT_EQ(possible_phases(unknown), Phases{});
  unknown.phase = convecting;  // no results: a point of a sweep
  EXPECT_EQ(possible_phases(unknown), Phases{convecting});
}

TEST(PhaseEvidence, AnIntervalThatContainsAThresholdDoesNot) {
  const auto near = run(Side::simulation, 2, kBounces, kNearConvection);
  EXPECT_EQ(possible_phases(near), (Phases{bouncing, convecting}));
  EXPECT_EQ(doubt_text(near), "s_c = 1.18 [0.787, 1.84], threshold 1");
  EXPECT_EQ(evidence_of(near, bouncing), OnsetEvidence::present);
  EXPECT_EQ(evidence_of(near, convecting), OnsetEvidence::undecided);
  const auto lifts = run(Side::simulation, 1, measure("s_b", 0.02, 0.03, 0.04), kHolds);
  EXPECT_EQ(possible_phases(lifts), (Phases{co_moving, bouncing}));
  EXPECT_EQ(evidence_of(lifts, bouncing), OnsetEvidence::undecided);
  EXPECT_EQ(evidence_of(lifts, convecting), OnsetEvidence::absent);
}

TEST(PhaseEvidence, ABedThatAnnealedMayNotConvect) {
  const auto annealed = run(Side::simulation, 2, kBounces, kConvects, "annealed");
  EXPECT_EQ(possible_phases(annealed), (Phases{bouncing, convecting}));
  EXPECT_EQ(doubt_text(annealed), "s_c = 3, annealed");
  EXPECT_EQ(possible_phases(run(Side::simulation, 2, kBounces, kHolds, "annealed")), Phases{bouncing});
}

// Of 1.175 [0.787, 1.836] the threshold is 0.88 standard errors away: one or four such runs do not decide
// (0.88, 1.77), five do (1.98).
TEST(PhaseEvidence, SeedsDecideTogether) {
  const auto near = run(Side::simulation, 2, kBounces, kNearConvection),
             annealed = run(Side::simulation, 2, kBounces, kConvects, "annealed");
  const Runs runs = {near,
                     near,
                     near,
                     near,
                     near,
                     run(Side::simulation, 2, kBounces, kConvects),
                     run(Side::simulation, 2, kBounces, kHolds),
                     annealed};
  EXPECT_EQ(possible_phases(runs, {0, 1, 2, 3}), (Phases{bouncing, convecting}));
  EXPECT_EQ(possible_phases(runs, {0, 1, 2, 3, 4}), Phases{convecting});
  EXPECT_EQ(possible_phases(runs, {0, 5}), Phases{convecting});  // (0.88 + 1.96)/sqrt(2) = 2.01
  EXPECT_EQ(possible_phases(runs, {0, 7}), (Phases{bouncing, convecting}));
  EXPECT_EQ(possible_phases(runs, {5, 7}), (Phases{bouncing, convecting}));
  EXPECT_EQ(possible_phases(runs, {5, 6}), Phases{});
}

// A bouncing experiment, whose twin may convect or not.
TEST(PhaseEvidence, OnsetsAndTheConclusionLeaveAnUndecidedPointOpen) {
  Comparison c;
  c.runs = {run(Side::experiment, 1, kRests, kHolds), run(Side::experiment, 2, kBounces, kHolds),
            run(Side::simulation, 1, kRests, kHolds), run(Side::simulation, 2, kBounces, kNearConvection)};
  c.matches = match_runs(c.runs);
  c.boundaries = find_boundaries(c.runs);
  EXPECT_EQ(verdict(c.runs, c.matches.at(0)), MatchVerdict::same);
  EXPECT_EQ(verdict(c.runs, c.matches.at(1)), MatchVerdict::undecided);
  for (const PhaseBoundary& b : c.boundaries)
    if (b.onset == convecting && b.side == Side::simulation) {
      EXPECT_EQ(b.below, 1);
      EXPECT_FALSE(b.above);
      EXPECT_EQ(b.n_runs, 1U);
    }
  const auto undecided = find_boundaries({c.runs.at(3)});
  EXPECT_EQ(boundary_text(undecided.at(1)), "undecided");
  EXPECT_EQ(fmt::format("{}", fmt::join(conclusion_sentences(c), " ")),
            "Same phase on both sides at 1 of 2 drive strengths. Undecided at Gamma 2 (in the simulation "
            "s_c = 1.18 [0.787, 1.84], threshold 1). Onset of bouncing: Gamma between 1 and 2 in the "
            "experiment and between 1 and 2 in the twins, compatible. Onset of convection: Gamma above 2 in "
            "the experiment and above 1 in the twins, not bracketed on either side.");
}

TEST(PhaseEvidence, TheConclusionOfASweepOpensWithOneShortSentence) {
  Comparison c;
  c.sweep = {{}, {}};
  c.boundaries =
      find_boundaries({run(Side::simulation, 1, kRests, kHolds), run(Side::simulation, 2, kBounces, kHolds)});
  const auto sentences = conclusion_sentences(c);
  ASSERT_EQ(sentences.size(), 1 + c.boundaries.size());
  EXPECT_EQ(sentences.front(), "The diagram shows 2 points of a sweep.");
  EXPECT_EQ(sentences.at(1).find("Onset of bouncing"), 0U) << sentences.at(1);
}

// What rests on one side and may bounce or convect on the other differs in any case.
TEST(PhaseEvidence, SidesWithoutACommonPhaseDiffer) {
  const Runs runs = {run(Side::experiment, 2, kRests, kHolds),
                     run(Side::simulation, 2, kBounces, kNearConvection)};
  EXPECT_EQ(verdict(runs, match_runs(runs).at(0)), MatchVerdict::differ);
}

}  // namespace twincell::analysis::phase_evidence_test
