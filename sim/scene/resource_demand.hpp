#pragma once
/// \file
/// What a run asks of the machine, known before a bead is placed.

#include <cstddef>
#include <filesystem>

#include "core/machine_memory.hpp"
#include "sim/scene/plan.hpp"

namespace twincell::sim {

struct ResourceDemand {
  double memory = 0;  ///< bytes at the peak, which is while the list of near pairs is built anew
  double disk = 0;  ///< bytes of the frames, at the least: beads at rest take less, flying ones a fifth more
  double frames = 0;  ///< that are recorded
};

/// Of a run with so many beads.
///
/// memory = n (350 + 2 p b): what start and kernel hold of a bead, and lists, old and new, with p pairs of b
/// bytes each; p = 3 in 2D, 6 in 3D; b = 50, 65, and 35 more where beads differ. Dense beds take between half
/// of it and all of it (tests/hard/demand_test.cpp). disk = 0.85 * 8 bytes for each coordinate, velocity and
/// spin.
ResourceDemand resource_demand(const Scene& scene, const Plan& plan, std::size_t beads);

/// \param available bytes \throws ConfigError naming the key that asks for so many beads, the bytes, and what
/// the machine has
void require_memory(const Scene& scene, const Plan& plan, std::size_t beads,
                    double available = memory_available());

/// Whether the frames fit on the disk of an output. \throws ConfigError likewise, naming time.cycles
void require_disk(const Scene& scene, const Plan& plan, std::size_t beads,
                  const std::filesystem::path& output);

/// "1.2 GB".
std::string bytes_text(double bytes);

}  // namespace twincell::sim
