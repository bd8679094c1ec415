#include "reproduce/exponent_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace twincell::reproduce::exponent_error_test {
namespace {

/// y = x^alpha at x = 1, 2, 4, with `scatter` added to ln y at x = 2 and errors of `relative` (half the 95 %
/// interval of ln y).
Estimate exponent(double alpha, double scatter, double relative) {
  std::vector<double> x = {1, 2, 4};
  std::vector<Estimate> y;
  std::vector<calibration::DataPoint> data;
  for (const double at : x) {
    const double value = std::pow(at, alpha) * std::exp(at == 2 ? scatter : 0);
    y.push_back({.value = value, .low = value * std::exp(-relative), .high = value * std::exp(relative)});
    data.push_back({.x = at, .y = value});
  }
  return exponent_with_error(calibration::fit_curve(calibration::law_named("power"), data), x, y);
}

// Points that lie on a line by chance do not make its slope exact: sigma_alpha = sigma sqrt(2) ln 2 / (2 ln^2
// 2) for three points at distances ln 2.
TEST(ExponentError, IsThatOfThePointsWhereTheyLieOnALine) {
  const Estimate alpha = exponent(1.8, 0, 0.02);
  const double expected = 0.02 / (std::sqrt(2.0) * std::log(2.0));
  EXPECT_NEAR(alpha.value, 1.8, 1e-9);
  EXPECT_NEAR(*alpha.high - alpha.value, expected, 1e-3 * expected);
  EXPECT_NEAR(alpha.value - *alpha.low, expected, 1e-3 * expected);
}

// The residuals of ln y are scatter (-1, 2, -1)/3, so that s = scatter sqrt(6)/3 with one degree of freedom,
// of which Student's t is 12.706.
TEST(ExponentError, IsThatOfTheScatterWhereItIsLarger) {
  const double scatter = 0.05;
  const Estimate alpha = exponent(1.8, scatter, 0.001);
  const double expected = 12.706 * scatter * std::sqrt(6.0) / 3 / (std::sqrt(2.0) * std::log(2.0));
  EXPECT_NEAR(*alpha.high - alpha.value, expected, 0.01 * expected);
}

TEST(ExponentError, NeedsNoIntervalOfAPoint) {
  const std::vector<double> x = {1, 2, 4};
  const std::vector<Estimate> y(3, Estimate{.value = 1, .low = {}, .high = {}});
  const calibration::CurveFit fit = calibration::fit_curve(
      calibration::law_named("power"), {{.x = 1, .y = 1}, {.x = 2, .y = 2.1}, {.x = 4, .y = 4}});
  const Estimate alpha = exponent_with_error(fit, x, y);
  EXPECT_EQ(*alpha.low, fit.intervals[1]->low);
  EXPECT_EQ(*alpha.high, fit.intervals[1]->high);
}

}  // namespace
}  // namespace twincell::reproduce::exponent_error_test
