#pragma once
/// \file
/// Figure of the phase boundaries, with the points of sweeps.

#include "analysis/report/figure.hpp"
#include "analysis/runs/comparison.hpp"

namespace twincell::analysis {

/// "boundaries": onsets of bouncing (blue) and of convecting (vermilion) with their intervals over N_l sigma,
/// of experiment (open circle), simulation (filled circle) and sweep (square, joined by lines for each
/// start), and the points of the sweeps, small, by their phase (Fortini & Huang 2015, Fig. 3). An onset with
/// one limit only is a triangle that points to where it lies.
/// \pre the comparison has boundaries or points of a sweep
Figure boundary_figure(const Comparison& comparison);

}  // namespace twincell::analysis
