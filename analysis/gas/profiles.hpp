#pragma once
/// \file
/// Profiles along height: packing fraction and granular temperature.

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// Exact area of the segment of a disc below a horizontal line at `height` above the disc's centre: 0 if
/// height <= -radius, pi radius^2 if height >= radius.
double disc_below(double radius, double height);
/// Exact volume of the segment of a sphere below a horizontal plane at `height` above the sphere's centre.
double sphere_below(double radius, double height);

inline constexpr std::size_t kProfileSamples = 100;  ///< minimum number of bead velocities in a slab

/// Profiles over all frames in horizontal slabs of thickness sigma, [k, k + 1) in the frame of the cell (mean
/// height of the plate at 0). The arrays have the shape [slabs].
///
/// - phi_z: area of discs (2D) or volume of spheres (3D) inside the slab divided by that of the slab, by
///   exact overlap instead of counting centres; the slab is as wide (and deep) as the cell
/// - T_z_z: m <(w - <w>)^2>, m g sigma, with w the vertical velocity of the beads whose centres are in the
///   slab and <w> its mean over all frames; NaN with fewer than kProfileSamples velocities
/// - T_z_frames_z: mean over frames of the mean over the slab's beads of m (w - w_cm)^2, m g sigma, with w_cm
///   the velocity of the centre of mass of all beads in the frame. A frame in which the slab is empty counts
///   as 0. This profile falls to 0 with height, as the paper's profiles do and T_z_z does not; the paper
///   states only "averaging T_z in a box"
/// - T_z_instant_z: mean over frames of the mean over the slab's beads of m (w - <w>_now)^2, m g sigma, with
///   <w>_now the mean of the slab in that frame. A frame with fewer than two beads in the slab counts as 0.
///   This profile falls to 0 with height too
/// - T_x_z: as T_z_z, for the horizontal velocity along x
/// - profile_z: centres of the slabs, sigma
/// - T_z_volume: scalar, mean of T_z_z over the lowest slabs that contain 99 % of the beads. This is an
///   average over volume, as in the paper's introduction, whereas T_z is an average over beads
///
/// Kinetic convention: eq. 5 of Bhateja et al. 2016 has the factor m/2 where their numbers have m. Bhateja,
/// Sharma & Singh 2016, Figs. 12 to 16.
extern const ObservableEntry profiles_observable;

}  // namespace twincell::analysis
