#pragma once
/// \file
/// Distribution of contact forces.

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

inline constexpr double kForceRange = 8;    ///< largest ratio of a force to the mean of its frame
inline constexpr double kForceWidth = 0.1;  ///< width of a bin

/// Forces between beads, of a trajectory that stores them (`simulate --contacts`), over the frames with
/// contacts between beads. f_n is the normal force of a contact, f_t the modulus of its tangential force, <.>
/// the mean over the contacts of a frame.
///
/// - contact_force: <f_n>, mean over frames, m g; 95 % interval of a correlated series
/// - tangential_to_normal: <f_t>/<f_n>, mean over frames weighted by <f_n>; same
/// - contact_force_density: [bins] probability density of f_n/<f_n>, in bins of 0.1 up to 8, mean over frames
/// - contact_force_density_low, contact_force_density_high: [bins] ends of its 95 % interval
/// - contact_force_ratio: [bins] centres of the bins
/// - mechanical_contact_number: mean number of contacts of the beads that take part in the transmission of
///   forces,
///
///       Z_m = (sum over beads of their contacts - N_1)/(N - N_0 - N_1)
///
///   with N beads, N_0 of them without contact and N_1 with one; contacts with walls count. A packing that is
///   rigid by friction alone has at least d + 1. C. Thornton, Geotechnique 50 (2000) 43
///
/// D. M. Mueth, H. M. Jaeger & S. R. Nagel, Phys. Rev. E 57 (1998) 3164.
extern const ObservableEntry contact_force_observable;

}  // namespace twincell::analysis
