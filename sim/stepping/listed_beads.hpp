#pragma once
/// \file
/// The beads of the list solver, in an order that keeps neighbours in space near each other in memory, with
/// the constants of their contacts: what all its lists share.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/stepping/contact_packets.hpp"
#include "sim/stepping/packed_beads.hpp"

namespace twincell::sim {

/// Order of the beads in memory.
struct BeadOrder {
  std::vector<std::int32_t> bead;   ///< place -> bead
  std::vector<std::int32_t> place;  ///< bead -> place

  /// Sorts beads by the cubic cells of the given side, sigma, that contain them: by z, then y, then x.
  static BeadOrder by_cells(const std::vector<Bead>& beads, double cell);
};

/// Beads of one thread: places begin .. end - 1.
struct BeadShare {
  std::size_t begin = 0, end = 0;
  std::int32_t dummy = 0;  ///< place of a record after the beads that touches nothing

  /// Whether a place belongs to this thread.
  [[nodiscard]] bool owns(std::int32_t place) const {
    return static_cast<std::size_t>(place) >= begin && static_cast<std::size_t>(place) < end;
  }
  [[nodiscard]] std::size_t size() const { return end - begin; }
  /// The places as kernels take them.
  [[nodiscard]] BeadRange range() const {
    return {static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end)};
  }
};

/// The beads in list order, the kernels that act on them, and the constants of their contacts.
struct ListedBeads {
  ListedBeads(const Plan& plan, const Target& target);
  // `packed` points to `plan`.
  ListedBeads(const ListedBeads&) = delete;
  ListedBeads& operator=(const ListedBeads&) = delete;

  /// Computes the constants of contacts of equal beads, which all contacts of a kind share.
  void set_shared_constants();

  Plan plan;
  Kernels kernels;
  PacketLayout layout;
  PackedBeads packed;
  BeadOrder order;
  std::vector<double>
      of_pairs;  ///< constants of the contacts of two beads, for equal beads, broadcast over the SIMD lanes
  std::vector<std::vector<double>> of_walls;  ///< the same for each wall
};

}  // namespace twincell::sim
