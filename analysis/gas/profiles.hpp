#pragma once
/// \file
/// Profiles over height: packing fraction and temperature.

#include <memory>

#include "analysis/observable/observable.hpp"

namespace twincell {

/// Area of the part of a disc of this radius that lies below a line at `height` above its centre, exact;
/// 0 below, pi radius^2 above.
double disc_below(double radius, double height);
/// Volume of the part of a sphere below a plane, likewise.
double sphere_below(double radius, double height);

inline constexpr std::size_t kProfileSamples = 100;  ///< least number of bead velocities in a slab

/// Slabs of thickness sigma, [k, k + 1) in the frame of the cell (plate mean at 0), all frames:
///
///   phi_z   area of discs (2D) or volume of spheres (3D) inside the slab over that of the slab, by exact
///           overlap and not by counting centres; the slab is as wide (and deep) as the cell
///   T_z_z   m <(w - <w>)^2>, w the vertical velocity of beads whose centres are in the slab, <w> its mean
///           over the whole average; absent (NaN) with fewer than kProfileSamples, m g sigma
///   T_z_frames_z  mean over frames of the mean over the slab's beads of m (w - w_cm)^2, w_cm that of all
///           beads of the frame; a frame in which the slab is empty counts as 0. It falls to 0 with height,
///           as the paper's profiles do and T_z_z does not; the paper says only "averaging T_z in a box"
///   T_x_z   the same as T_z_z of the horizontal velocity along x
///   profile_z  centres of the slabs, sigma
///   T_z_volume  mean of T_z_z over the lowest slabs that hold 99 % of the beads: an average over volume, as
///               the paper's introduction has it, where T_z is one over beads
///
/// Kinetic convention: eq. 5 of Bhateja et al. 2016 has (m/2) where their numbers have m. Bhateja, Sharma &
/// Singh 2016, Figs. 12 to 16.
std::unique_ptr<Observable> make_profiles(const AnalysisContext& context);

}  // namespace twincell
