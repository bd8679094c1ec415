#pragma once
/// \file
/// The interval of an exponent that an unweighted power law gives.

#include <vector>

#include "calibration/fit/curve_fit.hpp"
#include "reproduce/verdict.hpp"

namespace twincell::reproduce {

/// alpha of y = C x^alpha with the wider of two 95 % intervals: that of the fit, which knows the scatter of
/// the points about the line alone and is too narrow where few points happen to lie on a line, and that which
/// the points' own intervals give. In the latter, with l = ln x and an unweighted fit, sigma_alpha^2 = sum_k
/// ((l_k - mean l) / sum_j (l_j - mean l)^2)^2 sigma_k^2, where sigma_k is a quarter of the interval of ln
/// y_k. A point with an open interval adds nothing. \param fit an unweighted fit of the law "power" \param x,
/// y the points that the fit uses; all positive \pre x.size() == y.size()
Estimate exponent_with_error(const calibration::CurveFit& fit, const std::vector<double>& x,
                             const std::vector<Estimate>& y);

}  // namespace twincell::reproduce
