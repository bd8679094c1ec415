#pragma once
/// \file
/// Phases from the bed's own periodic motion, for a stack whose trigger nobody wrote down.

#include <optional>
#include <span>

#include "imaging/phase_lock.hpp"

namespace twincell {

/// What may be known beforehand.
struct FoundPhaseOptions {
  int frames_per_cycle = 0;         ///< N_k; 0: found
  std::optional<double> gamma;      ///< A omega^2 / g of the drive, by which phase 0 is placed
  std::optional<double> amplitude;  ///< A in the unit of the heights; helps to place phase 0
};

/// Finds period, phases, and frames that were dropped or taken twice.
///
/// The period is the first deep minimum of the cumulative-mean normalised difference of the signal (de
/// Cheveigne & Kawahara, J. Acoust. Soc. Am. 111, 1917 (2002), eq. 8). The wave form is the mean over the
/// cycles. The phases are the likeliest path through it (Viterbi) in which a frame advances by one phase, or,
/// at a price, by none (doubled) or by two to four (dropped), with wave form and path refined in turn. Phase
/// 0 is placed by the motion of a rigid, completely inelastic bed on a plate of this Gamma, where that is
/// known.
///
/// A bed that repeats itself only after two cycles of the drive (period doubling) gives two cycles as one,
/// unless N_k is given.
/// \param heights mean height of the bed, up positive, frame by frame; any unit. Slow drifts do no harm
/// \throws InputError if no period is found: fewer than three cycles, or no motion that repeats itself
PhaseTable find_phases(std::span<const double> heights, const FoundPhaseOptions& options);

/// Height of a rigid, completely inelastic bed above the plate's mean level, at `n` phases of its cycle, for
/// a plate at A sin(omega t) with A = 1 and Gamma = A omega^2 / g; steady state after some cycles. At rest on
/// the plate for Gamma <= 1.
std::vector<double> inelastic_bed(double gamma, int n);

}  // namespace twincell
