#pragma once
/// \file
/// Ranges of the numbers of a trajectory, of a file or in memory. Values outside would later cause overflows,
/// indices out of range, or searches that do not end.

#include <cstddef>
#include <string>

#include "trajectory/trajectory.hpp"

namespace twincell {

/// Largest distance of beads and cell bounds from 0 along each axis, sigma.
inline constexpr double kFarthestPosition = 1e7;

/// Checks cell, beads, drive and scale. \param name of the trajectory, for the message
/// \throws InputError naming the number and its range
void require_ranges(const TrajectoryInfo& info, const std::string& name);

/// Checks positions, phase and cycle of a frame. \throws InputError likewise
void require_ranges(const Frame& frame, std::size_t index, const TrajectoryInfo& info,
                    const std::string& name);

}  // namespace twincell
