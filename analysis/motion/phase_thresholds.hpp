#pragma once
/// \file
/// Thresholds of bouncing and convection, and the phase of the bed (Fortini & Huang 2015, app. B). The parts
/// are in bouncing_measure.hpp (s_b), convection_measure.hpp (s_c), detection_limit.hpp and bed_phase.hpp.

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// Thresholds of bouncing and convection, and the phase of the bed. N_t is the number of tracers, N_k the
/// number of phases per cycle, N_f the number of cycles. Lengths are in sigma. Results:
///
/// - s_k: [N_k] mean height of the tracers above the plate at phase k (B3)
/// - s_b: scalar, (B4) in the requested form; 95 % interval by bootstrap over tracers
/// - s_b_variance, s_b_about_rest, s_b_as_printed: scalars, the three forms of s_b
/// - half_pixel: scalar, half a pixel of the camera
/// - s_b_noise: scalar, s_b of a bed at rest from the position uncertainties alone, sigma_z/sqrt(N_t N_f)
/// - s_j_noise: scalar, contribution of the position uncertainties to s_j, added in quadrature
/// - s_j: [cycles] spread of the tracers' heights at the beginning of each cycle (B1); NaN for a cycle
///   without a value
/// - s_c: scalar, root mean square of s_j (B2); 95 % interval of s_j^2 as a correlated series over cycles, or
///   from the scatter between tracers if s_j is not stationary
/// - cycle_of_convection: scalar, first cycle with s_j > sigma
/// - s_j_growth, s_j_growth_late: scalars, d s_j^2/dj over all cycles and over the second half
///   (tracer_line.hpp), sigma^2 per cycle
/// - drift: text, drift_name (tracer_line.hpp)
/// - phase: text, phase_name (bed_phase.hpp)
/// - tracers: [N_t] ids of the tracers
/// - tracer_heights: [cycles x N_t] heights of the tracers at the beginning of each cycle
///
/// s(k) is averaged over whole cycles. If there are two or more, an even number of them is used: a bed that
/// repeats its motion every two cycles would bias an odd number. An instant counts if at least 80 % of the
/// tracers are present. Jumps of one tracer by more than sigma/2 between the beginnings of consecutive cycles
/// are reported in the convention of s_j. Absent results state the reason: fewer than 2 tracers (s_j); fewer
/// than 2 phases, no plate height, or no whole cycle (s_b); a cell that is periodic along z (all).
extern const ObservableEntry phase_thresholds_observable;

}  // namespace twincell::analysis
