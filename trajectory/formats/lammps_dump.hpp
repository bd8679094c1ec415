#pragma once
/// \file
/// Text dumps of LAMMPS (`dump custom`, `dump atom`) as trajectories.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>

#include "core/progress.hpp"
#include "trajectory/drive.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell {

/// What a dump does not say of itself. Lengths and times are in the dump's own units.
struct LammpsDumpOptions {
  int dimension = 2;               ///< 2: the dump's plane (x, y), y up; 3: z up
  std::optional<double> timestep;  ///< length of a step; needed unless the dump has ITEM: TIME
  double sigma = 1;                ///< bead diameter, the unit of length of the trajectory
  double gravity = 1;              ///< g; t0 = sqrt(sigma/g) is its unit of time
  Vec3 origin = Vec3::Zero();      ///< lower left inside corner of the cell, plate at its mean height
  std::optional<double> width;     ///< between the side walls; absent: up to the end of the dump's box
  DriveSpec drive;                 ///< of the plate; nothing given: unknown
  Axis drive_axis = Axis::z;       ///< in our axes
  int phases_per_cycle = 0;       ///< N_k; 0: not phase-locked. Each frame must then be at a k/N_k of a cycle
  double phase_of_step_zero = 0;  ///< fraction of a cycle. A wall that `wiggle`s starts at the bottom: 0.75
  std::optional<double> bead_mass;  ///< unit of the column mass, which is not read without it
  std::optional<long> tracer_type;  ///< atom type that marks tracers
};

/// A dump, read twice: once to learn what it holds, once to hand it over. Memory does not grow with the
/// number of frames.
///
/// Columns may stand in any order, ids too; a bead that a frame lacks is missing there. Needed are `id` and
/// per axis one of xu, xsu, x, xs (s: scaled by the box, u: unwrapped); used are vx …, omegax …, radius or
/// diameter, mass, type, ix …. Wrapped coordinates without ix … are followed across a period by the shortest
/// way from frame to frame. Source: LAMMPS manual, `dump` command.
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
  /// Hands over all frames in order.
  void copy_to(TrajectorySink& sink, Progress& progress = Progress::none()) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace twincell
