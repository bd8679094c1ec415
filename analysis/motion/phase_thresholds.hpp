#pragma once
/// \file
/// Which phase the bed is in: s_b and s_c against their thresholds (Fortini & Huang 2015, app. B).

#include <memory>
#include <string>

#include "analysis/observable/observable.hpp"

namespace twincell {

/// s_b above this: the bed leaves the plate (half a pixel of paper 1's camera). sigma.
inline constexpr double kBouncingThreshold = 1.0 / 30;
/// s_c above this: the bed convects. sigma.
inline constexpr double kConvectionThreshold = 1;

/// Phases of the bed.
enum class BedPhase { undetermined, co_moving, bouncing, convecting };
/// "undetermined", "co-moving", "bouncing", "convecting".
std::string phase_name(BedPhase phase);
/// Inverse of phase_name; undetermined for any other text.
BedPhase phase_named(const std::string& name);

/// co-moving: s_b <= sigma/30; bouncing: s_b > sigma/30 and s_c <= sigma; convecting: both above.
/// NaN stands for a number that is missing; the phase is undetermined if it depends on it.
BedPhase bed_phase(double s_b, double s_c);

/// s_b of a curve s(k), k = 0 .. N_k - 1, N_k >= 2:
///   variance    s_b^2 = mean over k of (s(k) - mean s)^2                (default)
///   about_rest  s_b^2 = mean over k of (s(k) - s_rest)^2
///   as_printed  s_b^2 = mean over k of s(k)^2                           (eq. B4 as printed: a squared
///   height)
/// The text of the paper calls s_b^2 "the variance over all phases"; the printed form would always exceed
/// sigma/30.
double s_b_of(const std::vector<double>& s_k, SbForm form, double rest_height);

/// Results
///   s_k   [N_k]      mean height of the tracers above the plate in phase k (B3)
///   s_b   scalar     (B4) in the form asked for; 95 % interval by bootstrap over tracers
///   s_b_variance, s_b_about_rest, s_b_as_printed   the three forms side by side
///   half_pixel, s_b_noise, s_j_noise   what the camera cannot tell: half a pixel; s_b of a bed at rest from
///   the
///                    uncertainties of positions, sigma_z/sqrt(N_t N_f); the same in s_j. sigma
///   s_j   [cycles]   spread of the tracers' heights at the beginning of each cycle (B1); NaN for a cycle
///   without
///                    value
///   s_c   scalar     root mean square of s_j (B2); 95 % interval by block averages of s_j^2 over cycles, or
///   by
///                    bootstrap over tracers where s_j drifts
///   cycle_of_convection   first cycle with s_j > sigma
///   s_j_growth, s_j_growth_late   d s_j^2/dj over all cycles and over the second half (tracer_line.hpp)
///   drift            a word: still, annealed, drifting, mixing (tracer_line.hpp)
///   phase            a word
///   tracers [N_t], tracer_heights [cycles x N_t]   who they are, and where at the beginning of each cycle
/// s(k) is averaged over whole cycles, an even number of them if there are two or more (a bed of period 2
/// would bias an odd number). A moment counts if at least 80 % of the tracers are there; jumps of one tracer
/// by more than sigma/2 from one cycle's beginning to the next are counted in the convention of s_j. Absent
/// with the reason: fewer than 2 tracers (s_j), fewer than 2 phases, no plate height, no whole cycle (s_b).
std::unique_ptr<Observable> make_phase_thresholds(const AnalysisContext& context);

}  // namespace twincell
