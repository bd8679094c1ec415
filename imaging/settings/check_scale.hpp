#pragma once
/// \file
/// Whether the beads in the frames are one sigma wide, and as a cell that states their scale describes them.

#include <optional>
#include <string>

#include "imaging/locate/locator.hpp"
#include "imaging/stack/frames_ahead.hpp"

namespace twincell::imaging {

/// "12" or "12 to 14", the diameters of the beads in px, if they differ from the scale by more than 10 %: one
/// sigma is less than 0.9 of the smallest or more than 1.1 of the largest. Otherwise empty.
std::string sizes_that_differ(const LocatorOptions& beads, double pixels_per_sigma);

/// What a cell that states the width of its discs says of them.
struct StatedDiscs {
  std::string file;            ///< for messages
  std::string key;             ///< that states the width
  bool polarity_open = false;  ///< the beads are dark by default
  bool refiner_open = false;   ///< no method is stated
};

/// Checks a diameter that is the scale of the cell, px per sigma. The first frame is located with it. If the
/// beads there have another size (5 %), or a fifth as many candidates are dropped, diameter, polarity and
/// refiner are searched in the frames.
/// \param given options before the settings were found
/// \param threads which do not change the result
/// \return the refiner whose discs cover at least a fifth more of the frame, if the refiner is open; absent:
/// that of `given`
/// \throws ConfigError naming camera.pixels_per_sigma and the size that is seen, if sizes_that_differ, and
/// discs of that size cover no less of the frame; naming camera.bright if the polarity is open, and bright
/// discs of the stated size cover a fifth more
std::optional<std::string> check_beads_at_scale(FramesAhead& frames, const LocatorOptions& given,
                                                const StatedDiscs& stated, int threads);

}  // namespace twincell::imaging
