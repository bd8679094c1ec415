// Laws fitted to data with known parameters: exact data are recovered to the last digits, noisy data with the
// stated coverage, and data that do not determine a parameter are reported as such.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include "calibration/fit/curve_fit.hpp"
#include "core/error.hpp"
#include "tests/support/validation.hpp"

namespace twincell::fits_test {

using namespace calibration;

namespace {

/// The grid of Bhateja et al. 2016 from W_f upwards: 800 to 4000 rpm with A = d = 5 mm.
std::vector<double> paper_grid() {
  std::vector<double> w;
  for (int rpm = 800; rpm <= 4000; rpm += 100) w.push_back(5.5891 * rpm * rpm * 1e-6);
  return w;
}

std::vector<DataPoint> table_of(const std::vector<double>& xs, const std::function<double(double)>& y) {
  std::vector<DataPoint> points;
  for (const double x : xs) points.push_back({x, y(x)});
  return points;
}

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

bool noted(const CurveFit& fit, const std::string& words) {
  return std::any_of(fit.notes.begin(), fit.notes.end(),
                     [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

}  // namespace

TEST(Fits, ExactDataGiveTheParametersBack) {
  const std::vector<double> k_m = {3.0, 4.0, 5.5, 8.0, 12.0, 20.0};
  const CurveFit arrhenius =
      fit_curve(law_named("arrhenius"), table_of(k_m, [](double k) { return std::exp(1.3 - 7 / k); }));
  test::validate({"V5.7", "E_b of exact Arrhenius data", 7, 1e-10, "closed form"},
                 arrhenius.fit.value("E_b"));
  EXPECT_NEAR(arrhenius.fit.value("c"), 1.3, 1e-10);
  const CurveFit power =
      fit_curve(law_named("power"), table_of(k_m, [](double x) { return 0.3 * std::pow(x, 1.49); }));
  test::validate({"V5.10", "exponent of an exact power law", 1.49, 1e-10, "closed form"},
                 power.fit.value("alpha"));
  EXPECT_NEAR(power.fit.value("ln_C"), std::log(0.3), 1e-10);
  const CurveFit line = fit_curve(law_named("line"), table_of(k_m, [](double x) { return 2 - 0.5 * x; }));
  EXPECT_NEAR(line.fit.value("a"), 2, 1e-12);
  EXPECT_NEAR(line.fit.value("b"), -0.5, 1e-12);
  const CurveFit constant = fit_curve(law_named("constant"), {{1, 4}, {2, 6}, {3, 8}});
  EXPECT_NEAR(constant.fit.value("a"), 6, 1e-12);
}

TEST(Fits, TableThreeOfPaperTwo) {
  struct Row {
    const char* law;
    const char* system;
    double a, b, c;
  };
  for (const Row& row :
       {Row{"algebraic", "2D", 0.282, 0.656, 2.07}, Row{"exponential", "2D", 0.327, 0.131, 1.022},
        Row{"algebraic", "3D", 0.054, 0.622, 7.98}, Row{"exponential", "3D", 0.092, 0.124, 2.695}}) {
    const bool algebraic = std::string(row.law) == "algebraic";
    const CurveFit fit =
        fit_curve(law_named(row.law), table_of(paper_grid(), [&](double w) {
                    return row.a * (1 + row.c * (algebraic ? std::pow(w, -row.b) : std::exp(-row.b * w)));
                  }));
    const std::string what = std::string(row.law) + " decay on 33 grid points, " + row.system + " rough: ";
    test::validate({"V5.8", what + "a", row.a, 1e-6, "Bhateja et al. 2016, Table III"}, fit.fit.value("a"));
    test::validate({"V5.8", what + "b", row.b, 1e-6, "Bhateja et al. 2016, Table III"}, fit.fit.value("b"));
    test::validate({"V5.8", what + "c", row.c, 1e-6, "Bhateja et al. 2016, Table III"}, fit.fit.value("c"));
    test::validate({"V5.8", what + "correlation", 1, 1e-12, "closed form"}, fit.correlation);
    EXPECT_TRUE(fit.fit.undetermined.empty());
  }
}

// The argument of paper 2: an exponential fitted to algebraic data leaves residuals in systematic order, and
// the reverse does not occur.
TEST(Fits, TheRunsTestTellsTheWrongDecayFromTheRightOne) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> noise(0, 0.001);
  const auto points = table_of(
      paper_grid(), [&](double w) { return 0.282 * (1 + 2.07 * std::pow(w, -0.656)) + noise(generator); });
  const CurveFit right = fit_curve(law_named("algebraic"), points);
  const CurveFit wrong = fit_curve(law_named("exponential"), points);
  EXPECT_GT(right.runs.p, 0.05);
  EXPECT_LT(wrong.runs.p, 1e-4);
  EXPECT_TRUE(noted(wrong, "not in random order"));
  EXPECT_FALSE(noted(right, "not in random order"));
  EXPECT_GT(wrong.correlation, 0.98);  // the correlation alone does not reveal it
}

TEST(Fits, RunsAgainstCountingAllOrders) {
  // 5 residuals above, 4 below: all orders of the signs are enumerated.
  std::vector<double> signs = {-1, -1, -1, -1, 1, 1, 1, 1, 1};
  std::vector<double> at_runs(10, 0);
  double all = 0;
  do {
    at_runs[runs_test(signs).runs] += 1;
    all += 1;
  } while (std::next_permutation(signs.begin(), signs.end()));
  for (std::size_t r = 2; r <= 9; ++r) {
    std::vector<double> order;  // one order with r runs
    std::size_t above = 5, below = 4;
    for (std::size_t k = 0; k < r; ++k) {
      std::size_t& left = k % 2 == 0 ? above : below;
      const std::size_t later = (r - k - 1) / 2;  // runs of this sign that follow
      const std::size_t take = later == 0 ? left : 1;
      for (std::size_t i = 0; i < take; ++i) order.push_back(k % 2 == 0 ? 1 : -1);
      left -= take;
    }
    const RunsTest test = runs_test(order);
    ASSERT_EQ(test.runs, r);
    const double below_p =
        std::accumulate(at_runs.begin(), at_runs.begin() + static_cast<long>(r) + 1, 0.0) / all;
    const double above_p = std::accumulate(at_runs.begin() + static_cast<long>(r), at_runs.end(), 0.0) / all;
    EXPECT_NEAR(test.p, std::min(1.0, 2 * std::min(below_p, above_p)), 1e-12) << r;
  }
  EXPECT_TRUE(std::isnan(runs_test({1, 2, 3}).p));
}

TEST(Fits, BreakPoints) {
  // Slope 4 below x = 3.3, 1.5 above: the shape of Fig. 4(a).
  std::vector<double> xs;
  for (int i = 0; i < 16; ++i) xs.push_back(std::pow(10, -0.1 + 0.1 * i));
  const auto bend = [](double x) { return 0.02 * std::pow(x / 3.3, x < 3.3 ? 4 : 1.5); };
  const CurveFit exact = fit_curve(law_named("slope_break"), table_of(xs, bend));
  test::validate({"V5.11", "slope break of exact data: x_b", 3.3, 1e-6, "closed form"},
                 exact.fit.value("x_b"));
  test::validate({"V5.11", "slope below", 4, 1e-6, "closed form"}, exact.fit.value("s_1"));
  test::validate({"V5.11", "slope above", 1.5, 1e-6, "closed form"}, exact.fit.value("s_2"));
  EXPECT_LT(exact.p_nested, 1e-6);

  // Energy barriers: 130 below K_m = 12.3 and 7 above: regions A2 and B of Fig. 5(b).
  std::vector<double> k_m;
  for (int i = 0; i < 14; ++i) k_m.push_back(8 + i);
  const CurveFit barriers = fit_curve(law_named("arrhenius_break"), table_of(k_m, [](double k) {
                                        return 0.3 * std::exp(-(k < 12.3 ? 130 : 7) * (1 / k - 1 / 12.3));
                                      }));
  test::validate({"V5.11", "two barriers: E_1", 130, 1e-5, "closed form"}, barriers.fit.value("E_1"));
  test::validate({"V5.11", "two barriers: E_2", 7, 1e-5, "closed form"}, barriers.fit.value("E_2"));
  test::validate({"V5.11", "two barriers: K_m of the break", 12.3, 1e-6, "closed form"},
                 barriers.fit.value("x_b"));

  // Without a bend, the break is reported as undetermined and the line remains.
  std::mt19937_64 generator(4);
  std::normal_distribution<double> noise(0, 0.05);
  const CurveFit none =
      fit_curve(law_named("slope_break"),
                table_of(xs, [&](double x) { return 0.02 * std::pow(x, 2) * std::exp(noise(generator)); }));
  EXPECT_GT(none.p_nested, 0.05);
  EXPECT_NE(std::find(none.fit.undetermined.begin(), none.fit.undetermined.end(), "x_b"),
            none.fit.undetermined.end());
}

TEST(Fits, BreakPointIntervalsCover) {
  std::vector<double> xs;
  for (int i = 0; i < 30; ++i) xs.push_back(std::pow(10, -0.1 + 0.05 * i));
  std::mt19937_64 generator(14);
  std::normal_distribution<double> noise(0, 0.1);
  int covered = 0;
  const int seeds = 250;
  for (int s = 0; s < seeds; ++s) {
    const CurveFit fit =
        fit_curve(law_named("slope_break"), table_of(xs, [&](double x) {
                    return 0.02 * std::pow(x / 3.3, x < 3.3 ? 4 : 1.5) * std::exp(noise(generator));
                  }));
    const auto& interval = fit.intervals[3];
    ASSERT_TRUE(interval.has_value());
    covered += interval->low <= 3.3 && 3.3 <= interval->high ? 1 : 0;
  }
  test::validate({"V5.11", "coverage, %, of the 95 % interval of the break", 95, 2, "binomial"},
                 100.0 * covered / seeds);
}

TEST(Fits, BinomialCountsGiveTheCoverageTheyPromise) {
  std::mt19937_64 generator(5);
  const int trials = 1000;
  int covered = 0;
  for (int t = 0; t < trials; ++t) {
    std::vector<DataPoint> points;
    for (const double k_m : {2.0, 2.5, 3.0, 4.0, 6.0, 10.0}) {
      const int n = 40000;
      std::binomial_distribution<int> slips(n, std::exp(-7 / k_m));
      points.push_back({k_m, static_cast<double>(slips(generator)) / n, 0, static_cast<double>(n)});
    }
    const CurveFit fit = fit_curve(law_named("arrhenius"), points);
    EXPECT_TRUE(fit.weighted);
    covered += fit.intervals[1]->low <= 7 && 7 <= fit.intervals[1]->high ? 1 : 0;
  }
  test::validate({"V5.7", "coverage, %, of the 95 % interval of E_b, binomial noise", 95, 2, "binomial"},
                 100.0 * covered / trials);
}

TEST(Fits, ScatterGivesTheCoverageItPromises) {
  std::mt19937_64 generator(6);
  std::normal_distribution<double> noise(0, 0.01);
  const int trials = 600;
  int covered = 0;
  for (int t = 0; t < trials; ++t) {
    const CurveFit fit = fit_curve(law_named("algebraic"), table_of(paper_grid(), [&](double w) {
                                     return 0.282 * (1 + 2.07 * std::pow(w, -0.656)) + noise(generator);
                                   }));
    if (!fit.intervals[0]) continue;
    const double truth = 0.282 * (1 + 2.07 * std::pow(20.0, -0.656));
    covered += std::abs(fit.at(20) - truth) <= analysis::student_t_95(30) * fit.error_at(20) ? 1 : 0;
  }
  test::validate({"V5.8", "coverage, %, of the band of an algebraic decay at W = 20", 95, 2, "binomial"},
                 100.0 * covered / trials);
}

// Rare counts, of which a quarter and less are zeros.
TEST(Fits, RareCountsGiveTheirLawWithoutBias) {
  for (const auto& [energy, trials, low, high] :
       {std::tuple{8.0, 1000, 0.8, 2.2}, {6.0, 300, 0.8, 2.2}, {3.0, 100, 1.0, 4.0}}) {
    std::mt19937_64 generator(17);
    int covered = 0, tables = 0;
    double sum = 0, squares = 0, stated = 0;
    for (int t = 0; t < 400; ++t) {
      std::vector<DataPoint> points;
      for (int i = 0; i < 12; ++i) {
        const double x = low + (high - low) * i / 11;
        std::binomial_distribution<int> count(trials, std::exp(-energy / x));
        points.push_back({x, static_cast<double>(count(generator)) / trials, 0, static_cast<double>(trials)});
      }
      const CurveFit fit = fit_curve(law_named("arrhenius"), points);
      if (!fit.likelihood || !fit.intervals[0]) continue;
      const std::size_t k = fit.fit.names[0] == "E_b" ? 0 : 1;
      ++tables;
      covered += fit.intervals[k]->low <= energy && energy <= fit.intervals[k]->high ? 1 : 0;
      sum += fit.fit.values[k];
      squares += std::pow(fit.fit.values[k] - energy, 2);
      stated += fit.fit.standard_errors[k];
    }
    EXPECT_GT(tables, 395);
    const double n = tables;
    test::validate({"V5.8", fmt::format("mean error of E_b = {:g} over its error, rare counts", energy), 0,
                    0.2, "the law of the counts"},
                   (sum / n - energy) / (stated / n));
    test::validate(
        {"V5.8", fmt::format("coverage, %, of E_b = {:g}, rare counts", energy), 95, 3, "binomial"},
        100 * covered / n);
  }
}

// Tables with a count far above the curve, and with a probability of 1 at the border of the law. The outside
// numbers are minima of -ln L by scipy.optimize 1.10.
TEST(Fits, TheLikelihoodIsAtItsMaximum) {
  const std::vector<DataPoint> six = {{1, 0.01, 0, 100},   {1.5, 0.02, 0, 100}, {2, 0.03, 0, 100},
                                      {2.5, 0.03, 0, 100}, {3, 0.2, 0, 100},    {4, 0.3, 0, 100}};
  const auto fitted = [](const std::vector<DataPoint>& points) {
    CurveFit fit = fit_curve(law_named("arrhenius"), points);
    EXPECT_TRUE(fit.likelihood);
    return fit;
  };
  const auto energy = [](const CurveFit& fit) { return fit.fit.values[fit.fit.names[0] == "E_b" ? 0 : 1]; };
  const CurveFit of_six = fitted(six);
  test::validate({"V5.8", "E_b of six counts by maximum likelihood", 7.50616, 1e-5, "scipy"}, energy(of_six));
  test::validate({"V5.8", "correlation of the six frequencies with the curve", 0.957, 1e-3, "numpy"},
                 of_six.correlation);
  std::vector<DataPoint> with_certain = six;
  with_certain.push_back({5, 1, 0, 100});
  test::validate({"V5.8", "E_b of the same and a probability of 1", 13.793, 1e-3, "scipy"},
                 energy(fitted(with_certain)));
}

TEST(Fits, PointsWithoutLogarithmAreCountedAndGetLimits) {
  const std::vector<DataPoint> points = {{0.5, 0, 0, 1e5},
                                         {4, std::exp(-7.0 / 4), 0, 1e5},
                                         {6, std::exp(-7.0 / 6), 0, 1e5},
                                         {8, std::exp(-7.0 / 8), 0, 1e5},
                                         {9, std::nan(""), 0, 1e5}};
  const CurveFit fit = fit_curve(law_named("arrhenius"), points);
  EXPECT_EQ(fit.n_zero, 1U);
  EXPECT_EQ(fit.n_invalid, 1U);
  EXPECT_EQ(fit.n_used, 4U);
  EXPECT_TRUE(fit.likelihood);
  EXPECT_NEAR(fit.fit.value("E_b"), 7, 0.01);
  ASSERT_EQ(fit.upper_limits.size(), 1U);
  EXPECT_NEAR(fit.upper_limits[0], 3e-5, 1e-7);

  std::vector<DataPoint> power;
  for (const double x : {0.5, 1.0, 2.0, 3.0, 5.0, 9.0})
    power.push_back({x, x < 1.5 ? 0.0 : 0.3 * std::pow(x, 1.49)});
  const CurveFit window = fit_curve(law_named("power"), power, {0.9, 8});
  EXPECT_EQ(window.n_zero, 1U);
  EXPECT_EQ(window.n_outside, 2U);
  EXPECT_EQ(window.n_used, 3U);
  EXPECT_NEAR(window.fit.value("alpha"), 1.49, 1e-10);
}

TEST(Fits, RefusalsNameTheWindowAndTheData) {
  const std::vector<DataPoint> points = {{3, 0.1}, {4, 0.2}};
  const Law& law = law_named("arrhenius");
  const std::string empty = refusal([&] { fit_curve(law, points, {10, 20}); });
  EXPECT_NE(empty.find("[10, 20]"), std::string::npos) << empty;
  EXPECT_NE(empty.find("[3, 4]"), std::string::npos) << empty;
  EXPECT_FALSE(refusal([&] { fit_curve(law, {}); }).empty());
  EXPECT_FALSE(refusal([&] { fit_curve(law, {{3, 0.1}}); }).empty());
  EXPECT_NE(refusal([&] { fit_curve(law, {{3, 0.1}, {3, 0.2}}); }).find("one abscissa"), std::string::npos);
  EXPECT_NE(refusal([&] { fit_curve(law_named("algebraic"), points); }).find("3 parameters"),
            std::string::npos);
  EXPECT_NE(refusal([&] { law_named("parabola"); }).find("arrhenius_break"), std::string::npos);
  const CurveFit two = fit_curve(law, points);
  EXPECT_FALSE(two.intervals[1].has_value());
  EXPECT_TRUE(noted(two, "values without errors"));
  const CurveFit constant = fit_curve(law, {{3, 0.1}, {4, 0.1}, {5, 0.1}});
  EXPECT_NEAR(constant.fit.value("E_b"), 0, 1e-12);
  EXPECT_TRUE(noted(constant, "constant ordinate"));
}

TEST(Fits, FlatDataLeaveADecayUndetermined) {
  std::mt19937_64 generator(7);
  std::normal_distribution<double> noise(0, 0.01);
  for (const char* name : {"algebraic", "exponential"}) {
    const CurveFit noisy =
        fit_curve(law_named(name), table_of(paper_grid(), [&](double) { return 0.3 + noise(generator); }));
    EXPECT_EQ(noisy.fit.undetermined, (std::vector<std::string>{"b", "c"})) << name;
    EXPECT_GT(noisy.fit.condition, 0);
    const CurveFit flat = fit_curve(law_named(name), table_of(paper_grid(), [](double) { return 0.3; }));
    EXPECT_EQ(flat.fit.undetermined.size(), 2U) << name;
    EXPECT_NEAR(flat.at(20), 0.3, 1e-9);
  }
}

}  // namespace twincell::fits_test
