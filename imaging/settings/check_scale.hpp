#pragma once
/// \file
/// Whether the beads in the frames are one sigma wide.

#include <string>

#include "imaging/locate/locator.hpp"
#include "imaging/stack/frames_ahead.hpp"

namespace twincell::imaging {

/// "12" or "12 to 14", the diameters of the beads in px, if they differ from the scale by more than 10 %: one
/// sigma is less than 0.9 of the smallest or more than 1.1 of the largest. Otherwise empty.
std::string sizes_that_differ(const LocatorOptions& beads, double pixels_per_sigma);

/// Checks a diameter that is the scale of the cell, px per sigma. The first frame is located with it. If the
/// beads there have another size (5 %), or a fifth as many candidates are dropped, the diameter is searched
/// without it.
/// \param given options before the settings were found
/// \param settled complete options
/// \param threads which do not change the result
/// \throws ConfigError naming camera.pixels_per_sigma and the size that is seen, if sizes_that_differ, and
/// discs of that size cover no less of the frame
void check_bead_size(FramesAhead& frames, const LocatorOptions& given, const LocatorOptions& settled,
                     int threads);

}  // namespace twincell::imaging
