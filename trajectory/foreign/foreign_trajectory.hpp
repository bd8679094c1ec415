#pragma once
/// \file
/// Converts files of other programs to trajectories, and trajectories to frames in their units and axes.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.hpp"
#include "trajectory/drive.hpp"
#include "trajectory/foreign/format.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell {

/// Information that a file does not contain. Lengths and times are in the file's own units; if the file
/// states a unit of time such as ms, its times and velocities are converted to seconds, and times here are in
/// seconds.
struct ForeignOptions {
  int dimension = 2;               ///< 2: the file's plane (x, y), y up; 3: z up
  std::optional<double> timestep;  ///< length of a step; required unless the file has times
  double sigma = 1;                ///< bead diameter, the trajectory's unit of length
  double gravity = 1;              ///< g; t0 = sqrt(sigma/g) is the trajectory's unit of time
  /// Lower left inside corner of the cell, plate at its mean height; absent: 0, or the lower end of a period
  std::optional<Vec3> origin;
  std::optional<double> width;  ///< between the side walls; absent: up to the end of the file's box
  DriveSpec drive;              ///< drive of the plate; empty: unknown
  Axis drive_axis = Axis::z;    ///< in the axes of Box
  int phases_per_cycle = 0;     ///< N_k; 0: not phase-locked. If set, each frame must be at k/N_k of a cycle
  double phase_of_step_zero = 0;    ///< fraction of a cycle; a `wiggle` wall starts at the bottom: 0.75
  std::optional<double> bead_mass;  ///< unit of the column mass; without it the column is ignored
  std::optional<long> tracer_type;  ///< type that marks tracers
  std::map<std::string, std::string> table_columns;  ///< ReadOptions::columns
  bool y_up = false;                                 ///< ReadOptions::y_up
  std::optional<Origin> source;  ///< TrajectoryInfo::source; if absent, that of most files of the format
};

/// A file of another program, read in two passes: the first collects beads, box and columns, the second
/// copies the frames. Memory use does not grow with the number of frames, except for tables.
///
/// A bead that is absent from a frame has an empty slot there. Coordinates without a number of periods are
/// unwrapped by the rule of wrapped_positions.hpp.
class ForeignTrajectory {
 public:
  /// \throws InputError naming file and line for anything malformed; ConfigError for options that are missing
  /// or contradict the file
  ForeignTrajectory(const std::filesystem::path& path, const ForeignFormat& format,
                    const ForeignOptions& options, Progress& progress = Progress::none());
  ~ForeignTrajectory();
  ForeignTrajectory(const ForeignTrajectory&) = delete;
  ForeignTrajectory& operator=(const ForeignTrajectory&) = delete;

  /// What the file and the options state of the run.
  [[nodiscard]] const TrajectoryInfo& info() const;
  /// Number of frames.
  [[nodiscard]] std::size_t n_frames() const;
  /// Frames that the numbers of the steps leave out, if the smallest distance of two is that of all.
  [[nodiscard]] double missing_frames() const;
  /// Whether several beads have the same y, or the same z (upwards for 3D), in all frames.
  [[nodiscard]] bool is_flat() const;
  /// Whether the times that the file states differ from those of the time step, which replace them.
  [[nodiscard]] bool replaces_times() const;
  /// Median distance of a bead from its nearest neighbour in the first frame, sigma; NaN for fewer than two.
  [[nodiscard]] double spacing() const;
  /// Number of beads of the first frame whose centres lie beside the cell, beyond its side walls.
  [[nodiscard]] std::size_t n_beyond() const;
  /// The file's numbers of the beads, ascending: bead i of the trajectory is ids()[i] of the file.
  [[nodiscard]] const std::vector<std::int64_t>& ids() const;
  /// The unit of length that the file states; otherwise empty.
  [[nodiscard]] std::string length_unit() const;
  /// Whether the file states a known unit of time, so that times are in seconds (ForeignOptions).
  [[nodiscard]] bool time_in_seconds() const;
  /// What was assumed of the file, in sentences; otherwise empty.
  [[nodiscard]] std::string assumption() const;
  /// Appends all frames to `sink` in order.
  void copy_to(TrajectorySink& sink, Progress& progress = Progress::none()) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace twincell
