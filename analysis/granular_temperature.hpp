#pragma once
/// \file
/// Granular temperature in the conventions of both papers, side by side.

#include <memory>

#include "analysis/observable.hpp"

namespace twincell {

/// m <v'^2> of one frame, per component, in m g sigma:  (1/N) sum m_i (v_i - v_cm)^2  over the beads present,
/// v_cm the centre-of-mass velocity of that instant; rotation does not enter. `mass` empty: every mass is 1.
/// For N beads with independent velocities of variance T/m per component it is T (1 - 1/N): the factor
/// belongs to the definition and is not corrected. NaN for no beads or no velocities.
Vec3 temperature_components(const Frame& frame, const std::vector<double>& mass);

/// T_g of one frame, in m g sigma:  (1/2) (1/N) sum m_i |v_i - v_cm|^2: half the sum of the components above.
/// Fortini & Huang 2015, eq. 2.
double granular_temperature(const Frame& frame, const std::vector<double>& mass);

/// Results, in m g sigma unless said otherwise, T_g being the number that Fortini & Huang write T_g*:
///   T_g            (m/2) <|v'|^2>, all components                            (Fortini & Huang 2015, eq. 2)
///   T_x, T_y, T_z  m <u'^2>, m <v'^2>, m <w'^2>: the numbers that Bhateja et al. 2016 print (Table III)
///   T              their mean over the d_f = 2 or 3 dimensions of the cell
///   T_z_eq5        (m/2) <w'^2>: their eq. 5 as printed, half of T_z
///   T_z_field      m <w'^2> about the mean velocity at that phase and height (slabs of sigma, lab frame)
///                  instead of about the centre of mass
///   T_bar_z, T_bar T_z and T in units of m V_p^2, V_p = A omega              (1)
///   T_z_tau        integrated correlation time of T_z, in cycles (or frames): what its error bar rests on
/// Means over the frames of whole cycles, so that all phases weigh the same, with block averages over cycles;
/// over frames where the frames are not locked to the drive. Absent for a trajectory without velocities: a
/// difference between frames would be another quantity (it averages over the time between them), so it is not
/// put in its place.
std::unique_ptr<Observable> make_granular_temperature(const AnalysisContext& context);

}  // namespace twincell
