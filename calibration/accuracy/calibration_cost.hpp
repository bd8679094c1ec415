#pragma once
/// \file
/// Accuracy and cost of a calibration: error and processor time against the number of frames, measured on
/// synthetic frames whose parameters are known.

#include <string>
#include <vector>

#include "core/progress.hpp"

namespace twincell::calibration {

/// One calibrated number, obtained from `frames` frames.
struct CalibrationPrecision {
  std::string name;  ///< "drive.amplitude"
  std::string unit;
  int frames = 0;
  double stated = 0;  ///< standard error that the calibration reports
  double actual = 0;  ///< actual error: value minus truth
};

/// Processor time of one calibration.
struct CalibrationTime {
  int frames = 0;
  double edges_s = 0;  ///< finding the edges in the pictures, without reading files
  double fit_s = 0;    ///< all fits to the edges
  double beads_s = 0;  ///< locating the beads of up to twelve frames
};

/// Result of the measurement.
struct CalibrationCost {
  int width_px = 0, height_px = 0;  ///< of a frame
  std::vector<CalibrationPrecision> numbers;
  std::vector<CalibrationTime> times;
};

/// Measures the accuracy and cost of a calibration. The synthetic camera, with its default options, films a
/// crystal of 12 x 6 beads that rides on a plate (Gamma = 0.9, 20 frames per cycle, 14.3 px per bead). For
/// each n in `frames` the calibration uses the first n frames. The restitution comes from the synthetic
/// heights of a bouncing bead, with the same number of frames.
/// \param frames frame counts, each at least 20, in rising order
CalibrationCost measure_calibration(const std::vector<int>& frames, Progress& progress = Progress::none());

}  // namespace twincell::calibration
