#pragma once
/// \file
/// Laws y(x) that a table can be fitted with.
///
/// To add one: calibration/laws/NAME.cpp with a `const Law& NAME_law()`, one line in the list of law.cpp, a
/// test.

#include <functional>
#include <string>
#include <vector>

namespace ceres {
class CostFunction;
}

namespace twincell {

/// A point as the fit sees it: y is what the law gives, its logarithm if the law is one of ln y.
struct FitPoint {
  double x = 0;
  double y = 0;
  double error = 1;  ///< standard deviation of y; 1 if none is known
};

/// Sets of parameters to begin with.
using Starts = std::vector<std::vector<double>>;

/// One law.
struct Law {
  std::string name;     ///< "algebraic"
  std::string formula;  ///< "y = a (1 + c x^-b)"
  std::string source;   ///< whose law it is
  std::vector<std::string> parameters;
  bool logarithmic = false;  ///< fitted in ln y: points with y = 0 have no place in it
  bool positive_x = false;   ///< x must be above 0
  enum class Axis { plain, logarithmic, reciprocal };
  Axis axis = Axis::plain;        ///< how x is drawn so that the law looks simple
  std::string nested = {};        ///< the law that this one becomes when it has nothing to say; empty: none
  std::vector<std::string> lost;  ///< parameters that mean nothing then
  /// y (or ln y) at x.
  std::function<double(double x, const double* parameters)> value = {};
  /// Where to begin: several starts if there may be several minima; the best end is taken.
  std::function<Starts(const std::vector<FitPoint>&)> starts = {};
  /// Of a law whose last parameter is where it bends: the least sum of squares, in units of the errors, with
  /// the bend held there. Empty for a law without a kink.
  std::function<double(const std::vector<FitPoint>&, double bend)> squares_bent_at = {};
  /// (value - y)/error with its derivatives, for Ceres, which takes it over.
  std::function<ceres::CostFunction*(const FitPoint&)> residual = {};
};

/// All laws, in order.
const std::vector<const Law*>& laws();
/// The law of that name. \throws ConfigError naming all of them
const Law& law_named(const std::string& name);

}  // namespace twincell
