#pragma once
/// \file
/// The phases of the runs of a comparison.

#include <vector>

#include "analysis/report/figure.hpp"
#include "analysis/runs/phase_boundaries.hpp"
#include "analysis/runs/phase_diagram.hpp"

namespace twincell::analysis {

/// The phases in the plane (N_l sigma, Gamma), with a K_m axis on the right if all runs have the same omega
/// (Fortini & Huang 2015, Fig. 3). The brackets of the runs' onsets are bars beside the symbols; for beds of
/// one height the phases between them are shaded.
Figure phase_diagram_figure(const std::vector<Run>& runs, const std::vector<PhaseBoundary>& boundaries);
/// The phases of both sides along Gamma, for runs that all have the same N_l.
Figure phase_strip_figure(const std::vector<Run>& runs);

}  // namespace twincell::analysis
