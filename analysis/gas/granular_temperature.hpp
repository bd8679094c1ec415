#pragma once
/// \file
/// Granular temperature in the conventions of both papers, side by side.

#include <memory>

#include "analysis/observable/observable.hpp"
#include "trajectory/temperature.hpp"

namespace twincell {

/// T_g of one frame, in m g sigma:  (1/2) (1/N) sum m_i |v_i - v_cm|^2: half the sum of
/// temperature_components (trajectory/temperature.hpp).
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
///   T_g_aliasing, T_z_aliasing   what the mean over the frames of whole cycles would be above the mean over
///                  time, as a share of it: a bed lands within a tenth of t0, and N_k phases locked to the
///                  drive see it or do not. Absent where the file has no means over time: then it is not
///                  known
///   T_g_sampling   what every second sample of the time means would give above all of them, as a share
/// Means over time where the frames bring them (Frame::time_mean), otherwise over the frames of whole cycles,
/// so that all phases weigh the same, with block averages over cycles; over frames where the frames are not
/// locked to the drive. T_z_field is of frames always. Absent for a trajectory without velocities: a
/// difference between frames would be another quantity (it averages over the time between them), so it is not
/// put in its place.
std::unique_ptr<Observable> make_granular_temperature(const AnalysisContext& context);

}  // namespace twincell
