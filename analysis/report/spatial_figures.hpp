#pragma once
/// \file
/// Figures of one trajectory: lattice, convection field, profiles, and defects over time.

#include <vector>

#include "analysis/observable/observable.hpp"
#include "analysis/report/figure.hpp"

namespace twincell::analysis {

/// The displacement field as arrows (results displacement_field, field_x, field_z), magnified so that the
/// longest arrow is as long as a cell is wide. The colours distinguish up and down.
Figure convection_figure(const std::vector<Result>& results, const Box& box);

/// phi_z, T_z_z and T_x_z against height.
Figure profiles_figure(const std::vector<Result>& results);

/// defect_fraction_j against the cycle.
Figure defect_evolution_figure(const std::vector<Result>& results);

/// Beads of one frame to scale, coloured by the lattice direction (A to B, pale where psi6 is below kOrdered)
/// and marked where the number of Voronoi neighbours is 5 or 7.
/// \pre the box is planar
Figure lattice_figure(const Frame& frame, const TrajectoryInfo& info, const AnalysisOptions& options);

/// All figures for which the results have values, and the lattice of the last frame.
std::vector<Figure> spatial_figures(const std::vector<Result>& results, const TrajectorySource& trajectory,
                                    const AnalysisOptions& options);

}  // namespace twincell::analysis
