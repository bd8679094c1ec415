#pragma once
/// \file
/// Least-squares fit of a law (law.hpp) to measured points, with a report of the points used, the parameters
/// with intervals, and tests of the fit.

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "analysis/statistics/statistics.hpp"
#include "calibration/fit/fit.hpp"
#include "calibration/fit/law.hpp"

namespace twincell::calibration {

/// One measured point.
struct DataPoint {
  double x = 0;
  double y = 0;
  double sigma = 0;   ///< standard deviation of y; 0: unknown
  double trials = 0;  ///< number of trials if y is a frequency (bead-periods of p_s); 0: y is not a frequency
};

/// Window of the abscissa, both ends included.
struct FitWindow {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

/// Whether a point was used, and if not, why.
enum class PointUse { used, zero, outside, invalid };

/// Test of whether the signs of the residuals, ordered by x, are in random order: Wald-Wolfowitz runs test
/// with exact probabilities.
struct RunsTest {
  std::size_t positive = 0, negative = 0;  ///< residuals of either sign; zeros are left out
  std::size_t runs = 0;                    ///< uninterrupted sequences of one sign
  double p = 0;  ///< two-sided probability of so few or so many runs; NaN if all have one sign
};
/// \param residuals in the order of x
RunsTest runs_test(const std::vector<double>& residuals);

/// A fitted law with its report.
struct CurveFit {
  const Law* law = nullptr;
  FitReport fit;
  bool weighted = false;  ///< true: by the points' errors; false: equal weights, error from scatter
  /// The parameters maximise the binomial likelihood of all frequencies, zeros included.
  bool likelihood = false;
  std::vector<std::optional<analysis::Interval>> intervals;  ///< 95 % interval of each parameter
  std::vector<PointUse> use;                                 ///< for each input point
  std::size_t n_used = 0;
  /// In the window, but y = 0 and the law is logarithmic: left out unless `likelihood`.
  std::size_t n_zero = 0;
  std::size_t n_outside = 0;  ///< outside the window
  std::size_t n_invalid = 0;  ///< not finite, y < 0 in a logarithmic law, x <= 0 where it must be positive
  std::vector<double> upper_limits;  ///< 95 % limits of zero points with known trials, in input order
  /// between y (or ln y; y if `likelihood`) and the curve; NaN if either is constant
  double correlation = 0;
  RunsTest runs;
  double p_nested = 0;             ///< chance probability of the gain over the nested law; NaN without one
  std::vector<std::string> notes;  ///< caveats for anyone who quotes the parameters

  /// The curve at x, in y (not ln y).
  [[nodiscard]] double at(double x) const;
  /// Standard error of the curve at x from the covariance, in the fitted ordinate (ln y for a logarithmic
  /// law); NaN without covariance.
  [[nodiscard]] double error_at(double x) const;
};

/// Fits the law by least squares (Ceres) from each of its starts and returns the best result. Points are
/// weighted by sigma, or by the binomial error of a frequency, var = y (1 - y)/trials, if every point used
/// has one; in ln y the error is divided by y. Otherwise all points have equal weight and the error is
/// estimated from the scatter (Student's t).
///
/// A logarithmic law of frequencies that all have their trials is fitted by maximum likelihood instead, zeros
/// included: y n counts of n trials with the probability exp(law), by iteratively reweighted least squares
/// (McCullagh & Nelder 1989, chapter 2). With weights from the observed frequencies, and without the zeros,
/// rare counts would be too high. chi^2 is then Pearson's.
///
/// A law that contains a simpler one (Law::nested) is compared with it by the reduction of the sum of squares
/// (F test; chi^2 if weighted). If p > 0.05, its `lost` parameters are reported as undetermined, because data
/// without a bend cannot locate it. Notes also report: as many points as parameters (values without errors),
/// a constant ordinate, an ill-conditioned fit, parameters correlated beyond 0.99, and residuals that are not
/// in random order (p < 0.05).
/// \throws InputError naming the window and the data's range if no point, fewer than 2 distinct abscissas, or
/// fewer points than parameters remain; RunError if the fit converges from no start
CurveFit fit_curve(const Law& law, const std::vector<DataPoint>& points, const FitWindow& window = {});

}  // namespace twincell::calibration
