#pragma once
/// \file
/// Laws y(x) that can be fitted to a table.
///
/// To add one: calibration/laws/NAME.cpp with a `const Law& NAME_law()`, one line in the list of law.cpp, a
/// test.

#include <functional>
#include <string>
#include <vector>

namespace ceres {
class CostFunction;
}

namespace twincell::calibration {

/// A point in the ordinate of the fit: y, or ln y for a logarithmic law.
struct FitPoint {
  double x = 0;
  double y = 0;
  double error = 1;  ///< standard deviation of y; 1 if unknown
};

/// Sets of start parameters.
using Starts = std::vector<std::vector<double>>;

/// One law with everything the fit needs.
struct Law {
  std::string name;     ///< "algebraic"
  std::string formula;  ///< "y = a (1 + c x^-b)"
  std::string source;   ///< reference
  std::vector<std::string> parameters;
  bool logarithmic = false;  ///< fitted in ln y: points with y = 0 are left out
  bool positive_x = false;   ///< x must be above 0
  enum class Axis { plain, logarithmic, reciprocal };
  Axis axis = Axis::plain;  ///< axis of x in figures
  std::string nested = {};  ///< simpler law that this one contains as a special case; empty: no such law
  std::vector<std::string> lost;  ///< parameters without effect in that special case
  /// Value of y (or ln y) at x.
  std::function<double(double x, const double* parameters)> value = {};
  /// Start parameters, several if there may be several minima; the best result is used.
  std::function<Starts(const std::vector<FitPoint>&)> starts = {};
  /// For a law whose last parameter is the position of a bend: the least sum of squares, in units of the
  /// errors, with the bend fixed at `bend`. Empty for a law without a bend.
  std::function<double(const std::vector<FitPoint>&, double bend)> squares_bent_at = {};
  /// Cost function (value - y)/error with derivatives; Ceres takes ownership.
  std::function<ceres::CostFunction*(const FitPoint&)> residual = {};
};

/// All laws, in order.
const std::vector<const Law*>& laws();
/// The law of that name.
/// \throws ConfigError naming all of them
const Law& law_named(const std::string& name);

}  // namespace twincell::calibration
