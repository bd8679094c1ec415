#pragma once
/// \file
/// Who is near whom: the one neighbour search that observables use.

#include <cstddef>
#include <vector>

#include "trajectory/trajectory.hpp"

namespace twincell {

/// Neighbours of every bead of one frame. Bead i's are entries first[i] .. first[i + 1] - 1.
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

/// All pairs of beads present in `frame` whose centres are no farther apart than `cutoff` (<=, so that a tie
/// does not depend on the order of beads), across periodic walls by the nearest image. Empty slots have no
/// neighbours. Cells are sorted, not stored as a grid: a bead that flew to z = 1e4 costs nothing. Cost O(N
/// log N). A period shorter than 2 cutoff sees only the nearest image of each pair. \pre cutoff > 0
Neighbours find_neighbours(const Frame& frame, const Box& box, double cutoff);

}  // namespace twincell
