#pragma once
/// \file
/// Figures of the runs of a comparison: thresholds, and series over a cycle and over cycles.

#include <vector>

#include "analysis/report/figure.hpp"
#include "analysis/runs/phase_diagram.hpp"

namespace twincell::analysis {

/// s_b and s_c against Gamma with intervals and thresholds.
Figure thresholds_figure(const std::vector<Run>& runs);
/// s(k) minus its mean against the phase, both sides.
Figure s_k_figure(const std::vector<Run>& runs);
/// s_j against the cycle, both sides.
Figure s_j_figure(const std::vector<Run>& runs);

}  // namespace twincell::analysis
