#pragma once
/// \file
/// Figure of a fit with its residuals.

#include <string>
#include <vector>

#include "analysis/report/figure.hpp"
#include "calibration/fit/curve_fit.hpp"

namespace twincell::calibration {

/// Upper panel: the points used, points outside the window (open), upper limits of zeros (triangles), and the
/// curve with its 95 % band. Lower panel: the residuals in the fitted ordinate, in units of their errors if
/// the fit is weighted. The axis of x follows Law::axis.
/// \param name base name of the figure's files
/// \param title above the upper panel; empty: the formula of the law
analysis::Figure fit_figure(const CurveFit& fit, const std::vector<DataPoint>& points,
                            const std::string& x_name, const std::string& y_name,
                            const std::string& name = "fit", const std::string& title = {});

}  // namespace twincell::calibration
