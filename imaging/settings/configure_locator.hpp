#pragma once
/// \file
/// The options by which the beads of a stack are located: those given, and what its first frames add.

#include <cstdint>

#include "imaging/locate/locator.hpp"
#include "imaging/stack/frames_ahead.hpp"

namespace twincell {

/// Complete options, and the frame from which what was left open was found.
struct LocatorConfiguration {
  LocatorOptions locator;
  std::int64_t frame = 0;
};

/// Finds what `given` leaves open (diameter, polarity, and with the default refinement the model) from the
/// first of frames 0, 1, 2, 4, ... 32 that shows beads (auto_configuration.hpp). With both given, only the
/// contrast is found, from the first frame. \throws InputError if the stack shows no discs from which a
/// diameter could be estimated
LocatorConfiguration configure_locator(FramesAhead& frames, const LocatorOptions& given);

}  // namespace twincell
