#pragma once
/// \file
/// Check of a stated phase lock ("N frames per cycle, none missing") against what the stack shows.
///
/// There are three sources, in this order: the plate in the frames (plate_phases.hpp), the time stamps of the
/// camera, and the motion of the bed (phase_estimation.hpp). The first that gives an answer decides. Missing
/// and doubled frames are corrected in the phases and reported; a lock that does not fit at all is refused.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "imaging/phase/phase_estimation.hpp"
#include "imaging/phase/phase_lock.hpp"

namespace twincell::imaging {

/// Evidence from the frames themselves, gathered while they are located. Empty: not available.
struct LockEvidence {
  std::vector<double> plate_px;  ///< [frames] height of the plate, NaN where not seen (plate_row.hpp)
  std::vector<double> times_s;   ///< [frames] time stamps of the camera
  /// [frames] as RepeatedFrames::repeats, empty if no frame is repeated. The checks here take evidence
  /// without repeated frames (phases_of_repeated_frames.hpp).
  std::vector<std::uint8_t> repeats;
  std::string copied;  ///< as RepeatedFrames::copied
};

/// The phases of a lock, checked against plate and time stamps. PhaseTable::checked_by states the source; if
/// it is empty, neither gave an answer, and PhaseTable::not_checked states why. If frames are missing or
/// doubled, PhaseTable::frames holds the corrected phases and PhaseTable::warning names the frames. The plate
/// gives an answer as in read_plate, time stamps if the intervals are whole multiples of their median to a
/// quarter.
///
/// \pre lock.locked()
/// \throws ConfigError naming the frame and the remedy if the plate moves with another period, or if more
/// than one frame in ten would be missing or doubled
PhaseTable check_lock(const PhaseLock& lock, const LockEvidence& evidence);

/// The same by the motion of the bed, for a table that is not checked yet. The bed can tell if it moves,
/// repeats itself for three cycles, and its cycles agree to a third of a frame interval, or to 0.15 frame
/// intervals once missing frames are put in.
/// \throws ConfigError as check_lock
void check_lock_by_bed(PhaseTable& table, const BedMotion& motion);

/// Checks the phases of a list against the plate. It can tell if it is seen in 60 % of the frames and follows
/// a sine of any period (phases_from_plate). Then the first two harmonics of the listed phases must explain
/// half of the variance of its height, and the fundamental must be within 0.75 frame intervals of a sine that
/// begins at phase 0. No frame may be farther than that from the phases that the plate shows, if the plate
/// follows these clearly better after a cost for each missing or doubled frame that they need.
/// \param plate_px [frames] LockEvidence::plate_px
/// \param sine whether the drive is known to have that phase; a recorded one need not
/// \throws ConfigError naming the frames per cycle of list and plate, or the difference of their phases
void check_list_by_plate(PhaseTable& table, std::span<const double> plate_px, bool sine);

/// The frames before which frames are missing, with their number, and the doubled frames, as text: "1 before
/// frame 30, 2 before frame 61; frame 80 is taken twice". At most eight are named.
std::string slips_in_words(std::span<const FramePhase> frames);

}  // namespace twincell::imaging
