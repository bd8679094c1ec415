#include "analysis/statistics/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include "tests/support/validation.hpp"

namespace twincell::statistics_test {

using namespace analysis;

namespace {

/// A stationary AR(1) series with mean 0: x <- a x + noise. Correlation time (1 + a)/(2 (1 - a)).
std::vector<double> correlated(std::size_t n, double a, std::mt19937_64& generator) {
  std::normal_distribution<double> kick;
  std::vector<double> series(n);
  double x = kick(generator) / std::sqrt(1 - a * a);
  for (double& value : series) value = x = a * x + kick(generator);
  return series;
}

/// Percentage of the intervals that contain `truth`. Nearly all of the `trials` must give an interval.
double coverage(int trials, double truth, const std::function<std::optional<Interval>()>& measure) {
  int covered = 0, given = 0;
  for (int t = 0; t < trials; ++t) {
    const auto interval = measure();
    if (!interval) continue;
    ++given;
    covered += interval->low <= truth && truth <= interval->high ? 1 : 0;
  }
  EXPECT_GT(given, 0.9 * trials);
  return 100.0 * covered / given;
}

std::optional<Interval> series_interval(const std::vector<double>& series) {
  SeriesAverage average;
  for (const double x : series) average.add(5 + x);
  return average.interval("values");
}

}  // namespace

TEST(Statistics, StudentTAgainstTables) {
  EXPECT_NEAR(student_t_95(1), 12.706, 1e-3);
  EXPECT_NEAR(student_t_95(9), 2.262, 1e-3);
  EXPECT_NEAR(student_t_95(40), 2.0211, 1e-4);
  EXPECT_NEAR(student_t_95(120), 1.9799, 1e-4);
  EXPECT_TRUE(std::isinf(student_t_95(0)));
}

TEST(Statistics, CorrelationTimeOfAutoregressiveSeries) {
  std::mt19937_64 generator(17);
  for (const double a : {0.0, 0.5, 0.9}) {
    const double exact = (1 + a) / (2 * (1 - a));
    double sum = 0;
    const int series = 60;
    for (int s = 0; s < series; ++s) sum += correlation_time(correlated(4000, a, generator));
    test::validate({"V5.12", "integrated correlation time, AR(1) with a = " + std::to_string(a).substr(0, 3),
                    exact, 0.05 * exact, "(1 + a)/(2 (1 - a))"},
                   sum / series);
  }
  EXPECT_EQ(correlation_time(std::vector<double>(50, 3.7)), 0.5);
  EXPECT_TRUE(std::isnan(correlation_time({1.0})));
}

TEST(Statistics, ALongSeriesKeepsItsCorrelationTimeInConstantMemory) {
  std::mt19937_64 generator(3);
  SeriesAverage average;
  for (const double x : correlated(300000, 0.9, generator)) average.add(x);
  test::validate(
      {"V5.12", "correlation time of 300000 values kept as 4096 means", 9.5, 0.6, "(1 + a)/(2 (1 - a))"},
      average.correlation_time());
  test::validate({"V5.12", "variance of the same values", 1 / 0.19, 0.15, "1/(1 - a^2)"}, average.variance());
}

TEST(Statistics, IntervalsCoverTheMean) {
  std::mt19937_64 generator(5);
  const auto cover = [&](std::size_t n, double a) {
    return coverage(2000, 5, [&] { return series_interval(correlated(n, a, generator)); });
  };
  test::validate(
      {"V5.12", "coverage, %, of the 95 % interval: 3000 values, correlation time 9.5", 95, 2, "binomial"},
      cover(3000, 0.9));
  test::validate({"V5.12", "coverage, %: 200 values, correlation time 1.5", 95, 2, "binomial"},
                 cover(200, 0.5));
  test::validate({"V5.12", "coverage, %: 30 independent values", 95, 2, "binomial"}, cover(30, 0));
  test::validate({"V5.12", "coverage, %: 200 independent values", 95, 2, "binomial"}, cover(200, 0));
}

TEST(Statistics, IntervalsCoverTheMeanOfASeriesWithADelayedCorrelation) {
  // Each value depends on the previous one and on the one 15 before. The correlation falls to 0.05 by lag
  // nine and is 0.2 again at lag fifteen, similar to the temperature of a vibrated gas from cycle to cycle.
  std::mt19937_64 generator(8);
  std::normal_distribution<double> fresh;
  const auto echoing = [&](std::size_t n) {
    constexpr std::size_t kBefore = 400;
    std::vector<double> x(kBefore + n);
    for (std::size_t i = 17; i < x.size(); ++i) {
      double echo = 0;
      for (std::size_t lag = 13; lag <= 17; ++lag) echo += x[i - lag] / 5;
      x[i] = 0.64 * x[i - 1] + 0.14 * echo + fresh(generator);
    }
    return std::vector<double>(x.begin() + kBefore, x.end());
  };
  const auto cover = [&](std::size_t n) {
    return coverage(2000, 5, [&] { return series_interval(echoing(n)); });
  };
  test::validate({"V5.12", "coverage, %: 600 values, an echo at 15 whose correlation is 0.2", 93, 3,
                  "95 % less what the window of tau does not see"},
                 cover(600));
  test::validate({"V5.12", "coverage, %: 3000 of the same", 95, 2, "binomial"}, cover(3000));
}

// Series of few correlation times, where errors fail first: of the intervals of overlapping blocks, which
// stood here before, 50 % were given and 90 % of these contained the mean at 10 correlation times.
TEST(Statistics, IntervalsOfShortSeriesCoverTheMean) {
  std::mt19937_64 generator(21);
  struct Case {
    std::size_t n;
    double tau, expected;
  };
  for (const Case& c : {Case{40, 1, 94.5}, Case{40, 2, 92.5}, Case{80, 2, 95}, Case{100, 5, 94},
                        Case{200, 5, 94.8}, Case{600, 20, 95}}) {
    const double a = (2 * c.tau - 1) / (2 * c.tau + 1);
    test::validate({"V5.12",
                    "coverage, %: " + std::to_string(c.n) + " values, correlation time " +
                        std::to_string(c.tau).substr(0, 4),
                    c.expected, 2, "an independent program of the same estimator"},
                   coverage(2000, 5, [&] { return series_interval(correlated(c.n, a, generator)); }));
  }
}

TEST(Statistics, ASlowMotionUnderFastNoise) {
  // White noise of the variance of a slow motion hides its correlation.
  std::mt19937_64 generator(23);
  std::normal_distribution<double> noise;
  const auto cover = [&](std::size_t n, double tau) {
    return coverage(2000, 5, [&] {
      std::vector<double> x = correlated(n, (2 * tau - 1) / (2 * tau + 1), generator);
      const double scale = std::sqrt(2 * tau) / (tau + 0.5);  // sqrt(1 - a^2)
      for (double& value : x) value = value * scale + noise(generator);
      return series_interval(x);
    });
  };
  const char* outside = "an independent program of the same estimator";
  test::validate({"V5.12", "coverage, %: noise over tau = 5, 100 values", 93, 2.5, outside}, cover(100, 5));
  test::validate({"V5.12", "coverage, %: noise over tau = 20, 300 values", 90.5, 3, outside}, cover(300, 20));
  test::validate({"V5.12", "coverage, %: noise over tau = 20, 100 values", 75.7, 4, outside}, cover(100, 20));
}

// A series that is shorter than its memory shows too short a correlation. Those that show the shortest pass
// the test of their length, and their intervals are too narrow: no rule on the estimated correlation time
// finds them, as a stricter one leaves those that are estimated worst.
TEST(Statistics, ARunThatIsShorterThanItsMemoryMayHaveAnIntervalThatIsTooNarrow) {
  std::mt19937_64 generator(24);
  const auto linear = [&](double tau) {
    return series_interval(correlated(400, (2 * tau - 1) / (2 * tau + 1), generator));
  };
  // The mean over four waves of a squared amplitude, as S(q) of a gas; half as long a memory as the
  // amplitude.
  const auto squared = [&](double tau) {
    std::vector<double> sum(400, -1);
    const double a = (4 * tau - 1) / (4 * tau + 1);
    for (int wave = 0; wave < 4; ++wave) {
      const std::vector<double> x = correlated(400, a, generator);
      for (std::size_t i = 0; i < x.size(); ++i) sum[i] += x[i] * x[i] * (1 - a * a) / 4;
    }
    return series_interval(sum);
  };
  struct Case {
    const char* what;
    double tau, given, coverage;
    std::function<std::optional<Interval>(double)> interval;
  };
  for (const Case& c : {Case{"first order", 20, 97.5, 95, linear}, Case{"first order", 40, 60, 90, linear},
                        Case{"first order", 180, 18, 49, linear}, Case{"squares", 20, 97, 94, squared},
                        Case{"squares", 50, 58, 84, squared}, Case{"squares", 180, 20, 45, squared}}) {
    int given = 0, held = 0;
    constexpr int kTrials = 2000;
    for (int k = 0; k < kTrials; ++k)
      if (const auto interval = c.interval(c.tau)) {
        ++given;
        held += interval->low <= 5 && 5 <= interval->high ? 1 : 0;
      }
    std::printf("SHORT|%s, 400 values, tau %g|given %.1f %%|coverage %.1f %%\n", c.what, c.tau,
                100.0 * given / kTrials, 100.0 * held / given);
    EXPECT_NEAR(100.0 * given / kTrials, c.given, 4) << c.what << ", " << c.tau;
    EXPECT_NEAR(100.0 * held / given, c.coverage, c.tau > 50 ? 10 : 4) << c.what << ", " << c.tau;
  }
}

TEST(Statistics, ASeriesThatOscillatesHasANarrowInterval) {
  // x_i = 2 r cos(2 pi/20) x_{i-1} - r^2 x_{i-2} + noise: a height that rings with a period of 20. Its mean
  // is known far better than its first correlations suggest.
  std::mt19937_64 generator(22);
  std::normal_distribution<double> kick;
  constexpr double kRing = 0.95, kTurn = 0.9510565162951535;  // cos(2 pi/20)
  const auto ringing = [&](std::size_t n) {
    std::vector<double> x(500 + n);
    for (std::size_t i = 2; i < x.size(); ++i)
      x[i] = 2 * kRing * kTurn * x[i - 1] - kRing * kRing * x[i - 2] + kick(generator);
    return std::vector<double>(x.begin() + 500, x.end());
  };
  // The spectrum at zero frequency is 1/(1 - 2 r cos + r^2)^2.
  const double gain = 1 - 2 * kRing * kTurn + kRing * kRing, error = 1 / (gain * std::sqrt(300.0));
  double widths = 0;
  test::validate({"V5.12", "coverage, %: 300 values that ring with a period of 20", 95, 2, "binomial"},
                 coverage(2000, 5, [&] {
                   const auto interval = series_interval(ringing(300));
                   if (interval) widths += (interval->high - interval->low) / 2 / (1.96 * error) / 2000;
                   return interval;
                 }));
  EXPECT_NEAR(widths, 1.16, 0.12) << "half width over that of a known spectrum";
}

TEST(Statistics, ASeriesTooShortForItsCorrelationHasNoInterval) {
  std::mt19937_64 generator(6);
  SeriesAverage average;
  for (const double x : correlated(200, 0.98, generator)) average.add(x);  // correlation time 49.5
  EXPECT_FALSE(average.interval("cycles").has_value());
  EXPECT_NE(average.why_no_interval("cycles").find("correlation time"), std::string::npos);
  int walks = 0;
  for (int k = 0; k < 500; ++k) {
    SeriesAverage walk;
    std::normal_distribution<double> step;
    double x = 0;
    for (int i = 0; i < 300; ++i) walk.add(x += step(generator));
    walks += walk.interval("cycles") ? 1 : 0;
  }
  EXPECT_LT(walks, 100) << "of 500 random walks, which have no mean";
  SeriesAverage ramp;
  for (int i = 0; i < 200; ++i) ramp.add(i);
  EXPECT_FALSE(ramp.interval("cycles").has_value());
}

TEST(Statistics, TheMeanOfALongSeriesIsTheMean) {
  SeriesAverage average;
  EXPECT_TRUE(std::isnan(average.mean()));
  for (int i = 1; i <= 10001; ++i) average.add(i);
  EXPECT_NEAR(average.mean(), 5001, 1e-9);
  EXPECT_EQ(average.n(), 10001U);
  SeriesAverage three;
  for (int i = 0; i < 3; ++i) three.add(i);
  EXPECT_FALSE(three.interval("values").has_value());
  EXPECT_FALSE(three.why_no_interval("values").empty());
  SeriesAverage constant;
  for (int i = 0; i < 9; ++i) constant.add(0.25);
  EXPECT_FALSE(constant.interval("values").has_value());
  EXPECT_TRUE(constant.has_no_scatter());
  EXPECT_EQ(constant.why_no_interval("values"), "the same in all 9 values");
}

TEST(Statistics, NoSeriesHasAnIntervalOfZeroWidth) {
  // A sum of 0.1 is not exact in its last digit; a bed that bounces with period two follows from its past.
  for (const std::size_t n : {4, 9, 16, 64, 5000, 20000}) {
    SeriesAverage constant, period_two, about_zero;
    for (std::size_t i = 0; i < n; ++i) {
      constant.add(0.1);
      period_two.add(i % 2 == 0 ? 0.3 : 0.1);
      about_zero.add(i % 2 == 0 ? 1 : -1);
    }
    EXPECT_FALSE(constant.interval("cycles").has_value()) << n;
    EXPECT_NE(constant.why_no_interval("cycles").find("the same in all"), std::string::npos) << n;
    for (const SeriesAverage& series : {period_two, about_zero}) {
      const auto interval = series.interval("cycles");
      if (interval) {
        EXPECT_GT(interval->high - interval->low, 1e-9) << n;
      }
      EXPECT_EQ(interval.has_value(), series.why_no_interval("cycles").empty()) << n;
    }
  }
  SeriesAverage sixteen;
  for (int i = 0; i < 16; ++i) sixteen.add(i % 2 == 0 ? 1 : -1);
  EXPECT_FALSE(sixteen.interval("cycles").has_value());
  EXPECT_NE(sixteen.why_no_interval("cycles").find("period"), std::string::npos);
}

TEST(Statistics, BootstrapCoversMeanAndSpreadOfAFewItems) {
  std::mt19937_64 generator(9);
  std::normal_distribution<double> value;
  std::vector<double> sample(20);
  const auto mean = [&](const std::vector<std::size_t>& pick) {
    double sum = 0;
    for (const std::size_t i : pick) sum += sample[i];
    return sum / static_cast<double>(pick.size());
  };
  const auto draw = [&] {
    for (double& v : sample) v = value(generator);
  };
  test::validate({"V5.12", "coverage, %, of the bootstrap: mean of 20 items", 95, 2, "binomial"},
                 coverage(1000, 0, [&] {
                   draw();
                   return bootstrap_interval(sample.size(), mean, "values", 1, 400);
                 }));
  const auto skewed = [&]() -> std::optional<Interval> {
    for (double& v : sample) v = std::pow(value(generator), 2);
    return mean_interval(sample, "values", 1, 400);
  };
  test::validate(
      {"V5.12", "coverage, %, of the studentised bootstrap: variance of 20 items", 95, 2, "binomial"},
      coverage(1000, 1, skewed));
  EXPECT_FALSE(mean_interval({1}, "values").has_value());
  const auto of_two = mean_interval({1, 2}, "values");
  ASSERT_TRUE(of_two.has_value());
  EXPECT_NEAR(of_two->high, 1.5 + 12.706 * 0.5, 1e-3);  // Student's t
  // The studentised bootstrap of these three values would extend to 2, because two of them are almost equal.
  const auto of_three = mean_interval({0.1435, 0.1436, 0.15}, "values");
  ASSERT_TRUE(of_three.has_value());
  EXPECT_NEAR(of_three->high - of_three->low, 2 * 4.303 * 0.0021502, 1e-5);
  draw();
  const auto once = bootstrap_interval(sample.size(), mean, "values"),
             again = bootstrap_interval(20, mean, "values");
  EXPECT_EQ(again->low, once->low);
  EXPECT_FALSE(bootstrap_interval(1, mean, "values").has_value());
}

TEST(Statistics, ItemsOfWhichAllButOneAgreeHaveAFiniteInterval) {
  // Squared shifts of seven tracers, of which one has moved.
  const std::vector<double> items = {0.01, 0.0100001, 0.0099999, 0.01, 0.0100002, 0.0099998, 0.6};
  const double mean = 0.66 / 7, error = (0.6 - mean) * std::sqrt(7.0 / 6 / 42);  // to 1e-4
  const auto interval = mean_interval(items, "tracers");
  ASSERT_TRUE(interval.has_value());
  EXPECT_LT(interval->high, mean + 4 * 2.447 * error * 1.3);
  EXPECT_GT(interval->high, 0.6) << "the tracer that moved lies in the interval";
  EXPECT_LE(interval->low, mean);
}

TEST(Statistics, ItemsThatAreAllTheSameHaveNoInterval) {
  const std::vector<double> same(8, 0.1);
  const auto mean = [&](const std::vector<std::size_t>& pick) {
    double sum = 0;
    for (const std::size_t i : pick) sum += same[i];
    return sum / static_cast<double>(pick.size());
  };
  EXPECT_FALSE(bootstrap_interval(same.size(), mean, "values").has_value());
  EXPECT_FALSE(mean_interval(same, "values").has_value());
  EXPECT_FALSE(mean_interval({0.1, 0.1, 0.1}, "values").has_value());
}

TEST(Statistics, AValueBelowAllResamplesLiesInItsInterval) {
  // |mean| of values that cancel: nearly every resample exceeds it.
  const std::vector<double> items = {-4, -3, -2, -1, 1, 2, 3, 4};
  const auto off = [&](const std::vector<std::size_t>& pick) {
    double sum = 0;
    for (const std::size_t i : pick) sum += items[i];
    return std::abs(sum);
  };
  const auto interval = bootstrap_interval(items.size(), off, "values");
  ASSERT_TRUE(interval.has_value());
  EXPECT_LE(interval->low, 0);
  EXPECT_GT(interval->high, 0);
}

TEST(Statistics, ExactBinomialAgainstTablesAndCounts) {
  // Clopper-Pearson limits, and the rule of three.
  test::validate({"V5.12", "Clopper-Pearson, 3 of 20, lower", 0.0320709, 1e-6, "table"},
                 binomial_interval(3, 20, "trials").low);
  test::validate({"V5.12", "Clopper-Pearson, 3 of 20, upper", 0.3789268, 1e-6, "table"},
                 binomial_interval(3, 20, "trials").high);
  test::validate({"V5.12", "upper limit for 0 of 100000, times 100000", 2.9957, 1e-3, "-ln 0.05"},
                 1e5 * binomial_interval(0, 1e5, "trials").high);
  test::validate({"V5.12", "Wilson, 3 of 20, lower", 0.0523689, 1e-6, "closed form"},
                 wilson_interval(3, 20, "trials").low);
  test::validate({"V5.12", "Wilson, 3 of 20, upper", 0.3604187, 1e-6, "closed form"},
                 wilson_interval(3, 20, "trials").high);
  EXPECT_EQ(binomial_interval(0, 10, "trials").low, 0);
  EXPECT_NE(binomial_interval(0, 10, "trials").method.find("upper limit"), std::string::npos);
  EXPECT_NEAR(binomial_interval(10, 10, "trials").low, std::pow(0.05, 0.1), 1e-12);
  std::mt19937_64 generator(10);
  std::binomial_distribution<int> slips(20000, 0.01);
  test::validate({"V5.12", "coverage, %, of the binomial interval: 20000 trials at 0.01", 95, 2, "binomial"},
                 coverage(2000, 0.01, [&]() -> std::optional<Interval> {
                   return binomial_interval(slips(generator), 20000, "trials");
                 }));
}

}  // namespace twincell::statistics_test
