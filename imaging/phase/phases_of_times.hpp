#pragma once
/// \file
/// Phases of frames whose times are known in cycles of the drive.

#include <optional>
#include <span>

#include "imaging/phase/phase_lock.hpp"

namespace twincell::imaging {

/// Sets the phases of frames that were taken at the given times.
///
/// If their period is a whole number of frames, each frame has the nearest of N_k phases; the delay that the
/// frames have in common (their mean position between two phases, on the circle) is PhaseTable::offset and
/// no jitter.
///
/// If the frames drift by more than half a frame interval against N_k phases, the period P is the one whose
/// whole frames are nearest to the times. N_k is then the largest whole number that is not above P + 0.1, at
/// most the stated one; a frame has the nearest phase, and of two frames nearest to the same phase only the
/// nearer one has it (PhaseTable::between counts the others); FramePhase::cycles is the given time.
///
/// Frame intervals in which more than one frame fits are missing frames; frames at the same instant are
/// doubled.
/// \param cycles [frames] cycles of the drive, not decreasing; NaN: the frame is out of lock
/// \param frames_per_cycle N_k as stated; 0: one over the median step, rounded
/// \param period P, if it is known not to be a whole number of frames
/// \returns false if N_k is 0 and the median step is 0 or below 1e-5 cycles
/// \pre at least one time is finite
bool set_phases_of_times(PhaseTable& table, std::span<const double> cycles, int frames_per_cycle,
                         std::optional<double> period = {});

}  // namespace twincell::imaging
