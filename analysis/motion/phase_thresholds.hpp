#pragma once
/// \file
/// Phase of the bed from s_b and s_c and their thresholds (Fortini & Huang 2015, app. B).

#include <array>
#include <string>

#include "analysis/observable/observable.hpp"
#include "core/choice.hpp"

namespace twincell::analysis {

/// Threshold of s_b above which the bed leaves the plate, sigma: half a pixel of paper 1's camera.
inline constexpr double kBouncingThreshold = 1.0 / 30;
/// Threshold of s_c above which the bed convects, sigma.
inline constexpr double kConvectionThreshold = 1;

/// Phases of the bed.
enum class BedPhase { undetermined, co_moving, bouncing, convecting };
/// All phases with their words.
inline constexpr std::array kBedPhases = {
    Choice<BedPhase>{BedPhase::undetermined, "undetermined", "the measurement does not decide"},
    Choice<BedPhase>{BedPhase::co_moving, "co-moving", "the bed stays on the plate: s_b <= sigma/30"},
    Choice<BedPhase>{
        BedPhase::bouncing, "bouncing",
        "the bed leaves the plate, its beads keep their neighbours: s_b > sigma/30, s_c <= sigma"},
    Choice<BedPhase>{BedPhase::convecting, "convecting",
                     "the bed leaves the plate and convects: s_b > sigma/30, s_c > sigma"}};
/// The word of a phase.
std::string phase_name(BedPhase phase);
/// What begins with a phase, as in "onset of bouncing" and "onset of convection".
std::string onset_name(BedPhase phase);
/// Inverse of phase_name; undetermined for any other text.
BedPhase phase_named(const std::string& name);

/// Phase of a bed. co-moving: s_b <= sigma/30; bouncing: s_b > sigma/30 and s_c <= sigma; convecting: both
/// above. NaN represents a missing number; the phase is undetermined if it depends on that number.
BedPhase bed_phase(double s_b, double s_c);

/// s_b of a curve s(k), k = 0 .. N_k - 1, N_k >= 2, in sigma:
///
/// - variance: s_b^2 = mean over k of (s(k) - mean s)^2 (default)
/// - about_rest: s_b^2 = mean over k of (s(k) - s_rest)^2
/// - as_printed: s_b^2 = mean over k of s(k)^2 (eq. B4 as printed: a squared height)
///
/// The text of the paper calls s_b^2 "the variance over all phases"; the printed form would always exceed
/// sigma/30.
double s_b_of(const std::vector<double>& s_k, SbForm form, double rest_height);

/// Thresholds of bouncing and convection, and the phase of the bed. N_t is the number of tracers, N_k the
/// number of phases per cycle. Lengths are in sigma. Results:
///
/// - s_k: [N_k] mean height of the tracers above the plate at phase k (B3)
/// - s_b: scalar, (B4) in the requested form; 95 % interval by bootstrap over tracers
/// - s_b_variance, s_b_about_rest, s_b_as_printed: scalars, the three forms of s_b
/// - half_pixel: scalar, half a pixel of the camera
/// - s_b_noise: scalar, s_b of a bed at rest from the position uncertainties alone, sigma_z/sqrt(N_t N_f)
/// - s_j_noise: scalar, contribution of the position uncertainties to s_j, added in quadrature
/// - s_j: [cycles] spread of the tracers' heights at the beginning of each cycle (B1); NaN for a cycle
///   without a value
/// - s_c: scalar, root mean square of s_j (B2); 95 % interval as a correlated series of s_j^2 over cycles, or
/// by
///   bootstrap over tracers if s_j drifts
/// - cycle_of_convection: scalar, first cycle with s_j > sigma
/// - s_j_growth, s_j_growth_late: scalars, d s_j^2/dj over all cycles and over the second half
///   (tracer_line.hpp), sigma^2 per cycle
/// - drift: text, still, annealed, drifting or mixing (tracer_line.hpp)
/// - phase: text, phase_name
/// - tracers: [N_t] ids of the tracers
/// - tracer_heights: [cycles x N_t] heights of the tracers at the beginning of each cycle
///
/// s(k) is averaged over whole cycles. If there are two or more, their number is even, because a bed of
/// period 2 would bias an odd number. An instant counts if at least 80 % of the tracers are present. Jumps of
/// one tracer by more than sigma/2 between the beginnings of consecutive cycles are reported in the
/// convention of s_j. Absent results state the reason: fewer than 2 tracers (s_j); fewer than 2 phases, no
/// plate height, or no whole cycle (s_b).
extern const ObservableEntry phase_thresholds_observable;

}  // namespace twincell::analysis
