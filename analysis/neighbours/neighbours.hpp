#pragma once
/// \file
/// The neighbour search used by all observables.

#include <cstddef>
#include <vector>

#include "trajectory/trajectory.hpp"

namespace twincell::analysis {

/// Neighbours of every bead of one frame. The neighbours of bead i are the entries first[i] .. first[i + 1] -
/// 1.
struct Neighbours {
  double cutoff = 0;               ///< sigma
  std::vector<std::size_t> first;  ///< [n_beads + 1]
  std::vector<std::size_t> index;  ///< slot of the neighbour; ascending for each bead
  std::vector<Vec3> bond;          ///< from the bead to that neighbour (nearest image), sigma

  [[nodiscard]] std::size_t count(std::size_t bead) const { return first[bead + 1] - first[bead]; }
  /// Calls visit(slot of neighbour, bond) for each neighbour of `bead`.
  template <class Visit>
  void for_each(std::size_t bead, Visit&& visit) const {
    for (std::size_t e = first[bead]; e < first[bead + 1]; ++e) visit(index[e], bond[e]);
  }
};

/// Finds all pairs of beads present in `frame` whose centres are at most `cutoff` apart (<=, so that a tie
/// does not depend on the order of beads). Periodic boundaries use the nearest image. Empty slots have no
/// neighbours. The cells are sorted instead of being stored as a grid, so that a bead at z = 1e4 costs
/// nothing extra. Cost O(N log N). If a period is shorter than 2 cutoff, only the nearest image of each pair
/// is found.
/// \pre cutoff > 0
Neighbours find_neighbours(const Frame& frame, const Box& box, double cutoff);

}  // namespace twincell::analysis
