#pragma once
/// \file
/// Numbers of each bead by which a drawing colours the beads. To add one, write its function and a line in
/// the table of colouring.cpp.

#include <cstddef>
#include <string>
#include <vector>

#include "trajectory/trajectory.hpp"

namespace twincell::analysis {

/// A frame and its place in the trajectory.
struct ColouredFrame {
  const TrajectorySource& source;
  std::size_t index;
  const Frame& frame;
};

/// One number per bead.
struct Colouring {
  const char* word;  ///< on the command line and beside the colour bar
  const char* unit;  ///< ASCII; empty for a pure number
  const char* help;
  /// What the trajectory must have, as the object of "needs"; empty if `info` suffices.
  std::string (*missing)(const TrajectoryInfo& info);
  /// [n_beads]; NaN for a bead that is absent or whose number is unknown.
  std::vector<double> (*of)(const ColouredFrame& at);
};

/// All colourings.
const std::vector<Colouring>& colourings();
/// The colouring with this word, for this trajectory.
/// \param option for messages
/// \throws ConfigError if no colouring has the word, or if the trajectory lacks the data
const Colouring& colouring_named(const std::string& word, const TrajectorySource& source,
                                 const std::string& option);

}  // namespace twincell::analysis
