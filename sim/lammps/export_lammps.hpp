#pragma once
/// \file
/// Export of a scene as an input deck for LAMMPS (package GRANULAR), with the same beads, contact laws, walls
/// and drive, so that a second program can solve the same problem. docs/lammps.md lists the differences.

#include <cstddef>
#include <string>

#include "core/progress.hpp"
#include "sim/scene/scene.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sim {

/// The two files of a deck. `lmp -in in.twincell`, run in their folder, writes dump.lammpstrj.
struct LammpsDeck {
  static constexpr const char* kInputName = "in.twincell";
  static constexpr const char* kDataName = "data.twincell";
  std::string input;
  std::string data;            ///< beads with positions, velocities and spins
  std::string import_command;  ///< command that converts the dump to a trajectory: `twincell import …`
};

/// The deck that starts in the same state as Simulation::run: the settled bed at the phase at which the drive
/// starts.
/// \throws ConfigError naming the key that LAMMPS cannot represent; exceptions of Simulation
LammpsDeck lammps_deck(const Scene& scene, Progress& progress = Progress::none());

/// The deck that starts at frame `index` of a trajectory, with its positions, velocities, spins and plate
/// phase. The tangential springs of contacts start unstretched.
/// \throws ConfigError also if the frame is missing, has no velocities, spins or phase, or does not belong to
/// this scene
LammpsDeck lammps_deck(const Scene& scene, const TrajectorySource& trajectory, std::size_t index);

}  // namespace twincell::sim
