#pragma once
/// \file
/// Granular temperature in the conventions of both papers, side by side.

#include "analysis/observable/observable.hpp"
#include "trajectory/temperature.hpp"

namespace twincell::analysis {

/// Granular temperature T_g of one frame, in m g sigma:  (1/2) (1/N) sum m_i |v_i - v_cm|^2, which is half
/// the sum of temperature_components (trajectory/temperature.hpp).
/// Fortini & Huang 2015, eq. 2.
double granular_temperature(const Frame& frame, const std::vector<double>& mass);

/// Results, in m g sigma unless stated otherwise. T_g is the quantity that Fortini & Huang call T_g*.
///
/// - T_g: (m/2) <|v'|^2>, all components (Fortini & Huang 2015, eq. 2)
/// - T_x, T_y, T_z: m <u'^2>, m <v'^2>, m <w'^2>, the numbers that Bhateja et al. 2016 print (Table III)
/// - T: mean of T_x, T_y, T_z over the d_f = 2 or 3 dimensions of the cell
/// - T_z_eq5: (m/2) <w'^2>, eq. 5 of Bhateja et al. as printed, half of T_z
/// - T_z_lab: m <w^2>, w the vertical velocity in the lab frame: T_z and the motion of the centre of mass
/// - T_z_field: m <w'^2> about the mean velocity at the same phase and height (slabs of thickness sigma, lab
///   frame) instead of about the centre of mass
/// - T_bar_z, T_bar: T_z and T in units of m V_p^2, V_p = A omega (dimensionless)
/// - T_z_tau: integrated correlation time of T_z, in cycles (or frames); its error bar is based on this time
/// - T_g_aliasing, T_z_aliasing: relative excess of the mean over the frames of whole cycles over the mean
///   over time. A bed lands within a tenth of t0, and N_k phases locked to the drive sample the landing or
///   miss it. Absent if the file has no means over time: the aliasing is then unknown
/// - T_g_sampling: relative excess of the time mean from every second sample over the time mean from all
///
/// The means are over time if the frames contain time means (Frame::time_mean). Otherwise they are over the
/// frames of whole cycles, so that all phases have the same weight, as correlated series over cycles; if the
/// frames are not locked to the drive, they are over all frames. T_z_lab and T_z_field always use frames.
/// All results are absent for a trajectory without velocities: a difference between frames is a different
/// quantity (it averages over the time between them) and does not replace the velocity.
extern const ObservableEntry granular_temperature_observable;

}  // namespace twincell::analysis
