#pragma once
/// \file
/// Phases of the frames from the height of the plate in each of them.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "imaging/phase/dropped_frames.hpp"
#include "imaging/phase/out_of_lock.hpp"
#include "imaging/phase/phase_lock.hpp"

namespace twincell::imaging {

/// Evidence of the plate in the frames about N frames per cycle.
struct PlateReading {
  /// The sine of the plate, with missing and doubled frames; absent: the plate cannot tell.
  std::optional<SineSlips> slips;
  std::optional<FreeSine> other;          ///< a sine of another period that explains the heights better
  std::vector<FrameStretch> out_of_lock;  ///< where the plate does not follow `slips`
  std::size_t misread = 0;                ///< further frames in which it is off `slips`
  std::size_t far_off = 0;                ///< of these, the frames in which it is three times as far off
  std::string changes;                    ///< how the motion changes during the film, if it does
  std::string why_not;                    ///< why the plate cannot tell

  [[nodiscard]] bool fits() const { return slips && !other; }
};

/// Reads the plate. It can tell if it is seen in 60 % of the frames, moves by at least 1 px, and follows a
/// sine to 15 % of its amplitude. Another period is better if it costs less than the missing and doubled
/// frames that N needs, and if it differs from N by more than half a frame over the stack; or, where N needs
/// none, if it differs from N by seven standard errors and the phases of N would misplace the plate by more
/// than 0.1 px at the ends of the stack. The plate is off its sine in a frame if it misses it by more than
/// five times the scatter, 10 % of the amplitude and 1 px.
/// \param plate_px [frames] height of the plate, px, NaN where not seen
PlateReading read_plate(std::span<const double> plate_px, int frames_per_cycle);

/// Phases, missing and doubled frames from the plate alone: of the whole numbers of frames per cycle from
/// 0.85 to 1.3 times the apparent period, which missing frames shorten, the one that costs least. If a sine
/// whose period is not a whole number of frames explains the heights better, the phases are those of its
/// times (set_phases_of_times). Frames that are out of lock have no phase, and PhaseTable::warning names
/// them.
/// \param frames_per_cycle N if known; 0: searched for
/// \param offset frame intervals by which every frame was taken later than its phase; not used where the
/// period is not a whole number
/// \returns nothing if the plate cannot tell, or if its period differs from N by a frame or more
std::optional<PhaseTable> phases_from_plate(std::span<const double> plate_px, int frames_per_cycle,
                                            double offset = 0);

}  // namespace twincell::imaging
