#pragma once
/// \file
/// Ranges of the numbers of a trajectory, of a file or in memory. Values outside would later cause overflows,
/// indices out of range, or searches that do not end.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "trajectory/trajectory.hpp"

namespace twincell {

/// Largest distance of beads and cell bounds from 0 along each axis, sigma.
inline constexpr double kFarthestPosition = 1e7;

/// Checks cell, beads, drive and scale.
/// \param name of the trajectory, for the message
/// \throws InputError naming the number and its range
void require_ranges(const TrajectoryInfo& info, const std::string& name);

/// Checks positions, identities, uncertainties, temperatures, phase and cycle of a frame.
/// \throws InputError likewise
void require_ranges(const Frame& frame, std::size_t index, const TrajectoryInfo& info,
                    const std::string& name);

/// Checks that a slot has a finite position exactly if it is filled. Files of other programs need not keep
/// this.
/// \throws InputError naming the frame and the slot
void require_filled_slots(const Frame& frame, std::size_t index, const std::string& name);

/// Checks that no speed or spin is beyond 1e8 in reduced units. Files of other programs may have other units.
/// \throws InputError naming the frame and the bead
void require_speeds(const Frame& frame, std::size_t index, const std::string& name);

/// Checks that three beads or more are not all at one place, as in a file whose positions were lost.
/// \throws InputError naming the frame
void require_places(const Frame& frame, std::size_t index, const std::string& name);

/// Checks that each frame that has a phase comes after the one before it that has.
/// \param phases, cycles [frames]
/// \throws InputError naming both frames
void require_order(std::span<const std::int32_t> phases, std::span<const std::int64_t> cycles,
                   const std::string& name);

}  // namespace twincell
