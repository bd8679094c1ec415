#pragma once
/// \file
/// Phase estimation from the bed's own periodic motion, for a stack without a record of the triggers.

#include <optional>
#include <span>
#include <vector>

#include "imaging/phase/phase_lock.hpp"

namespace twincell::imaging {

/// Optional prior knowledge about the drive.
struct PhaseEstimationOptions {
  int frames_per_cycle = 0;     ///< N_k; 0: estimated
  std::optional<double> gamma;  ///< A omega^2 / g of the drive; determines the position of phase 0
};

/// Observed motion of the bed, frame by frame.
struct BedMotion {
  std::vector<double> heights;  ///< mean height, positive upwards; any unit. Slow drifts are tolerated
  /// Log-odds, from the bead positions, that the frame shows the same instant as the previous frame; 0: no
  /// evidence. Empty: no evidence for any frame
  std::vector<double> repeats;
};

/// Log-odds that two successive frames show the same instant, from the steps of their beads. Each bead that
/// moved by less than four standard deviations of its step is evidence for the same instant. If a tenth of
/// the beads moved farther, they outweigh the rest. One bead gives weak evidence, a hundred beads give
/// certainty.
/// \param steps length of each bead's step divided by its standard deviation; non-finite values are ignored
double log_odds_of_repeat(std::span<const double> steps);

/// Estimates the period, the phases, and the frames that were dropped or taken twice.
///
/// The period is the first deep minimum of the cumulative-mean normalised difference of the signal (de
/// Cheveigne & Kawahara, J. Acoust. Soc. Am. 111, 1917 (2002), eq. 8). The squared difference at each lag is
/// averaged over the frames in two ways: by the mean, and by the median, which tolerates a gap in every
/// second cycle. If the two periods differ, the one that explains the frames better is used; each phase that
/// it needs costs half the logarithm of the number of frames (Schwarz, Ann. Statist. 6, 461 (1978)). The wave
/// form is the median over the cycles. The phases are the most likely path through it (Viterbi): a frame
/// advances by one phase or, at a cost, by zero phases (doubled) or by up to 21 phases (dropped). Wave form
/// and path are refined in turn. A frame that repeats the previous one may keep its phase; a frame in which
/// the beads moved may not. Where the bed reverses, it hardly moves in any cycle, so a repetition there is no
/// evidence. If Gamma is known, phase 0 is placed by the motion of a rigid, completely inelastic bed on a
/// plate of this Gamma.
///
/// If a bed repeats itself only after two cycles of the drive (period doubling), two cycles are reported as
/// one, unless N_k is given.
/// \throws InputError if no period is found: fewer than three cycles, or no motion that repeats itself
PhaseTable estimate_phases(const BedMotion& motion, const PhaseEstimationOptions& options);

/// Height of a rigid, completely inelastic bed above the plate's mean level, at `n` phases of its cycle, for
/// a plate at A sin(omega t) with A = 1 and Gamma = A omega^2 / g. The result is the steady state after some
/// cycles. For Gamma <= 1 the bed rests on the plate.
std::vector<double> inelastic_bed(double gamma, int n);

}  // namespace twincell::imaging
