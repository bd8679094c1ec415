#pragma once
/// \file
/// Phases of the frames from the height of the plate in each of them.

#include <optional>
#include <span>
#include <string>

#include "imaging/phase/phase_lock.hpp"
#include "imaging/phase/sine_slips.hpp"

namespace twincell::imaging {

/// What the plate in the frames says about N frames per cycle.
struct PlateReading {
  std::optional<SineSlips>
      slips;  ///< its sine, with missing and doubled frames; absent: the plate cannot tell
  std::optional<FreeSine> other;  ///< a sine of another period that explains the heights better
  std::string changes;            ///< how the motion changes during the film, if it does
  std::string why_not;            ///< why the plate cannot tell

  [[nodiscard]] bool fits() const { return slips && !other; }
};

/// Reads the plate. It can tell if it is seen in 60 % of the frames, moves by at least 1 px, and follows a
/// sine to 15 % of its amplitude. Another period is better if it costs less than the missing and doubled
/// frames that N needs, and if it differs from N by more than half a frame over the stack. \param plate_px
/// [frames] height of the plate, px, NaN where not seen
PlateReading read_plate(std::span<const double> plate_px, int frames_per_cycle);

/// Phases, missing and doubled frames from the plate alone: of the whole numbers of frames per cycle from
/// 0.85 to 1.3 times the apparent period, which missing frames shorten, the one that costs least. \param
/// frames_per_cycle N if known; 0: searched for \param offset frame intervals by which every frame was taken
/// later than its phase \returns nothing if the plate cannot tell or its period is no whole number of frames
std::optional<PhaseTable> phases_from_plate(std::span<const double> plate_px, int frames_per_cycle,
                                            double offset = 0);

}  // namespace twincell::imaging
