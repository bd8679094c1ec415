#pragma once
/// \file
/// Granular temperature as paper 1 defines it.

#include <memory>

#include "analysis/observable.hpp"

namespace twincell {

/// T_g of one frame, in m g sigma:  (1/2) (1/N) sum m_i |v_i - v_cm|^2  over the beads present, with the
/// instantaneous centre-of-mass velocity; all components, no rotation. `mass` empty: every mass is 1. For N
/// beads with independent velocities of variance T/m per component it is d T/2 (1 - 1/N): the factor (1 -
/// 1/N) belongs to the definition and is not corrected. NaN for no beads or no velocities. Fortini & Huang
/// 2015, eq. 2.
double granular_temperature(const Frame& frame, const std::vector<double>& mass);

/// Result T_g: mean over frames. Absent for a trajectory without velocities: a difference between frames
/// would be another quantity (it averages over the time between them), so it is not put in its place.
std::unique_ptr<Observable> make_granular_temperature(const AnalysisContext& context);

}  // namespace twincell
