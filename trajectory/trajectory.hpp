#pragma once
/// \file
/// The trajectory: the one thing that imaging and simulation both make and that analysis reads.
///
/// Frames x beads, in reduced units (units.hpp), in the frame of Box (plate mean at z = 0, z up). A bead's
/// slot is its identity: slot i is the same bead in every frame. Beads of an experiment come and go: a slot
/// that is empty in a frame has id -1 and position NaN, never zero. A column that nobody measured is absent
/// (an empty vector), never filled in.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "trajectory/box.hpp"
#include "trajectory/drive.hpp"
#include "trajectory/units.hpp"

namespace twincell {

/// Which per-frame columns a trajectory has. Position is always there.
struct Columns {
  bool velocity = false;        ///< Frame::velocity
  bool spin = false;            ///< Frame::spin
  bool identity = false;        ///< Frame::id; without it every slot is filled in every frame
  bool phase = false;           ///< Frame::phase and Frame::cycle
  bool plate_height = false;    ///< Frame::plate_height
  bool position_sigma = false;  ///< Frame::position_sigma
  bool time_mean = false;       ///< Frame::time_mean
  bool contacts = false;        ///< Frame::contacts, force, moment and rim_speed
};

/// What is the same for all frames.
struct TrajectoryInfo {
  std::size_t n_beads = 0;  ///< slots
  Columns columns;
  Box box;
  std::optional<Drive> drive;
  int phases_per_cycle = 0;   ///< N_k, frames per drive cycle; 0 if not phase-locked
  int samples_per_cycle = 0;  ///< of Frame::time_mean; 0 without
  Scale scale;
  std::string source = "unknown";    ///< "simulation", "experiment" or "unknown"
  std::vector<double> radius;        ///< per slot, sigma; empty if absent
  std::vector<double> mass;          ///< per slot, m; empty if absent
  std::vector<std::uint8_t> tracer;  ///< per slot, 1 for a tracer bead; empty if absent
  std::string provenance_json;       ///< provenance.hpp; empty if absent
  std::string tracking_json;         ///< what the tracking of an experiment says of itself; empty if absent
};

/// Granular temperature averaged over the time since the frame before, m g sigma, per component as
/// temperature_components (temperature.hpp) defines it: what a few phases a cycle would alias, because it
/// jumps when the bed lands. NaN where it is not known, as before the first frame of a run.
struct TimeMean {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  Vec3 temperature = Vec3::Constant(kUnknown);
  Vec3 temperature_coarse = Vec3::Constant(kUnknown);  ///< from every second sample of those
};

/// What a contact remembers: tangential displacement and whatever else its laws keep while it lasts. Only a
/// simulation of the same laws can read the values.
struct ContactMemory {
  std::int32_t i = 0;  ///< bead
  std::int32_t j = 0;  ///< bead, > i; or -1 - w for wall w
  std::vector<double> values;
};

/// One moment.
struct Frame {
  static constexpr double kNoHeight = std::numeric_limits<double>::quiet_NaN();

  std::int64_t step = 0;             ///< simulation step or camera frame number; strictly increasing
  double time = 0;                   ///< t0
  std::int32_t phase = -1;           ///< k in 0 .. N_k-1: at k/N_k of a cycle; -1 unknown
  std::int64_t cycle = -1;           ///< j, from 0; -1 unknown
  double plate_height = kNoHeight;   ///< z_b, sigma; NaN unknown
  TimeMean time_mean;                ///< over the time since the frame before
  std::vector<Vec3> position;        ///< [n_beads], sigma; NaN where empty; not wrapped across periods
  std::vector<Vec3> position_sigma;  ///< [n_beads] or empty, standard uncertainty of each coordinate, sigma;
                                     ///< NaN where empty or not measured
  std::vector<Vec3> velocity;        ///< [n_beads] or empty, sigma/t0
  std::vector<Vec3> spin;  ///< [n_beads] or empty, angular velocity, 1/t0. A disc's counter-clockwise spin
                           ///< omega in the (x right, z up) drawing is the vector (0, -omega, 0)
  // What a simulation goes on from, beside positions and velocities; empty if absent.
  std::vector<ContactMemory> contacts;  ///< sorted by (i, j)
  std::vector<Vec3> force;              ///< [n_beads], of contacts, m g; NaN where it is not known
  std::vector<Vec3>
      moment;  ///< [n_beads], of contacts over the bead's radius, m g, as the simulation turns beads
  std::vector<Vec3>
      rim_speed;  ///< [n_beads], radius times angular velocity, sigma/t0; NaN where it is not known
  std::vector<std::int64_t> id;  ///< [n_beads] or empty; slot number where filled, -1 where empty

  /// Whether slot i holds a bead in this frame.
  [[nodiscard]] bool present(std::size_t i) const { return id.empty() || id[i] >= 0; }
  /// Number of filled slots.
  [[nodiscard]] std::size_t n_present() const;
};

/// Gives frames one at a time; memory does not grow with their number.
class TrajectorySource {
 public:
  virtual ~TrajectorySource() = default;
  [[nodiscard]] virtual const TrajectoryInfo& info() const = 0;
  [[nodiscard]] virtual std::size_t n_frames() const = 0;
  /// Reads frame `index` into `frame`, whose vectors are reused. \throws InputError if it cannot be read.
  virtual void read(std::size_t index, Frame& frame) const = 0;
  /// Name for messages: the file, or "memory".
  [[nodiscard]] virtual std::string name() const = 0;
};

/// Takes frames one at a time, in order of `step`.
class TrajectorySink {
 public:
  virtual ~TrajectorySink() = default;
  /// \throws RunError if the frame cannot be stored
  virtual void append(const Frame& frame) = 0;
};

/// A short trajectory held in memory: both ends in one.
class MemoryTrajectory : public TrajectorySource, public TrajectorySink {
 public:
  MemoryTrajectory() = default;
  explicit MemoryTrajectory(TrajectoryInfo info) : info_(std::move(info)) {}
  [[nodiscard]] const TrajectoryInfo& info() const override { return info_; }
  [[nodiscard]] TrajectoryInfo& info() { return info_; }
  [[nodiscard]] std::size_t n_frames() const override { return frames_.size(); }
  void read(std::size_t index, Frame& frame) const override { frame = frames_.at(index); }
  [[nodiscard]] std::string name() const override { return "memory"; }
  void append(const Frame& frame) override { frames_.push_back(frame); }
  [[nodiscard]] const std::vector<Frame>& frames() const { return frames_; }

 private:
  TrajectoryInfo info_;
  std::vector<Frame> frames_;
};

}  // namespace twincell
