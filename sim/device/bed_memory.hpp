#pragma once
/// \file
/// Layout of a bed in one piece of memory of the device.

#include <cstddef>

#include "sim/device/bed.hpp"

namespace twincell::sim {

/// Largest number of steps of a launch; longer calls are several launches.
inline constexpr std::int64_t kStepsPerLaunch = 1024;

struct BedSizes {
  int dimension = 2;
  std::size_t beads = 0, walls = 0, kinds = 0;
  std::size_t slots = 0;                  ///< of a bead
  std::size_t constants = 0, memory = 0;  ///< numbers per kind of contact, and remembered by a contact
};

/// Ends of the parts of the memory, bytes.
struct BedParts {
  std::size_t state;      ///< records, spins, forces, report: comes back with every launch
  std::size_t contacts;   ///< lists and memory: read for checkpoints
  std::size_t constants;  ///< up to here the bed stays on the machine
  std::size_t all;        ///< with the inputs, which go to the machine with every launch
};

/// Sets the pointers of a bed whose memory begins at `base`, which is not accessed; null: only the ends of
/// the parts. `states` is left as it is.
BedParts place_bed(DeviceBed& bed, const BedSizes& sizes, std::byte* base);

}  // namespace twincell::sim
