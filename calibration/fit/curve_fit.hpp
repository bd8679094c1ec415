#pragma once
/// \file
/// A law (law.hpp) fitted to measured points, with an account of what entered, what came out, and what did
/// not.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "analysis/statistics/statistics.hpp"
#include "calibration/fit/fit.hpp"
#include "calibration/fit/law.hpp"

namespace twincell {

/// One measured point.
struct DataPoint {
  double x = 0;
  double y = 0;
  double sigma = 0;   ///< standard deviation of y; 0: unknown
  double trials = 0;  ///< of how many trials y is a frequency (bead-periods of p_s); 0: it is none
};

/// Window of the abscissa, both ends included.
struct FitWindow {
  double low = -1e300;
  double high = 1e300;
};

/// What became of a point.
enum class PointUse { used, zero, outside, invalid };

/// Are the signs of the residuals, ordered by x, in random order? Wald and Wolfowitz's runs, exactly counted.
struct RunsTest {
  std::size_t positive = 0, negative = 0;  ///< residuals of either sign; zeros are left out
  std::size_t runs = 0;                    ///< stretches of one sign
  double p = 0;  ///< probability of a number of runs at least as unlikely on its side, doubled, at most 1;
                 ///< NaN if all have one sign
};
RunsTest runs_test(const std::vector<double>& residuals);

/// A fit and all that is to be said of it.
struct CurveFit {
  const Law* law = nullptr;
  FitReport fit;
  bool weighted = false;  ///< by the points' own errors; else all alike, the error from the scatter
  std::vector<std::optional<Interval>> intervals;  ///< 95 %, of each parameter
  std::vector<PointUse> use;                       ///< of each point given
  std::size_t n_used = 0;
  std::size_t n_zero = 0;     ///< in the window, with y = 0 where a logarithm is fitted: left out
  std::size_t n_outside = 0;  ///< outside the window
  std::size_t n_invalid = 0;  ///< not finite, y below 0 for a logarithm, x not above 0 where it must be
  std::vector<double> upper_limits;  ///< 95 % limits of the zero points with known trials, in order
  double correlation = 0;  ///< of y (or ln y) and the curve at the points; NaN if either is constant
  RunsTest runs;
  double p_nested =
      0;  ///< probability of gaining so much over the nested law by chance; NaN if there is none
  std::vector<std::string> notes;  ///< what a reader must know before quoting the parameters

  /// The curve at x, in y (not ln y).
  [[nodiscard]] double at(double x) const;
  /// Its standard error at x from the covariance, in the ordinate that was fitted (ln y for a logarithm); NaN
  /// without covariance.
  [[nodiscard]] double error_at(double x) const;
};

/// Least squares by Ceres from each of the law's starts; the best end is taken. Points are weighted by sigma,
/// or by the binomial error of a frequency, var = y (1 - y)/trials, if every point used has one; in ln y
/// divided by y. Otherwise all count alike and the error is estimated from the scatter (Student's t).
///
/// A law with a simpler one inside (Law::nested) is compared with it by the gain in squares (F; chi^2 if
/// weighted): where p > 0.05 its `lost` parameters are named undetermined, for data that do not bend cannot
/// say where. Also noted: two points (values without errors), a constant ordinate, an ill-conditioned fit,
/// coefficients correlated beyond 0.99, residuals not in random order (p < 0.05).
/// \throws InputError naming the window and the data's range if no point, fewer than 2 distinct abscissas, or
/// fewer points than parameters remain; RunError if no start comes to an end
CurveFit fit_curve(const Law& law, const std::vector<DataPoint>& points, const FitWindow& window = {});

}  // namespace twincell
