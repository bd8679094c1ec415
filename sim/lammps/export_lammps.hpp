#pragma once
/// \file
/// A scene as an input deck for LAMMPS (package GRANULAR): the same beads, contact laws, walls and drive, so
/// that another program can be asked the same question. What is the same and what is not: docs/lammps.md.

#include <cstddef>
#include <string>

#include "core/progress.hpp"
#include "sim/scene/scene.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sim {

/// The two files of a deck. Run in their folder, `lmp -in in.twincell` writes dump.lammpstrj.
struct LammpsDeck {
  static constexpr const char* kInputName = "in.twincell";
  static constexpr const char* kDataName = "data.twincell";
  std::string input;
  std::string data;            ///< beads with positions, velocities and spins
  std::string import_command;  ///< what makes a trajectory of the dump: `twincell import …`
};

/// The deck that begins where Simulation::run begins: the settled bed at phase 0 of the drive.
/// \throws ConfigError naming the key for which LAMMPS has no word; what Simulation throws
LammpsDeck lammps_deck(const Scene& scene, Progress& progress = Progress::none());

/// The deck that begins at frame `index` of a trajectory: its positions, velocities and spins, its plate.
/// A trajectory does not hold the tangential springs of contacts; they begin unstretched.
/// \throws ConfigError also if the frame is missing, lacks velocities, spins or phase, or is not of this
/// scene
LammpsDeck lammps_deck(const Scene& scene, const TrajectorySource& trajectory, std::size_t index);

}  // namespace twincell::sim
