#pragma once
/// \file
/// Writes a trajectory in the format of another program.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/progress.hpp"
#include "trajectory/foreign/format.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell {

/// Units in which a trajectory is exported.
struct ExportUnits {
  double length = 1, time = 1;  ///< of sigma and of t0
  std::string length_unit = "sigma", time_unit = "t0";

  /// sigma and t0, or the number of the frame where that is the time.
  static ExportUnits reduced(const TrajectoryInfo& info);
  /// mm and s, or the number of the frame where that is the time.
  /// \throws ConfigError at `option` if the trajectory does not state its scale
  static ExportUnits laboratory(const TrajectoryInfo& info, const std::string& option);
};

/// Numbers of each bead that are not in the trajectory.
struct BeadNumbers {
  std::vector<std::string> names;
  /// [name][slot] of a frame.
  std::function<std::vector<std::vector<double>>(const Frame&)> of;
};

/// The frame in the axes of ForeignFrame: beads that are present, id = slot, type 1 or, for tracers, 2.
/// The box is that of the cell, lower by the amplitude of the drive along its axis, and wider where the
/// centre of a bead lies beyond it.
/// \param numbers BeadNumbers::of the frame
/// \param left_out slots that are left out, with their contacts; empty: none
ForeignFrame foreign_frame_of(const Frame& frame, const TrajectoryInfo& info, const ExportUnits& units,
                              const std::vector<std::vector<double>>& numbers = {},
                              const std::vector<bool>& left_out = {});

/// The slots that hold no bead in at least one frame.
std::vector<bool> incomplete_slots(const TrajectorySource& source, Progress& progress = Progress::none());

/// Writes all frames to `part`, a file or a folder, with `numbers` if the format carries them.
/// \param left_out as foreign_frame_of
/// \returns the number of frames
/// \throws RunError if it cannot be written
std::size_t export_trajectory(const TrajectorySource& source, const ForeignFormat& format,
                              const ExportUnits& units, const std::filesystem::path& part,
                              const std::string& stem, Progress& progress = Progress::none(),
                              const BeadNumbers& numbers = {}, const std::vector<bool>& left_out = {});

}  // namespace twincell
