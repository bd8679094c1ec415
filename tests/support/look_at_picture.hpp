#pragma once
/// \file
/// Locates the beads of one picture with the settings that are found without options.

#include <cstddef>

#include "imaging/settings/configure_locator.hpp"
#include "tests/support/one_picture.hpp"

namespace twincell::imaging {

struct Seen {
  LocatorOptions settings;
  std::size_t beads = 0, tracers = 0;
};

inline Seen look(const cv::Mat& frame) {
  OnePicture stack(frame);
  FramesAhead ahead(stack);
  LocatorOptions open;
  open.polarity_known = false;
  Seen seen{configure_locator(ahead, open).locator};
  const std::vector<Detection> beads = locate(frame, seen.settings).beads;
  seen.beads = beads.size();
  for (const Detection& b : beads) seen.tracers += b.tracer ? 1 : 0;
  return seen;
}

}  // namespace twincell::imaging
