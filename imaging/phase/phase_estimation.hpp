#pragma once
/// \file
/// Phases from the bed's own periodic motion, for a stack whose trigger nobody wrote down.

#include <optional>
#include <span>
#include <vector>

#include "imaging/phase/phase_lock.hpp"

namespace twincell {

/// What may be known beforehand.
struct PhaseEstimationOptions {
  int frames_per_cycle = 0;         ///< N_k; 0: found
  std::optional<double> gamma;      ///< A omega^2 / g of the drive, by which phase 0 is placed
  std::optional<double> amplitude;  ///< A in the unit of the heights; helps to place phase 0
};

/// What is seen of the bed, frame by frame.
struct BedMotion {
  std::vector<double> heights;  ///< mean height, up positive; any unit. Slow drifts do no harm
  /// Logarithm of the odds, from the beads, that the frame shows the same moment as the one before rather
  /// than another; 0: nothing is known. Empty: nothing of any frame
  std::vector<double> repeats;
};

/// Of the beads of two successive frames: each that moved by less than `kStill` of the standard deviation of
/// its step speaks for the same moment, a tenth of them that did not outweighs the rest. Of one bead it tells
/// little, of a hundred all. \param steps  length of each bead's step over its standard deviation; those not
/// finite tell nothing
double log_odds_of_repeat(std::span<const double> steps);

/// Finds period, phases, and frames that were dropped or taken twice.
///
/// The period is the first deep minimum of the cumulative-mean normalised difference of the signal (de
/// Cheveigne & Kawahara, J. Acoust. Soc. Am. 111, 1917 (2002), eq. 8), of its mean over the frames or of its
/// median, which a gap in every second cycle does not spoil: that which explains the frames better, each
/// phase that it needs costing half the logarithm of their number (Schwarz, Ann. Statist. 6, 461 (1978)). The
/// wave form is the median over the cycles. The phases are the likeliest path through it (Viterbi) in which a
/// frame advances by one phase or, at a price, by none (doubled) or by up to twenty and one (dropped), with
/// wave form and path refined in turn. A frame that repeats what was seen may stay; one in which the beads
/// moved may not. Where the bed turns it hardly moves in any cycle: there repeating tells nothing. Phase 0 is
/// placed by the motion of a rigid, completely inelastic bed on a plate of this Gamma, where that is known.
///
/// A bed that repeats itself only after two cycles of the drive (period doubling) gives two cycles as one,
/// unless N_k is given.
/// \throws InputError if no period is found: fewer than three cycles, or no motion that repeats itself
PhaseTable estimate_phases(const BedMotion& motion, const PhaseEstimationOptions& options);

/// Height of a rigid, completely inelastic bed above the plate's mean level, at `n` phases of its cycle, for
/// a plate at A sin(omega t) with A = 1 and Gamma = A omega^2 / g; steady state after some cycles. At rest on
/// the plate for Gamma <= 1.
std::vector<double> inelastic_bed(double gamma, int n);

}  // namespace twincell
