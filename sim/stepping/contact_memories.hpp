#pragma once
/// \file
/// Remembered numbers of contacts by their beads, for solvers of small systems.

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "trajectory/trajectory.hpp"

namespace twincell::sim {

/// The numbers of each contact by (i, j), with j as in ContactMemory.
using ContactMemories = std::map<std::pair<std::int32_t, std::int32_t>, std::vector<double>>;

/// The contacts, sorted by (i, j).
inline std::vector<ContactMemory> sorted_list(const ContactMemories& memories) {
  std::vector<ContactMemory> all;
  all.reserve(memories.size());
  for (const auto& [key, numbers] : memories) all.push_back({key.first, key.second, numbers});
  return all;
}

/// Adds the contacts of a list; those of the same beads are replaced.
inline void add_list(ContactMemories& memories, std::vector<ContactMemory> contacts) {
  for (ContactMemory& c : contacts) memories[{c.i, c.j}] = std::move(c.values);
}

}  // namespace twincell::sim
