// Several runs pooled into one measurement.
#include "analysis/runs/pooling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>

#include "analysis/observable/results.hpp"
#include "core/error.hpp"
#include "core/json_view.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/validation.hpp"

namespace twincell::analysis::pooling_test {
namespace {

Result number(const std::string& name, double value, std::optional<Interval> interval = {}) {
  Result r{.name = name, .values = {value}, .unit = "1", .n = 100, .n_of = "cycles", .interval = interval};
  r.convention = "as told";
  if (!interval) r.no_interval = "none";
  return r;
}

std::vector<std::vector<Result>> runs_of(const std::string& name, const std::vector<double>& values) {
  std::vector<std::vector<Result>> runs;
  for (const double v : values) runs.push_back({number(name, v)});
  return runs;
}

/// Percentage of pooled intervals that contain the true value.
double coverage(const std::function<double()>& draw, double truth, int runs, int trials) {
  int covered = 0;
  for (int t = 0; t < trials; ++t) {
    std::vector<double> values;
    for (int i = 0; i < runs; ++i) values.push_back(draw());
    const Interval interval = pool(runs_of("T_g", values)).front().interval.value();
    covered += interval.low <= truth && truth <= interval.high ? 1 : 0;
  }
  return 100.0 * covered / trials;
}

MemoryTrajectory bed(double gamma, double shift) {
  TrajectoryInfo info;
  info.n_beads = 3;
  info.box.upper = Vec3(10, 1, 10);
  info.drive = Drive{};
  info.drive->amplitude = gamma;
  info.drive->omega = 1;
  MemoryTrajectory t(info);
  Frame f;
  f.position = {Vec3(1, 0, 1), Vec3(2, 0, 1), Vec3(3, 0, 1 + shift)};
  t.append(f);
  return t;
}

}  // namespace

TEST(Pooling, IntervalsHoldTheTruthAsOftenAsTheySay) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal(3, 1);
  std::exponential_distribution<double> skewed(1);
  for (const int runs : {3, 5, 6, 12})
    test::validate({"V5.12", "coverage, %, over " + std::to_string(runs) + " runs of normal values", 95, 2.5,
                    "binomial"},
                   coverage([&] { return normal(generator); }, 3, runs, 1000));
  test::validate({"V5.12", "coverage, %, over 8 runs of exponential values", 95, 2.5, "binomial"},
                 coverage([&] { return skewed(generator); }, 1, 8, 1000));
}

TEST(Pooling, TwoRunsAreStudentsT) {
  const Result r = pool(runs_of("T_g", {1, 3})).front();
  EXPECT_DOUBLE_EQ(r.value(), 2);
  // The standard deviation of the mean is 1; Student's t has one degree of freedom.
  EXPECT_NEAR(r.interval->high, 2 + 12.7062, 1e-3);
  EXPECT_EQ(r.n, 2U);
  EXPECT_EQ(r.of_runs, (std::vector<double>{1, 3}));
}

TEST(Pooling, MeanSquaresArePooledAsSquares) {
  EXPECT_DOUBLE_EQ(pool(runs_of("s_c", {1, 7})).front().value(), 5);
  EXPECT_GE(pool(runs_of("s_c", {1, 7})).front().interval->low, 0);
}

TEST(Pooling, AgreementByChanceIsNotBetterThanTheRunsAre) {
  const Interval own{1.8, 2.2, 0.95, "bootstrap over tracers"};
  const Result r = pool({{number("T_g", 2, own)}, {number("T_g", 2, own)}}).front();
  EXPECT_NEAR(r.interval->high - r.interval->low, 0.4 / std::sqrt(2), 1e-12);
  EXPECT_NE(r.interval->method.find("bootstrap over tracers"), std::string::npos);
  EXPECT_EQ(pool(runs_of("half_pixel", {0.02, 0.02})).front().no_interval, "the same in every run");
}

TEST(Pooling, IntervalsEndWhereTheQuantityDoes) {
  // Student's t for two runs: 12.7 standard errors on either side of the mean.
  const Interval temperature = pool(runs_of("T_g", {0.1, 0.3})).front().interval.value();
  EXPECT_EQ(temperature.low, 0);
  EXPECT_NEAR(temperature.high, 0.2 + 1.27062, 1e-4);
  const Interval share = pool(runs_of("flight_share", {0.85, 0.95})).front().interval.value();
  EXPECT_NEAR(share.low, 0.9 - 0.635310, 1e-4);
  EXPECT_EQ(share.high, 1);
  EXPECT_LT(pool(runs_of("h_cm", {0.1, 0.3})).front().interval->low, 0);
}

TEST(Pooling, ACutIntervalHasTheStandardErrorOfItsOtherSide) {
  // Two runs that agree at 0.1 with 1.96 standard errors of 0.3 each, cut at 0: 0.3/sqrt(2) for their mean.
  const Interval own{0, 0.4, 0.95, "block averages"};
  const Interval pooled =
      pool({{number("T_g", 0.1, own)}, {number("T_g", 0.1, own)}}).front().interval.value();
  EXPECT_NEAR(pooled.high - 0.1, 0.3 / std::sqrt(2), 1e-12);
}

TEST(Pooling, TheSameRunTwiceIsRefused) {
  const double drawn = 0.123456789012345678;
  EXPECT_THROW(pool(runs_of("T_g", {drawn, 0.2, drawn})), ConfigError);
  EXPECT_EQ(repeated_runs(runs_of("T_g", {drawn, 0.2, drawn})), (std::vector<std::size_t>{0, 1, 0}));
  EXPECT_NO_THROW(pool(runs_of("T_g", {drawn, std::nextafter(drawn, 1)})));
  // Counts, fractions of few counts, and values set by the camera scale alone may be equal in different runs.
  EXPECT_NO_THROW(pool(runs_of("slips", {3, 3})));
  EXPECT_NO_THROW(pool(runs_of("hexagonal_fraction", {2.0 / 3, 2.0 / 3})));
  EXPECT_NO_THROW(pool(runs_of("half_pixel", {drawn, drawn})));
}

TEST(Pooling, NoSlipInAnyRunHasTheLimitOfAllTrials) {
  const Result r = pool(runs_of("p_s", {0, 0, 0})).front();
  EXPECT_EQ(r.value(), 0);
  EXPECT_NEAR(r.interval->high, 1 - std::pow(0.05, 1.0 / 300), 1e-15);
  EXPECT_DOUBLE_EQ(pool(runs_of("slips", {3, 0, 4})).front().value(), 7);
  EXPECT_GE(pool(runs_of("p_s", {0, 0, 0.01})).front().interval->low, 0);
}

TEST(Pooling, AnglesOfALatticeComeBackAfter60Degrees) {
  const double pooled = pool(runs_of("orientation", {44, -14, 45})).front().value();
  EXPECT_NEAR(std::remainder(pooled - 45, 60), 0, 0.4);
  EXPECT_NEAR(pooled, 15, 30 + 1e-9);  // -15 ... 45
  for (const double angle : {-15.0, -14.9, 0.0, 30.0, 44.9}) {
    const Result r = pool(runs_of("orientation", {angle, angle})).front();
    EXPECT_NEAR(r.value(), angle, 1e-9);
  }
}

// A run with a bead that overlaps the plate begins a slab lower, and one with a gap lacks a slab.
TEST(Pooling, SparseProfilesAreMatchedByTheirHeights) {
  const auto profile = [](const std::vector<double>& z, const std::vector<double>& phi,
                          const std::vector<double>& t) {
    std::vector<Result> run;
    for (const auto& [name, values] : {std::pair{"profile_z", z}, {"phi_z", phi}, {"T_z_z", t}})
      run.push_back({.name = name, .values = values, .shape = {values.size()}});
    return run;
  };
  const std::vector<std::vector<Result>> runs = {profile({-1.5, -0.5, 0.5}, {0.002, 0.04, 0.08}, {9, 8, 7}),
                                                 profile({-0.5, 0.5, 2.5}, {0.02, 0.06, 0.01}, {6, 5, 4})};
  const std::vector<Result> pooled = pool(runs);
  EXPECT_EQ(pooled[0].values, (std::vector<double>{-1.5, -0.5, 0.5, 2.5}));
  const std::vector<double> phi = {0.001, 0.03, 0.07, 0.005}, t = {9, 7, 6, 4};
  ASSERT_EQ(pooled[1].shape, std::vector<std::size_t>{4});
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(pooled[1].values[k], phi[k], 1e-12) << k;
    EXPECT_NEAR(pooled[2].values[k], t[k], 1e-12) << k;
  }
  EXPECT_EQ(needed_to_pool({"phi_z", "T_g"}), (std::vector<std::string>{"phi_z", "T_g", "profile_z"}));
  const std::vector<Result> only = pool(runs, {"phi_z"});
  ASSERT_EQ(only.size(), 1U);
  EXPECT_EQ(only[0].values.size(), 4U);
  EXPECT_NE(pool({{runs[0][1]}, {runs[1][1]}}).front().absent.find("profile_z"), std::string::npos);
}

// Each run has a small interval of its own and another mean: the interval is that of the mean over the runs.
TEST(Pooling, ElementsOfArraysHaveTheIntervalOverTheRuns) {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> between(0, 1), within(0, 0.1);
  constexpr std::size_t kElements = 40;
  constexpr int kTrials = 25;
  int covered = 0, all = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<std::vector<Result>> runs;
    for (int run = 0; run < 5; ++run) {
      std::vector<double> mean, low, high;
      for (std::size_t e = 0; e < kElements; ++e) {
        mean.push_back(7 + between(generator) + within(generator));
        low.push_back(mean.back() - 0.196), high.push_back(mean.back() + 0.196);
      }
      std::vector<Result> one;
      for (const auto& [name, values] : {std::pair{"g_r", mean}, {"g_r_low", low}, {"g_r_high", high}})
        one.push_back({.name = name, .values = values, .shape = {kElements}});
      runs.push_back(one);
    }
    const std::vector<Result> pooled = pool(runs);
    for (std::size_t e = 0; e < kElements; ++e, ++all)
      covered +=
          find_result(pooled, "g_r_low").values[e] <= 7 && 7 <= find_result(pooled, "g_r_high").values[e] ? 1
                                                                                                          : 0;
  }
  EXPECT_NEAR(100.0 * covered / all, 95, 2.5);
}

TEST(Pooling, WordsAreThoseOfMostRuns) {
  const auto word = [](const std::string& text) {
    return std::vector<Result>{Result{.name = "phase", .text = text, .n = 1, .n_of = "cycles"}};
  };
  const Result most = pool({word("bouncing"), word("convecting"), word("convecting")}).front();
  EXPECT_EQ(most.text, "convecting");
  EXPECT_NE(most.convention.find("convecting in 2, bouncing in 1 of 3 runs"), std::string::npos);
  EXPECT_FALSE(pool({word("bouncing"), word("convecting")}).front().present());
}

TEST(Pooling, RunsWithoutAValueAreCountedOut) {
  const Result r =
      pool({{number("T_g", 1)}, {absent_result("T_g", "no bead", "eq. 2")}, {number("T_g", 3)}}).front();
  EXPECT_DOUBLE_EQ(r.value(), 2);
  EXPECT_EQ(r.n, 2U);
  EXPECT_TRUE(std::isnan(r.of_runs[1]));
  EXPECT_NE(r.convention.find("2 of 3 runs"), std::string::npos);
}

TEST(Pooling, ArraysEndWithTheShortest) {
  Result a{.name = "s_j", .values = {1, 7, 5}, .shape = {3}},
      b{.name = "s_j", .values = {7, 1}, .shape = {2}};
  const Result r = pool({{a}, {b}}).front();
  EXPECT_EQ(r.shape, (std::vector<std::size_t>{2}));
  EXPECT_DOUBLE_EQ(r.values[0], 5);
  a.name = b.name = "q6_beads";
  EXPECT_FALSE(pool({{a}, {b}}).front().present());
}

TEST(Pooling, OtherConditionsAreRefused) {
  const MemoryTrajectory a = bed(1.5, 0), b = bed(1.5, 0.1), other = bed(2, 0.1);
  EXPECT_NO_THROW(require_one_condition({&a, &b}));
  try {
    require_one_condition({&a, &other});
    FAIL() << "no complaint";
  } catch (const ConfigError& e) {
    EXPECT_NE(std::string(e.what()).find("Gamma is 1.5 there, 2 here"), std::string::npos) << e.what();
  }
  EXPECT_THROW(require_one_condition({&a, &b, &a}), ConfigError);  // the same run twice
}

TEST(Pooling, PartsOfOneRunAreNoRepeats) {
  const auto run = [](double offset, const std::string& start, const std::string& time) {
    MemoryTrajectory t = bed(1.5, offset);
    t.info().source = Origin::simulation;
    t.info().provenance_json =
        nlohmann::json{{"config", "[start]\nkind = 'random'\n" + start + "\n[time]\n" + time}}.dump();
    return t;
  };
  const MemoryTrajectory shorter = run(0, "seed = 1\n", "cycles = 20\ndiscard = 0\n"),
                         longer = run(0.1, "seed = 1\n", "cycles = 30\ndiscard = 10\n"),
                         other = run(0.1, "seed = 2\n", "cycles = 30\ndiscard = 10\n"),
                         from_a = run(0, "from = 'a.h5'\n", "cycles = 20\n"),
                         from_b = run(0.1, "from = 'a.h5'\n", "cycles = 20\n");
  EXPECT_NO_THROW(require_one_condition({&shorter, &other}));
  EXPECT_NO_THROW(require_one_condition({&from_a, &from_b}));  // the file may have been another one
  MemoryTrajectory film = shorter, repeat = longer;  // of one cell, whose file the provenance contains
  film.info().source = repeat.info().source = Origin::experiment;
  EXPECT_NO_THROW(require_one_condition({&film, &repeat}));
  // Nor are runs of one bed with other numerics.
  const MemoryTrajectory finer = run(0.2, "seed = 1\n", "cycles = 20\nsteps_per_contact = 50\n");
  for (const MemoryTrajectory* same : {&longer, &finer}) try {
      require_one_condition({&shorter, same});
      FAIL() << "no complaint";
    } catch (const ConfigError& e) {
      EXPECT_NE(std::string(e.what()).find("both begin with the same bed"), std::string::npos) << e.what();
    }
}

TEST(Pooling, RunsThatShareAFrameAreNoRepeats) {
  const auto run = [](const std::vector<double>& heights, bool reversed) {
    MemoryTrajectory t(bed(1.5, heights.front()).info());
    for (const double h : heights) {
      Frame f = bed(1.5, h).frames().front();
      if (reversed) std::reverse(f.position.begin(), f.position.end());
      t.append(f);
    }
    return t;
  };
  const MemoryTrajectory whole = run({0, 0.1, 0.2, 0.3}, false), later = run({0.2, 0.3, 0.4, 0.5}, true),
                         same_start = run({0, 0.15, 0.25, 0.35}, false);
  EXPECT_NO_THROW(require_one_condition({&whole, &same_start}));
  try {
    require_one_condition({&whole, &later});
    FAIL() << "no complaint";
  } catch (const ConfigError& e) {
    EXPECT_NE(std::string(e.what()).find("frame 2 there and frame 0 here are equal"), std::string::npos)
        << e.what();
  }
}

TEST(Pooling, OtherContactLawsAreRefused) {
  const auto with_scene = [](MemoryTrajectory run, const std::string& scene) {
    run.info().provenance_json = nlohmann::json{{"config", scene}}.dump();
    return run;
  };
  const std::string scene =
      "preset = 'p'\n\n[beads]\ncount = 4\n\n[cell]\nwidth_sigma = 20.0\n\n[contact]\nk_n = 1000000.0\n"
      "mu = 0.59999999999999998\n\n"
      "[start]\nseed = 1\n";
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = scene;
    return text.replace(text.find(from), from.size(), to);
  };
  const MemoryTrajectory first = with_scene(bed(1.5, 0), scene);
  const auto complaint = [&](const std::string& other) {
    const MemoryTrajectory second = with_scene(bed(1.5, 0.1), other + "perturbation = 0.1\n");  // another run
    return complaint_of([&] { require_one_condition({&first, &second}); });
  };
  EXPECT_NE(complaint(changed("0.59999999999999998", "0.1")).find("contact.mu is 0.6 there, 0.1 here"),
            std::string::npos);
  EXPECT_NE(
      complaint(changed("mu = 0.59999999999999998\n", "")).find("contact.mu is 0.6 there, not stated here"),
      std::string::npos);
  EXPECT_NE(complaint(changed("count = 4", "count = 4\nspread = [\n  [1.0, 0.5],\n  [2.0, 0.5]\n]"))
                .find("beads.spread is not stated there, [ [ 1.0, 0.5 ], [ 2.0, 0.5 ] ] here"),
            std::string::npos);
  // However the text is written.
  EXPECT_NE(
      complaint(changed("mu = 0.59999999999999998", "'mu'=0.1")).find("contact.mu is 0.6 there, 0.1 here"),
      std::string::npos);
  // Chance, and what the trajectories themselves state.
  for (const std::string& same :
       {scene, changed("seed = 1", "seed = 2"), changed("count = 4", "count = 5"), changed("20.0", "20.1")})
    EXPECT_EQ(complaint(same), "");
  // Of a run without a scene, as of a camera, it is not known whether its contact law differs.
  const MemoryTrajectory unknown = bed(1.5, 0.1), also_unknown = bed(1.5, 0.2);
  const std::vector<std::string> doubts = require_one_condition({&first, &unknown});
  ASSERT_EQ(doubts.size(), 1U);
  EXPECT_NE(doubts[0].find("does not contain its scene"), std::string::npos) << doubts[0];
  EXPECT_TRUE(require_one_condition({&unknown, &also_unknown}).empty());
}

TEST(Results, ComeBackFromJson) {
  std::vector<Result> results = {number("T_g", 1.25, Interval{1, 1.5, 0.95, "by hand"}),
                                 absent_result("p_s", "no bead", "sec. V"),
                                 Result{.name = "phase", .text = "bouncing", .n = 3, .n_of = "cycles"},
                                 Result{.name = "s_j", .values = {1, NAN, 3, 4}, .shape = {2, 2}}};
  const std::string text = results_json(results);
  EXPECT_EQ(results_json(results_from_json(JsonView::parse(text, "results.json"))), text);
}

}  // namespace twincell::analysis::pooling_test
