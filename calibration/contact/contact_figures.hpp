#pragma once
/// \file
/// Figures of the contact calibration.

#include <string>
#include <vector>

#include "analysis/report/figure.hpp"
#include "calibration/contact/bounce.hpp"
#include "calibration/contact/collisions.hpp"
#include "calibration/contact/inference.hpp"
#include "calibration/contact/walton.hpp"

namespace twincell::calibration {

/// "bounce": e_n of each impact against its speed, with the mean and its error.
analysis::Figure bounce_figure(const BounceFit& fit);
/// "collisions": e_n against speed, and Walton's plane with the fitted branches.
/// \param shape K
analysis::Figure collisions_figure(const FoundCollisions& found, const WaltonFit& fit, double shape);
/// "profile": chi^2 above its minimum against each parameter, with the 95 % line.
analysis::Figure profile_figure(const Inference& inference);
/// NAME: a measured curve and the curve predicted for the best parameters, element by element.
analysis::Figure curve_figure(const std::string& name, const std::vector<double>& measured,
                              const std::vector<double>& predicted);

}  // namespace twincell::calibration
