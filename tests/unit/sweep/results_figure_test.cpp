// Figures of collected results, written by hand in the format of `sweep collect`.
#include "sweep/results_figure.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/figure_rules.hpp"

namespace twincell::sweep::results_figure_test {
namespace {

const std::string kGrid = R"({"points": [
  {"axes": {"beads.layers": 10, "drive.gamma": 1.5, "start.seed": 1}, "results": {"s_b": {"value": 0.3, "interval": {"low": 0.2, "high": 0.4}}}},
  {"axes": {"beads.layers": 10, "drive.gamma": 1.5, "start.seed": 2}, "results": {"s_b": {"value": 0.5, "interval": {"low": 0.4, "high": 0.6}}}},
  {"axes": {"beads.layers": 20, "drive.gamma": 2.5}, "results": {"s_b": {"value": 0.9, "interval": {"low": 0.8, "high": 1.0}}}},
  {"axes": {"beads.layers": 20, "drive.gamma": 2.0}, "results": {"s_b": {"value": 0.7}, "phase": {"value": "bouncing"}}}],
 "pooled": [{"axes": {"beads.layers": 10, "drive.gamma": 1.5}, "runs": 2,
             "results": {"s_b": {"value": 0.4, "interval": {"low": 0.25, "high": 0.55}}}}]})";

TEST(ResultsFigure, SeedsArePooledAndCurvesAreSortedAlongTheAxis) {
  const analysis::Figure f =
      results_figure(kGrid, {.result = "s_b", .over = {"drive.gamma", "beads.layers"}});
  // One point of two seeds with its interval, then the curve of the other height: lines, then points.
  EXPECT_EQ(f.data,
            "1.5 0.4 0.25 0.55\n\n\n2 0.7 0.7 0.7\n2.5 0.9 0.8 1\n\n\n2 0.7 0.7 0.7\n2.5 0.9 0.8 1\n");
  EXPECT_NE(f.plot.find("beads.layers = 10"), std::string::npos);
  EXPECT_NE(f.plot.find("beads.layers = 20"), std::string::npos);
  EXPECT_EQ(f.title, "s_b against drive.gamma");
}

// Otherwise the picture of one result would replace that of another in the same folder.
TEST(ResultsFigure, IsNamedAfterItsOptions) {
  EXPECT_EQ(results_figure(kGrid).name, "sweep");
  EXPECT_EQ(results_figure(kGrid, {.result = "s_b", .over = {}}).name, "sweep-s_b");
  EXPECT_EQ(results_figure(kGrid, {.result = "s_b", .over = {"drive.gamma", "beads.layers"}}).name,
            "sweep-s_b-over-drive.gamma-beads.layers");
}

TEST(ResultsFigure, OnsetsAreTheDefaultAndLimitsAreTriangles) {
  const analysis::Figure f = results_figure(R"({"points": [], "onsets": [
    {"axes": {"beads.layers": 20}, "key": "drive.gamma", "verdict": "convecting", "value": 2.1, "low": 2.0, "high": 2.3},
    {"axes": {"beads.layers": 10}, "key": "drive.gamma", "verdict": "convecting", "value": null, "low": 2.9, "high": null}]})");
  EXPECT_EQ(f.data, "20 2.1 2 2.3\n\n\n10 2.9\n");
  EXPECT_NE(f.plot.find("with points pt 9"), std::string::npos);  // a triangle that points up
  EXPECT_EQ(f.title, "drive.gamma at the onset of convection against beads.layers");
}

TEST(ResultsFigure, KeepsTheRulesOfFigures) {
  const analysis::Figure f =
      results_figure(kGrid, {.result = "s_b", .over = {"drive.gamma", "beads.layers"}});
  EXPECT_EQ(broken_figure_rules(f.plot), std::vector<std::string>());
  // The range holds the intervals, 0.25 to 1, and Gamma, 1.5 to 2.5, with a margin of 4 %.
  EXPECT_NE(f.plot.find("set xrange [1.46:2.54]\n"), std::string::npos) << f.plot;
  EXPECT_NE(f.plot.find("set yrange [0.22:1.03]\n"), std::string::npos) << f.plot;
  EXPECT_NE(f.plot.find("set ylabel 's_{b}'"), std::string::npos) << f.plot;
}

TEST(ResultsFigure, AxesHaveTheirUnits) {
  const char* points = R"({"points": [
    {"axes": {"cell.width": 10, "contact.mu": 0.1}, "results": {"T_z": {"value": 2, "unit": "m g sigma"}, "q6": {"value": 0.7, "unit": "1"}}},
    {"axes": {"cell.width": 20, "contact.mu": 0.1}, "results": {"T_z": {"value": 3, "unit": "m g sigma"}, "q6": {"value": 0.6, "unit": "1"}}}]})";
  const analysis::Figure f = results_figure(points, {.result = "T_z"});
  EXPECT_NE(f.plot.find("set xlabel 'cell.width, σ'"), std::string::npos) << f.plot;
  EXPECT_NE(f.plot.find("set ylabel 'T_{z}, m g σ'"), std::string::npos) << f.plot;
  const analysis::Figure curves =
      results_figure(points, {.result = "q6", .over = {"contact.mu", "cell.width"}});
  EXPECT_NE(curves.plot.find("set xlabel 'μ (contact.mu)'"), std::string::npos) << curves.plot;
  EXPECT_NE(curves.plot.find("set ylabel 'q6'"), std::string::npos) << curves.plot;
  EXPECT_NE(curves.plot.find("title 'cell.width = 10 σ' noenhanced"), std::string::npos) << curves.plot;
}

TEST(ResultsFigure, WrongNamesAreRefusedWithTheRightOnes) {
  expect_refusal<ConfigError>([] { (void)results_figure(kGrid, {.result = "s_d"}); }, "s_d", "s_b");
  expect_refusal<ConfigError>([] { (void)results_figure(kGrid, {.result = "s_b", .over = {"gamma"}}); },
                              "gamma", "drive.gamma");
  expect_refusal<ConfigError>([] { (void)results_figure(kGrid, {.result = "phase"}); }, "phase");
  expect_refusal<InputError>([] { (void)results_figure(R"({"points": []})"); }, "no scalar result");
}

}  // namespace
}  // namespace twincell::sweep::results_figure_test
