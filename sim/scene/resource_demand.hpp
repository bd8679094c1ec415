#pragma once
/// \file
/// Memory and disk that a run needs, estimated before any bead is placed.

#include <cstddef>
#include <filesystem>

#include "core/machine_memory.hpp"
#include "sim/scene/plan.hpp"

namespace twincell::sim {

/// Estimated demand of a run.
struct ResourceDemand {
  double memory = 0;  ///< bytes at the peak, which is during a build of the pair list
  double disk = 0;    ///< bytes of the frames; beads at rest need less, airborne beads a fifth more
  double frames = 0;  ///< number of recorded frames
};

/// Demand of a run with this number of beads.
///
/// memory = 3000 n in 2D, 4600 n in 3D, and 1500 n more if beads are unequal: the measured peak of a dense
/// bed, raised by a fifth (tests/hard/sim/demand_test.cpp). Most of it is in use only while a pair list is
/// built. disk = 0.85 * 8 bytes for each coordinate, velocity and
/// spin.
ResourceDemand resource_demand(const Scene& scene, const Plan& plan, std::size_t beads);

/// Checks that a run fits into memory.
/// \param available bytes
/// \throws ConfigError naming the key that sets the number of beads, the bytes needed, and the bytes
/// available
void require_memory(const Scene& scene, const Plan& plan, std::size_t beads,
                    double available = memory_available());

/// Checks that the frames fit on the disk of the output.
/// \throws ConfigError naming time.cycles
void require_disk(const Scene& scene, const Plan& plan, std::size_t beads,
                  const std::filesystem::path& output);

/// Bytes with a decimal unit: "1.2 GB".
std::string bytes_text(double bytes);

}  // namespace twincell::sim
