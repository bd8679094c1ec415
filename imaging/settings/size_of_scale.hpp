#pragma once
/// \file
/// Whether the beads in the frames are one sigma wide.

#include "imaging/locate/locator.hpp"
#include "imaging/stack/frames_ahead.hpp"

namespace twincell::imaging {

/// Checks a diameter that is the scale of the cell, px per sigma. The first frame is located with it; if the
/// beads there have another size (5 %), or more than a sixth of the candidates are dropped, the diameter is
/// searched without it. \param given options before the settings were found \param settled complete options
/// \param threads which do not
///     change the result
/// \throws ConfigError naming camera.pixels_per_sigma and the size that is seen, if the scale differs from it
/// by more than
///     10 % and discs of that size cover no less of the frame
void require_size_of_scale(FramesAhead& frames, const LocatorOptions& given, const LocatorOptions& settled,
                           int threads);

}  // namespace twincell::imaging
