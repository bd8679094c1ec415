#pragma once
/// \file
/// What calibration is worth and costs: errors of every number against frames used and time, on frames whose
/// truth is known.

#include <string>
#include <vector>

#include "core/progress.hpp"

namespace twincell {

/// One number from so many frames.
struct CalibrationPrecision {
  std::string name;  ///< "drive.amplitude"
  std::string unit;
  int frames = 0;
  double stated = 0;  ///< standard error as stated
  double actual = 0;  ///< value minus truth
};

/// What it took.
struct CalibrationTime {
  int frames = 0;
  double edges_s = 0;  ///< processor time of reading edges from the pictures (without reading files)
  double fit_s = 0;    ///< of all fits to them
  double beads_s = 0;  ///< of locating the beads of up to twelve frames
};

struct CalibrationCost {
  int width_px = 0, height_px = 0;  ///< of a frame
  std::vector<CalibrationPrecision> numbers;
  std::vector<CalibrationTime> times;
};

/// A crystal of 12 x 6 beads that rides on a plate (Gamma = 0.9, 20 frames a cycle, 14.3 px a bead), filmed
/// with the synthetic camera's defaults and then calibrated from the first n frames, for each n. A bead that
/// bounces is filmed with the same number of frames. \param frames each at least 20, rising
CalibrationCost measure_calibration(const std::vector<int>& frames, Progress& progress = Progress::none());

}  // namespace twincell
