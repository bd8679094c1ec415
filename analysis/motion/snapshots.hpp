#pragma once
/// \file
/// Moments of a run that are kept to be looked at.

#include <cstddef>
#include <vector>

#include "analysis/neighbours/bond_order.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell {

/// One moment of a run, for a picture.
struct Snapshot {
  Frame frame;
  BondOrder order;
  /// [n_beads] Voronoi neighbours of an enclosed bead, 5 and 7 for disclinations; 0 for a bead at a surface
  /// (defects.hpp). Empty where the cell is too narrow for it.
  std::vector<std::size_t> coordination;
  double plate = 0;  ///< height of the plate, sigma; the box's floor if it is not known
};

/// Frame `index` with its bond order. \param cutoff of the neighbours, sigma
Snapshot snapshot(const TrajectorySource& trajectory, std::size_t index, double cutoff);

/// At most `most` frames from which both the slow and the fast motion can be read, in order: half of them at
/// phase 0, evenly spread over the cycles from the first to the last; the others from the last whole cycle,
/// evenly spread over its phases. Without phases: evenly spread over all. \pre most >= 2
std::vector<std::size_t> representative_frames(const TrajectorySource& trajectory, std::size_t most);

}  // namespace twincell
