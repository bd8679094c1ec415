#pragma once
/// \file
/// Structure factor of the beads.

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

inline constexpr double kStructureFactorRange = 16;   ///< 1/sigma, largest wavenumber
inline constexpr double kStructureFactorWidth = 0.2;  ///< 1/sigma, width of a bin

/// Static structure factor
///
///     S(q) = <|sum_i w_i exp(i q r_i)|^2/sum_i w_i^2>
///
/// isotropic mean over the wave vectors of each bin of |q| and over the frames at phase 0 (over all frames if
/// they have no phase). 1 for points without interaction; N at a reciprocal lattice vector of a perfect
/// lattice: the first of a triangular lattice of spacing a has |q| = 4 pi/(sqrt(3) a).
///
/// The wave vectors are those that the box admits, q_a = 2 pi n/L_a. Along a periodic axis L is the period
/// and w = 1. Along an axis with walls or a surface, L is the length of the bed's window (bed_window.hpp) and
/// w the Hann window sin^2(pi (r_a - low)/L), which has Fourier components at n = 0, 1 and -1 only. The wave
/// vectors with no other components than these are left out, because they show the extent of the bed. A
/// window is at most 40 sigma (3D: 10 sigma) long and lies in the middle, which bounds the cost per frame; an
/// axis shorter than 2 sigma has q_a = 0 only. Results:
///
/// - S_q: [bins] up to 16/sigma in bins of 0.2/sigma; NaN in bins without wave vectors
/// - S_q_low, S_q_high: [bins] ends of its 95 % interval, as a correlated series over frames
/// - S_q_wavenumber: [bins] centres of the bins, 1/sigma
/// - S_q_peak: scalar, the largest S_q
/// - S_q_peak_wavenumber: scalar, mean |q| of the wave vectors of its bin weighted by their S, 1/sigma
///
/// J.-P. Hansen & I. R. McDonald, Theory of Simple Liquids, sec. 4.1; F. J. Harris, Proc. IEEE 66 (1978) 51.
extern const ObservableEntry structure_factor_observable;

}  // namespace twincell::analysis
