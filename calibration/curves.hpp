#pragma once
/// \file
/// The curves of the papers: a barrier from slip probabilities, an exponent from a power law.

#include <string>
#include <vector>

#include "calibration/fit.hpp"

namespace twincell {

/// Window of the abscissa, both ends included.
struct FitWindow {
  double low = -1e300;
  double high = 1e300;
};

/// A fit on a logarithmic scale with what could not enter it.
struct CurveFit {
  FitReport fit;
  std::size_t n_used = 0;
  std::size_t n_zero = 0;     ///< points in the window whose ordinate is 0: no logarithm, left out
  std::size_t n_outside = 0;  ///< points outside the window
  std::size_t n_invalid = 0;  ///< points that are not finite or negative
  std::string
      flag;  ///< "two points: values without errors", "constant ordinate"; empty if nothing is to be said
};

/// One measured point of p_s against K_m.
struct SlipPoint {
  double k_m = 0;
  double p_s = 0;
  double trials = 0;  ///< n_beads n_periods; 0: unknown
};

/// ln p_s = c - E_b/K_m, parameters "c", "E_b" (Fortini & Huang 2015, sec. V, Arrhenius form): least squares
/// in ln p_s over the window in K_m. If every point has trials, each is weighted by its binomial error,
/// var(ln p_s) = (1 - p_s)/(p_s trials), and the covariance is that of the counts; otherwise unweighted.
/// Points with p_s = 0 are left out and counted: an upper limit 3/trials each (95 %), which `upper_limits`
/// returns. \throws InputError if no point, or fewer than 2 distinct K_m, remain (the sentence names the
/// window and the data's range)
CurveFit fit_arrhenius(const std::vector<SlipPoint>& points, const FitWindow& window = {});

/// 95 % upper limits 3/trials of the points with p_s = 0 and known trials, in order.
std::vector<double> upper_limits(const std::vector<SlipPoint>& points);

/// One point of y against x.
struct CurvePoint {
  double x = 0;
  double y = 0;
};

/// ln y = ln C + alpha ln x, parameters "ln_C", "alpha" (Bhateja et al. 2016, Table I): least squares,
/// unweighted, over the window in x. Points with y = 0 are left out and counted. \throws InputError as
/// fit_arrhenius
CurveFit fit_power_law(const std::vector<CurvePoint>& points, const FitWindow& window = {});

}  // namespace twincell
