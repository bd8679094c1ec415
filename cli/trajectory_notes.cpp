#include "cli/trajectory_notes.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "trajectory/trajectory_doubts.hpp"

namespace twincell::cli {

void note_trajectory(const Common& common, const TrajectorySource& trajectory) {
  // Two cycles and more; of large beds fewer, so that they remain a small part of an analysis.
  constexpr std::size_t kFrames = 50, kBeadFrames = 200'000, kFewest = 2;
  const std::size_t beads = std::max<std::size_t>(1, trajectory.info().n_beads);
  for (const std::string& doubt : doubts_of(trajectory, std::clamp(kBeadFrames / beads, kFewest, kFrames)))
    note(common, fmt::format("{}: {}.", trajectory.name(), doubt));
}

}  // namespace twincell::cli
