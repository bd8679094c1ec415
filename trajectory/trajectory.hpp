#pragma once
/// \file
/// The trajectory: the data that imaging and simulation produce and that analysis reads.
///
/// Frames x beads, in reduced units (units.hpp) and in the coordinates of Box (plate mean at z = 0, z up).
/// The slot of a bead is its identity: slot i is the same bead in every frame. In an experiment, a bead may
/// be missing from some frames. A slot that is empty in a frame has id -1 and position NaN, never zero. A
/// column that was not measured is absent (an empty vector), never filled with substitutes.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/choice.hpp"
#include "trajectory/box.hpp"
#include "trajectory/drive.hpp"
#include "trajectory/units.hpp"

namespace twincell {

/// Which per-frame columns a trajectory has. Position is always present.
struct Columns {
  bool velocity = false;        ///< Frame::velocity
  bool spin = false;            ///< Frame::spin
  bool identity = false;        ///< Frame::id; without it every slot is filled in every frame
  bool phase = false;           ///< Frame::phase and Frame::cycle
  bool plate_height = false;    ///< Frame::plate_height
  bool position_sigma = false;  ///< Frame::position_sigma
  bool time_mean = false;       ///< Frame::time_mean
  bool contacts = false;        ///< Frame::contacts, force, moment and rim_speed
  bool contact_forces = false;  ///< Frame::contact_forces
  bool force_mean = false;      ///< Frame::force_mean
};

/// Where a run stands in the phase diagram, as the program that made the run knew it.
struct RunConditions {
  std::optional<double> n_l;    ///< N_l sigma = N sigma/L_x, with N the number of beads of the first frame
  std::optional<double> gamma;  ///< Gamma = A omega^2/g with the g of the run; absent without gravity
  std::string start;            ///< start.kind of the scene of a simulation; empty: unknown or an experiment
};

/// Where the beads of a trajectory come from.
enum class Origin { unknown, simulation, experiment };
/// The words of all origins, as files, options and results state them. The first is the default.
inline constexpr std::array kOrigins = {
    Choice<Origin>{.value = Origin::unknown, .word = "unknown", .help = "not stated"},
    Choice<Origin>{.value = Origin::simulation, .word = "simulation", .help = "computed"},
    Choice<Origin>{.value = Origin::experiment, .word = "experiment", .help = "located in frames"}};

/// The word of an origin.
inline std::string word_of(Origin origin) {
  return std::string(row_of(kOrigins, origin).word);
}

/// Data common to all frames.
struct TrajectoryInfo {
  std::size_t n_beads = 0;  ///< slots
  Columns columns;
  Box box;
  std::optional<Drive> drive;
  int phases_per_cycle = 0;   ///< N_k, frames per drive cycle; 0 if not phase-locked
  int samples_per_cycle = 0;  ///< of Frame::time_mean and force_mean; 0 if absent
  Scale scale;
  RunConditions conditions;
  Origin source = Origin::unknown;
  std::vector<double> radius;        ///< per slot, sigma; empty if absent
  std::vector<double> mass;          ///< per slot, m; empty if absent
  std::vector<std::uint8_t> tracer;  ///< per slot, 1 for a tracer bead; empty if absent
  std::vector<std::string> walls;    ///< names of the walls that ContactForce::j counts; empty if absent
  std::string provenance_json;       ///< provenance.hpp; empty if absent
  std::string tracking_json;         ///< report of the tracking of an experiment, JSON; empty if absent
};

/// Radius of a bead whose radius is not stored, sigma: the unit of length is the diameter of a bead.
constexpr double kUsualRadius = 0.5;
/// Radius of the bead of a slot, sigma.
/// \param radius TrajectoryInfo::radius; empty: all kUsualRadius
inline double radius_of(const std::vector<double>& radius, std::size_t slot) {
  return radius.empty() ? kUsualRadius : radius[slot];
}
/// Mass of the bead of a slot, m.
/// \param mass TrajectoryInfo::mass; empty: all 1
inline double mass_of(const std::vector<double>& mass, std::size_t slot) {
  return mass.empty() ? 1 : mass[slot];
}

/// Magnitude of the acceleration of gravity of a run, sigma/t0^2: that of its drive; 1 without a drive; 0 for
/// a run that states its N_l and neither a Gamma nor a ramp: it has no gravity, as Drive cannot say. Runs of
/// other programs state neither number.
double gravity_of(const TrajectoryInfo& info);

/// Granular temperature averaged over the time since the previous frame, m g sigma, per component as defined
/// by temperature_components (temperature.hpp). It jumps when the bed lands, so that samples at a few phases
/// per cycle would alias it. NaN where unknown, as before the first frame of a run.
struct TimeMean {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  Vec3 temperature = Vec3::Constant(kUnknown);
  Vec3 temperature_coarse = Vec3::Constant(kUnknown);  ///< from every second one of the same samples
};

/// Forces on the walls and stress of a bed, at one instant (bed_forces.hpp) or averaged over the time since
/// the previous frame. The means are over samples at random steps: nearly all of the momentum that a bed
/// takes from the plate passes while it lands, so that frames at a few phases per cycle would alias them.
struct BedForces {
  using Tensor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> wall_normal_force;       ///< [walls], of the beads on the wall, m g; positive: pressure
  std::vector<Vec3> wall_force;                ///< [walls], of the beads on the wall, m g
  Tensor stress = Tensor::Constant(kUnknown);  ///< of the contacts, positive in compression, m g/sigma^(d-1)
  Tensor kinetic = Tensor::Constant(kUnknown);  ///< of the velocities, same unit
  double in_contact = kUnknown;                 ///< fraction of the time with contacts between beads
  double normal_force = kUnknown;      ///< mean normal force of these contacts, m g; 0 while there are none
  double tangential_force = kUnknown;  ///< mean modulus of their tangential force; same

  /// Whether the forces are known; not before the first frame of a run.
  [[nodiscard]] bool known() const { return std::isfinite(in_contact); }
  /// All zero, for a sum over samples.
  static BedForces zero(std::size_t walls);
  /// Adds `weight` times the forces of a sample with the same walls.
  void add(const BedForces& sample, double weight);
};

/// History of a contact: its tangential displacement and any other state that its laws keep for its duration.
/// Only a simulation with the same laws can interpret the values.
struct ContactMemory {
  std::int32_t i = 0;  ///< bead
  std::int32_t j = 0;  ///< bead, > i; or -1 - w for wall w
  std::vector<double> values;
};

/// Force at a contact of two beads, or of a bead and a wall, at one instant.
struct ContactForce {
  std::int32_t i = 0;          ///< bead
  std::int32_t j = 0;          ///< bead, > i; or -1 - w for wall w of TrajectoryInfo::walls
  double overlap = 0;          ///< R_i + R_j - |r_i - r_j|, sigma; R_i minus the distance of the wall
  Vec3 normal = Vec3::Zero();  ///< unit vector from j, or from the wall, to i
  double normal_force = 0;     ///< on i along `normal`, m g; negative: attraction
  Vec3 tangential_force = Vec3::Zero();  ///< on i, perpendicular to `normal`, m g

  /// Force on i, m g; that on j is its opposite.
  [[nodiscard]] Vec3 force() const { return normal_force * normal + tangential_force; }
};

/// State of all beads at one instant.
struct Frame {
  static constexpr double kNoHeight = std::numeric_limits<double>::quiet_NaN();

  std::int64_t step = 0;             ///< simulation step or camera frame number; strictly increasing
  double time = 0;                   ///< t0
  std::int32_t phase = -1;           ///< k in 0 .. N_k-1: at k/N_k of a cycle; -1 unknown
  std::int64_t cycle = -1;           ///< j, from 0; -1 unknown
  double plate_height = kNoHeight;   ///< along Drive::axis, sigma (plate.hpp); NaN unknown
  TimeMean time_mean;                ///< over the time since the previous frame
  BedForces force_mean;              ///< over the time since the previous frame; without walls if unknown
  std::vector<Vec3> position;        ///< [n_beads], sigma; NaN where empty; not wrapped across periods
  std::vector<Vec3> position_sigma;  ///< [n_beads] or empty, standard uncertainty of each coordinate, sigma;
                                     ///< NaN where empty or not measured
  std::vector<Vec3> velocity;        ///< [n_beads] or empty, sigma/t0
  std::vector<Vec3> spin;  ///< [n_beads] or empty, angular velocity, 1/t0. A disc's counter-clockwise spin
                           ///< omega in the (x right, z up) drawing is the vector (0, -omega, 0)
  // State from which a simulation continues, in addition to positions and velocities; empty if absent.
  std::vector<ContactMemory> contacts;  ///< sorted by (i, j)
  std::vector<Vec3> force;              ///< [n_beads], sum over the bead's contacts, m g; NaN where unknown
  std::vector<Vec3> moment;  ///< [n_beads], torque of the contacts divided by the radius, m g, as Force
                             ///< (sim/system/system.hpp) defines it
  std::vector<ContactForce> contact_forces;  ///< sorted by (i, j); empty if absent or without contact
  std::vector<Vec3> rim_speed;   ///< [n_beads], radius times angular velocity, sigma/t0; NaN where unknown
  std::vector<std::int64_t> id;  ///< [n_beads] or empty; slot number where filled, -1 where empty

  /// Whether slot i contains a bead in this frame.
  [[nodiscard]] bool present(std::size_t i) const { return id.empty() || id[i] >= 0; }
  /// Number of filled slots.
  [[nodiscard]] std::size_t n_present() const;
};

/// Source of frames, read one at a time. Memory use does not grow with their number.
class TrajectorySource {
 public:
  virtual ~TrajectorySource() = default;
  /// What does not change from frame to frame: cell, drive, units, beads, origin.
  [[nodiscard]] virtual const TrajectoryInfo& info() const = 0;
  /// Number of frames, which read() accepts as indices from 0.
  [[nodiscard]] virtual std::size_t n_frames() const = 0;
  /// Reads frame `index` into `frame`, whose vectors are reused.
  /// \throws InputError if it cannot be read.
  virtual void read(std::size_t index, Frame& frame) const = 0;
  /// Name for messages: the file, or "memory".
  [[nodiscard]] virtual std::string name() const = 0;
};

/// Destination of frames, written one at a time in order of `step`.
class TrajectorySink {
 public:
  virtual ~TrajectorySink() = default;
  /// \throws RunError if the frame cannot be stored
  virtual void append(const Frame& frame) = 0;
};

/// A short trajectory in memory, both source and sink.
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
