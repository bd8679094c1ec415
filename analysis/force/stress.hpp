#pragma once
/// \file
/// Stress tensor and forces on the walls.

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

inline constexpr double kStressSlab = 1;  ///< sigma, thickness of a slab of the profiles

/// Stress of a bed whose trajectory stores its contact forces (`simulate --contacts`), positive in
/// compression:
///
///     sigma_ab = 1/V sum over contacts of f_a l_b                      (virial, Love & Weber)
///     sigma^kin_ab = 1/V sum over beads of m v'_a v'_b
///
/// f is the force on bead i, l the branch vector: from the centre of j to that of i, (R_i + R_j - overlap) n,
/// or from the wall to the centre of i, (R_i - overlap) n. v' is relative to the mean velocity of the frame.
/// V is the area (3D: volume) of the bed's window (bed_window.hpp) with a margin of half a bead diameter; in
/// a box periodic on all sides it is that of the box. Means over frames; 95 % intervals of correlated series.
///
/// The profile is the stress coarse-grained with a box function (Goldhirsch 2010): the part of each branch
/// vector that lies in a horizontal slab of thickness sigma counts for this slab, whose width (and depth) is
/// that of the window. Heights are relative to the plate; in a cell that is periodic along z the slabs fill
/// one period, are L_z/round(L_z/sigma) thick, and their heights are relative to its lower border.
///
/// Results; units are m g/sigma in 2D and m g/sigma^2 in 3D:
///
/// - stress: [2][2] in the order x, z; 3D: [3][3] in the order x, y, z; row a, column b
/// - stress_kinetic: the same of the velocities
/// - pressure: scalar, trace of stress over d
/// - pressure_kinetic: scalar, trace of stress_kinetic over d
/// - stress_xx_z, stress_zz_z: [slabs] profiles of two components of stress
/// - stress_z: [slabs] centres of the slabs above the plate, sigma
/// - wall_force: [walls] mean normal force on each wall, m g; the convention names the walls in their order
///
/// I. Goldhirsch, Granular Matter 12 (2010) 239.
extern const ObservableEntry stress_observable;

}  // namespace twincell::analysis
