#pragma once
/// \file
/// Height of the centre of mass.

#include <memory>

#include "analysis/observable.hpp"

namespace twincell {

/// sum m_i z_i/sum m_i over the beads present, sigma, in the frame of the cell (plate mean at 0); NaN if
/// there is none.
double barycentre_height(const Frame& frame, const std::vector<double>& mass);

/// Results h_cm (mean over whole cycles, or over frames without phases), h_cm_k (mean in each phase), h_cm_j
/// (mean of each whole cycle), delta_h_cm = h_cm - AnalysisOptions::rest_height (absent without it: a rest
/// height is measured, as h_cm of the same bed with the drive at rest, and never assumed) and delta_h_bar =
/// delta_h_cm g/V_p^2. Bhateja, Sharma & Singh 2016, Table II and Fig. 7.
std::unique_ptr<Observable> make_barycentre(const AnalysisContext& context);

}  // namespace twincell
