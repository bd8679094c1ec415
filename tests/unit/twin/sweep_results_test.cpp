// Collected results of a sweep, written by hand in the format of `sweep collect`.
#include "twin/sweep_results.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::twin::sweep_results_test {
namespace {

constexpr const char* kResults = R"({"format": "twincell sweep 1", "plan": "", "open": 0, "points": [
    {"id": "a", "conditions": {"n_l": 20, "gamma": 1.5, "start": "random"},
     "results": {"phase": {"value": "bouncing"}}},
    {"id": "b", "conditions": {"n_l": 20, "gamma": 2.5, "start": "crystal_a"},
     "results": {"s_b": {"value": 0.5}, "s_c": {"value": 1.5}}},
    {"id": "d", "conditions": {"n_l": 20, "gamma": 2.4, "start": "crystal_a"},
     "results": {"s_b": {"value": 0.5}}},
    {"id": "w", "conditions": {"n_l": null, "gamma": null, "start": "table"},
     "results": {"phase": {"value": "bouncing"}}},
    {"id": "c", "conditions": {"n_l": 20, "gamma": 9.0, "start": "random"}, "failed": "an overlap"}],
   "onsets": [
    {"axes": {"beads.layers": 20, "drive.omega": 2.0, "start.kind": "random"},
     "conditions": {"n_l": 20, "start": "random"}, "key": "drive.gamma", "verdict": "convecting", "value": 2.1,
     "low": 2.0, "high": 2.3, "runs": 12, "yes": 5},
    {"conditions": {"n_l": 20, "start": "crystal_a"}, "key": "drive.peak_acceleration_g",
     "verdict": "convecting", "value": null, "low": 2.9, "high": null, "runs": 9, "yes": 0},
    {"conditions": {"n_l": null, "start": "crystal_a"}, "key": "beads.layers",
     "verdict": "convecting", "value": 7, "low": 6, "high": 8, "runs": 9, "yes": 4}]})";

// Searches over the amplitude at two frequencies, Gamma = A omega^2, and over the friction.
constexpr const char* kOtherKeys = R"({"format": "twincell sweep 1", "plan": "", "open": 0, "points": [
    {"axes": {"drive.omega": 2, "drive.amplitude": 0.25}, "conditions": {"n_l": 20, "gamma": 1.0, "start": "random"}},
    {"axes": {"drive.omega": 2, "drive.amplitude": 0.75}, "conditions": {"n_l": 20, "gamma": 3.0, "start": "random"}},
    {"axes": {"drive.omega": 1, "drive.amplitude": 1.0}, "conditions": {"n_l": 20, "gamma": 1.0, "start": "random"}},
    {"axes": {"drive.omega": 1, "drive.amplitude": 3.0}, "conditions": {"n_l": 20, "gamma": 3.0, "start": "random"}},
    {"axes": {"contact.mu": 0.1}, "conditions": {"n_l": 20, "gamma": 2.0, "start": "random"}},
    {"axes": {"contact.mu": 0.9}, "conditions": {"n_l": 20, "gamma": 2.0, "start": "random"}}],
   "onsets": [
    {"axes": {"drive.omega": 2}, "conditions": {"n_l": 20, "start": "random"}, "key": "drive.amplitude",
     "verdict": "convecting", "value": 0.5, "low": 0.4, "high": 0.875, "runs": 12, "yes": 5},
    {"axes": {"drive.omega": 1}, "conditions": {"n_l": 20, "start": "random"}, "key": "drive.amplitude",
     "verdict": "convecting", "value": null, "low": 2.5, "high": null, "runs": 12, "yes": 0},
    {"axes": {}, "conditions": {"n_l": 20, "start": "random"}, "key": "contact.mu",
     "verdict": "convecting", "value": 0.4, "low": 0.3, "high": 0.5, "runs": 9, "yes": 4}]})";

void check(const analysis::Comparison& c) {
  // The failed point has no phase, and neither has the bouncing one, which lacks s_c. The point without N_l
  // and Gamma has no place in the diagram, and the onset in the number of layers has no Gamma.
  ASSERT_EQ(c.sweep.size(), 2U);
  EXPECT_DOUBLE_EQ(c.sweep[0].n_l, 20);
  EXPECT_DOUBLE_EQ(c.sweep[0].gamma, 1.5);
  EXPECT_EQ(c.sweep[0].start, "random");
  EXPECT_EQ(c.sweep[1].phase, analysis::BedPhase::convecting);
  ASSERT_EQ(c.boundaries.size(), 2U);
  EXPECT_DOUBLE_EQ(c.boundaries[0].gamma().value(), 2.1);  // as fitted, not the middle of its interval
  EXPECT_NEAR(c.boundaries[0].half_width().value(), 0.15, 1e-12);
  EXPECT_EQ(c.boundaries[0].n_runs, 12U);
  EXPECT_EQ(analysis::boundary_of(c.boundaries[0]), "sweep (random, drive.omega = 2)");
  EXPECT_FALSE(c.boundaries[1].gamma());
  EXPECT_EQ(analysis::boundary_text(c.boundaries[1]), "above 2.9");
}

}  // namespace

TEST(SweepResults, PointsAndOnsetsAreWhereTheFileStatesThem) {
  const TemporaryFolder folder;
  put_file(folder / "results.json", kResults);
  analysis::Comparison c;
  const std::vector<std::string> notes = add_sweep(folder / "results.json", c);
  check(c);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("1 onset of beads.layers has no place in the diagram"), std::string::npos)
      << notes[0];
}

TEST(SweepResults, ImpossibleAndRepeatedPointsAreRefused) {
  const TemporaryFolder folder;
  const auto said = [&](const std::string& points) {
    put_file(folder / "r.json",
             R"({"format": "twincell sweep 1", "plan": "", "open": 0, "points": [)" + points + "]}");
    return complaint_of([&] {
      analysis::Comparison c;
      (void)add_sweep(folder / "r.json", c);
    });
  };
  const auto point = [](const char* id, double s_b) {
    return fmt::format(R"({{"id": "{}", "conditions": {{"n_l": 20, "gamma": 1.5, "start": "random"}},)"
                       R"("results": {{"s_b": {{"value": {}}}, "s_c": {{"value": 0.1}}}}}})",
                       id, s_b);
  };
  EXPECT_EQ(said(point("a", 0.5) + ", " + point("b", 0.5)), "");
  EXPECT_NE(said(point("a", 0.5) + ", " + point("a", 0.5)).find("'a' occurs twice"), std::string::npos);
  EXPECT_NE(said(point("a", -0.5)).find("is -0.5; it cannot be negative"), std::string::npos);
}

TEST(SweepResults, PhasesAndNumbersThatContradictEachOtherAreRefused) {
  const TemporaryFolder folder;
  std::vector<std::string> notes;
  const auto said = [&](const std::string& gamma, const std::string& s_b, const std::string& phase,
                        int open) {
    put_file(folder / "r.json",
             fmt::format(R"({{"format": "twincell sweep 1", "plan": "", "open": {}, "points": [)"
                         R"({{"id": "a", "conditions": {{"n_l": 20, "gamma": {}, "start": "random"}},)"
                         R"("results": {{"s_b": {{"value": {}, "interval": {{"low": 0.1, "high": 0.9}}}},)"
                         R"("s_c": {{"value": 0.25}}, "phase": {{"value": "{}"}}}}}}]}})",
                         open, gamma, s_b, phase));
    return complaint_of([&] {
      analysis::Comparison c;
      notes = add_sweep(folder / "r.json", c);
    });
  };
  EXPECT_EQ(said("1.5", "0.5", "bouncing", 0), "");
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(said("1.5", "0.01", "co-moving", 0), "");
  EXPECT_NE(said("-3", "0.5", "bouncing", 0).find("points[0].conditions.gamma"), std::string::npos);
  EXPECT_NE(said("1.5", "1e300", "bouncing", 0).find("points[0].results.s_b.value: is 1e+300"),
            std::string::npos);
  EXPECT_NE(said("1.5", "0.5", "nonsense", 0).find("'nonsense' is no phase; phases are: undetermined, "),
            std::string::npos);
  const std::string contradicted = said("1.5", "0.5", "convecting", 0);
  EXPECT_NE(contradicted.find("points[0].results.phase.value: is convecting, but s_b = 0.5 and s_c = 0.25"),
            std::string::npos)
      << contradicted;
  EXPECT_EQ(said("1.5", "0.5", "bouncing", 1), "");
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("1 of the 2 points of the sweep has no result yet"), std::string::npos) << notes[0];
}

// A grid over Gamma has no onsets of its own: its points bracket them, for each set of the other axes.
TEST(SweepResults, PointsOfAGridBracketTheOnsets) {
  std::string points;
  const auto add = [&](int layers, double mu, double gamma, const char* phase) {
    points += fmt::format(
        R"({}{{"axes": {{"beads.layers": {}, "contact.mu": {}, "drive.gamma": {}}}, "conditions": {{"n_l": {}, "gamma": {},)"
        R"( "start": "random"}}, "results": {{"phase": {{"value": "{}"}}}}}})",
        points.empty() ? "" : ", ", layers, mu, gamma, layers, gamma, phase);
  };
  for (const double mu : {0.1, 0.6}) {
    add(10, mu, 0.8, "co-moving");
    add(10, mu, 1.4, mu < 0.5 ? "bouncing" : "co-moving");
    add(10, mu, 2.2, "bouncing");
    add(10, mu, 3.0, "convecting");
  }
  const TemporaryFolder folder;
  const auto boundaries_of = [&](const std::string& onsets) {
    put_file(folder / "grid.json", R"({"format": "twincell sweep 1", "plan": "", "open": 0, "points": [)" +
                                       points + "]" + onsets + "}");
    analysis::Comparison c;
    EXPECT_TRUE(add_sweep(folder / "grid.json", c).empty());
    EXPECT_EQ(c.sweep.size(), 8U);
    std::vector<std::string> all;
    for (const analysis::PhaseBoundary& b : c.boundaries)
      all.push_back(analysis::onset_name(b.onset) + std::string(", ") + analysis::boundary_of(b) + ": " +
                    analysis::boundary_text(b));
    std::sort(all.begin(), all.end());
    return all;
  };
  EXPECT_EQ(boundaries_of(""),
            (std::vector<std::string>{"bouncing, sweep (random, contact.mu = 0.1): between 0.8 and 1.4",
                                      "bouncing, sweep (random, contact.mu = 0.6): between 1.4 and 2.2",
                                      "convection, sweep (random, contact.mu = 0.1): between 2.2 and 3",
                                      "convection, sweep (random, contact.mu = 0.6): between 2.2 and 3"}));
  // Onsets that were searched are not bracketed again by their points.
  EXPECT_EQ(boundaries_of(
                R"(, "onsets": [{"axes": {"contact.mu": 0.1}, "conditions": {"n_l": 10, "start": "random"},)"
                R"("key": "drive.gamma", "verdict": "bouncing", "value": 1.1, "low": 1.0, "high": 1.2,)"
                R"("runs": 12, "yes": 5}])")
                .size(),
            1U);
}

TEST(SweepResults, AnOnsetInAnotherMeasureOfTheDriveIsConverted) {
  const TemporaryFolder folder;
  put_file(folder / "results.json", kOtherKeys);
  analysis::Comparison c;
  const std::vector<std::string> notes = add_sweep(folder / "results.json", c);
  ASSERT_EQ(c.boundaries.size(), 2U);
  EXPECT_NEAR(c.boundaries[0].below.value(), 1.6, 1e-12);
  EXPECT_NEAR(c.boundaries[0].gamma().value(), 2.0, 1e-12);
  EXPECT_NEAR(c.boundaries[0].above.value(), 3.5, 1e-12);  // beyond the points
  EXPECT_NEAR(c.boundaries[1].below.value(), 2.5, 1e-12);
  EXPECT_FALSE(c.boundaries[1].above);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("1 onset of contact.mu has no place in the diagram"), std::string::npos)
      << notes[0];
}

// Versions that did not store the conditions left the reader to find them in the text of the plan.
TEST(SweepResults, AFileWithoutConditionsIsToBeCollectedAgain) {
  const TemporaryFolder folder;
  for (const char* text : {R"({"format": "twincell sweep 1", "plan": "", "points":
            [{"id": "7f", "axes": {}, "results": {"phase": {"value": "bouncing"}}}]})",
                           R"({"format": "twincell sweep 1", "plan": "", "points": [], "onsets":
            [{"axes": {}, "key": "drive.gamma", "verdict": "bouncing", "runs": 3}]})"}) {
    put_file(folder / "results.json", text);
    analysis::Comparison c;
    expect_refusal<InputError>([&] { add_sweep(folder / "results.json", c); },
                               "does not state its N_l, Gamma and start",
                               "collect it again with `twincell sweep collect`");
  }
}

TEST(SweepResults, AnythingElseIsRefused) {
  const TemporaryFolder folder;
  analysis::Comparison c;
  for (const char* text : {"", "[]", "{\"format\": \"else\"}", "{\"format\": \"twincell sweep 1\"}",
                           // A key of a point or an onset is missing or has another type.
                           R"({"format": "twincell sweep 1", "plan": "", "points": 3})",
                           R"({"format": "twincell sweep 1", "plan": "", "points":
                               [{"id": "a", "conditions": {}, "results": {"phase": {"value": "bouncing"}}}]})",
                           R"({"format": "twincell sweep 1", "plan": "", "points":
                               [{"id": "a", "conditions": {"n_l": "20", "gamma": 1, "start": "random"},
                                 "results": {"phase": {"value": "bouncing"}}}]})",
                           R"({"format": "twincell sweep 1", "plan": "", "points": [],
                               "onsets": [{"verdict": "bouncing", "key": "drive.gamma"}]})",
                           R"({"format": "twincell sweep 1", "plan": "", "points": [],
                               "onsets": [{"conditions": {"n_l": 20, "start": "random"}, "verdict": "bouncing",
                                           "key": "drive.gamma"}]})"}) {
    put_file(folder / "results.json", text);
    EXPECT_THROW(add_sweep(folder / "results.json", c), InputError) << text;
  }
}

TEST(SweepResults, ASweepCountsOnceAndHasAPlaceInTheDiagram) {
  const TemporaryFolder folder;
  put_file(folder / "a.json", kResults);
  put_file(folder / "b.json", kResults);
  put_file(folder / "none.json", R"({"format": "twincell sweep 1", "plan": "", "points":
            [{"id": "w", "conditions": {"n_l": null, "gamma": null, "start": "table"},
              "results": {"phase": {"value": "bouncing"}}}]})");
  analysis::Comparison c;
  expect_refusal<ConfigError>(
      [&] {
        add_sweeps({folder / "a.json", folder / "b.json"}, c);
      },
      "a.json and ", "hold the same points; name the sweep once");
  expect_refusal<InputError>([&] { add_sweep(folder / "none.json", c); },
                             "no point of the sweep has a place in the diagram", "results of its plan");
}

}  // namespace twincell::twin::sweep_results_test
