#pragma once
/// \file
/// Beads of snapshots, coloured by local structure.

#include <string>
#include <vector>

#include "analysis/report/figure.hpp"
#include "analysis/runs/phase_diagram.hpp"

namespace twincell::analysis {

/// The beads of one snapshot, as a panel of a figure.
struct BeadPanel {
  std::string title;
  const Snapshot* moment;
  Box box;
  std::vector<double> radius;  ///< per slot, sigma; empty: 1/2
};
/// Snapshots in rows of `columns` panels, with the beads to scale and coloured by local structure (Fortini &
/// Huang 2015, Fig. 1).
/// \pre panels is not empty
Figure beads_figure(const std::vector<BeadPanel>& panels, const std::string& name, const std::string& title,
                    std::size_t columns);
/// First and last frame of one run of each side (one side may be absent), with the beads to scale and
/// coloured by local structure (Fortini & Huang 2015, Fig. 1).
Figure snapshots_figure(const std::vector<Run>& runs, const Match& match, const std::string& name);

}  // namespace twincell::analysis
