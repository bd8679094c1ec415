#pragma once
/// \file
/// Reads text dumps of LAMMPS (`dump custom`, `dump atom`) as trajectories.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>

#include "core/progress.hpp"
#include "trajectory/drive.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell {

/// Information that a dump does not contain. Lengths and times are in the dump's own units.
struct LammpsDumpOptions {
  int dimension = 2;               ///< 2: the dump's plane (x, y), y up; 3: z up
  std::optional<double> timestep;  ///< length of a step; required unless the dump has ITEM: TIME
  double sigma = 1;                ///< bead diameter, the trajectory's unit of length
  double gravity = 1;              ///< g; t0 = sqrt(sigma/g) is the trajectory's unit of time
  Vec3 origin = Vec3::Zero();      ///< lower left inside corner of the cell, plate at its mean height
  std::optional<double> width;     ///< between the side walls; absent: up to the end of the dump's box
  DriveSpec drive;                 ///< drive of the plate; empty: unknown
  Axis drive_axis = Axis::z;       ///< in the axes of Box
  int phases_per_cycle = 0;  ///< N_k; 0: not phase-locked. If set, each frame must be at k/N_k of a cycle
  double phase_of_step_zero = 0;    ///< fraction of a cycle; a `wiggle` wall starts at the bottom: 0.75
  std::optional<double> bead_mass;  ///< unit of the column mass; without it the column is ignored
  std::optional<long> tracer_type;  ///< atom type that marks tracers
};

/// A dump, read in two passes: the first collects beads, box and columns, the second copies the frames.
/// Memory use does not grow with the number of frames.
///
/// Columns and ids may be in any order. A bead that is absent from a frame has an empty slot there. Required
/// are `id` and per axis one of xu, xsu, x, xs (s: scaled by the box, u: unwrapped); optional are vx …,
/// omegax …, radius or diameter, mass, type, ix …. Wrapped coordinates without ix … are unwrapped by the
/// shortest displacement from frame to frame. Source: LAMMPS manual, `dump` command.
class LammpsDump {
 public:
  /// \throws InputError naming file and line for anything malformed; ConfigError for options that are missing
  /// or contradict the dump
  LammpsDump(const std::filesystem::path& path, const LammpsDumpOptions& options,
             Progress& progress = Progress::none());
  ~LammpsDump();
  LammpsDump(const LammpsDump&) = delete;
  LammpsDump& operator=(const LammpsDump&) = delete;

  [[nodiscard]] const TrajectoryInfo& info() const;
  [[nodiscard]] std::size_t n_frames() const;
  /// Appends all frames to `sink` in order.
  void copy_to(TrajectorySink& sink, Progress& progress = Progress::none()) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace twincell
