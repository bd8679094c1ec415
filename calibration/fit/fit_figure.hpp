#pragma once
/// \file
/// A fit as a picture.

#include <string>
#include <vector>

#include "analysis/report/figures.hpp"
#include "calibration/fit/curve_fit.hpp"

namespace twincell {

/// Above: the points (open where they did not enter; triangles for upper limits of zeros), the curve with its
/// 95 % band. Below: the residuals in the ordinate that was fitted, in units of their errors if they have
/// any. x is drawn as the law likes it (Law::axis). \param name of the figure's files
Figure fit_figure(const CurveFit& fit, const std::vector<DataPoint>& points, const std::string& x_name,
                  const std::string& y_name, const std::string& name = "fit");

}  // namespace twincell
