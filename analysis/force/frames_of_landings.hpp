#pragma once
/// \file
/// Whether frames at fixed phases of the drive say the mean force of a bed that lands.

#include <fmt/format.h>

#include <string>

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// Whether means of forces over the frames may miss or repeat the landings of the bed, in every cycle alike:
/// a driven bed with fewer frames per cycle than `simulate` takes samples for its means over time.
inline bool frames_may_alias(const TrajectoryInfo& info) {
  constexpr int kSamplesOfALanding = 200;
  return info.drive && info.drive->velocity_bound() > 0 && info.phases_per_cycle > 0 &&
         info.phases_per_cycle < kSamplesOfALanding;
}

/// Words for the convention of a mean over frames; empty if they do not alias.
inline std::string aliasing_note(const TrajectoryInfo& info) {
  if (!frames_may_alias(info)) return {};
  return fmt::format(
      "; {} phases per cycle miss the landings of the bed or repeat them, by an unknown amount",
      info.phases_per_cycle);
}

/// `r`, a mean over frames, with the note and, if the frames may alias, without interval: the scatter of
/// frames at the same phases does not show the error.
inline Result over_frames(Result r, const TrajectoryInfo& info) {
  if (!r.present() || !frames_may_alias(info)) return r;
  r.convention += aliasing_note(info);
  r.interval.reset();
  r.no_interval = fmt::format(
      "the error of a mean over {} fixed phases per cycle is not known; `simulate --contacts` stores means "
      "over time",
      info.phases_per_cycle);
  return r;
}

}  // namespace twincell::analysis
