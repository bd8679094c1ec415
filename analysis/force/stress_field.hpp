#pragma once
/// \file
/// Stress as a field, coarse-grained with a Gaussian.

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

inline constexpr double kCoarseWidth = 1;  ///< sigma, w of the Gaussian

/// Contact stress at points of the plane (x, z) (Goldhirsch 2010), of a trajectory that stores its contact
/// forces (`simulate --contacts`), positive in compression:
///
///     sigma_ab(r) = sum over contacts of f_a l_b int_0^1 phi(r - r_i + s l) ds,
///     phi(r) = exp(-r^2/2w^2)/(2 pi w^2),   w = 1 sigma
///
/// f is the force on bead i, l the branch vector (branch_vector.hpp), r_i the centre of i; the integral is a
/// difference of error functions. Its integral over the plane is sum f_a l_b, so that the mean of the field
/// is the virial stress. In 3D the branch vectors are projected onto the plane, and the field is the mean
/// over the depth of the cell. Mean over frames, at points in the middle of cells of side about
/// AnalysisOptions::field_cell, heights relative to the plate, up to 4 w above the highest contact; in a cell
/// that is periodic along z the rows fill one period, with heights relative to its lower border. The Gaussian
/// reaches beyond the walls and the surface: within 2 w of them the field is smaller than the stress in the
/// bed. Results; units are m g/sigma in 2D and m g/sigma^2 in 3D:
///
/// - stress_field: [rows x columns x 2 x 2] in the order x, z; row 0 is the lowest
/// - stress_field_x: [columns] x of the points, sigma
/// - stress_field_z: [rows] height of the points above the plate, sigma
///
/// I. Goldhirsch, Granular Matter 12 (2010) 239.
extern const ObservableEntry stress_field_observable;

}  // namespace twincell::analysis
