#pragma once
/// \file
/// Interface of the simulator: it takes a scene and produces a trajectory.

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/progress.hpp"
#include "core/stage_times.hpp"
#include "sim/run/contact_forces.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/scene/scene.hpp"
#include "sim/start/start.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sim {

/// Result of the settling of the bed before the drive starts.
struct RelaxationResult {
  double time = 0;             ///< duration, t0
  double energy_per_bead = 0;  ///< remaining kinetic energy, m g sigma
  bool reached = false;        ///< energy fell below scene.rest_energy; otherwise the time limit applied
};

/// Weighted sums of the temperature components over the samples since the last frame (Frame::time_mean).
/// `all` includes every sample, `coarse` every second one. The weight of a sample is the number of steps
/// since the preceding sample of the same sum.
struct TemperatureSums {
  Vec3 all = Vec3::Zero(), coarse = Vec3::Zero();
  std::int64_t steps = 0;  ///< total weight
};
/// Weighted sum of the forces over the samples since the last frame (Frame::force_mean). There is one sample
/// of the forces for two of the temperature, at a random step between them. Unknown in a run that stores no
/// contacts, and before the first sample.
using ForceSums = BedForces;

/// Complete state of a run: together with the scene, it determines the rest of the run. A run resumed from it
/// continues bit for bit.
struct RunState {
  bool driven = false;    ///< false: still settling on the plate at rest
  std::int64_t step = 0;  ///< number of steps since the start of settling, or since phase 0 of the drive
  int quiet = 0;          ///< number of consecutive checks that found the settling bed at rest
  RelaxationResult settled;
  double height = 0;  ///< height of the box of the trajectory, sigma
  std::vector<Bead> beads;
  std::vector<Force> forces;     ///< at the present positions, or empty
  std::vector<Vec3> rim_speeds;  ///< as in System
  std::vector<ContactMemory> contacts;
  std::vector<double> solver;                ///< Solver::memory()
  std::vector<std::uint8_t> tracer;          ///< empty if not chosen yet
  std::int64_t looked_at = 0, touching = 0;  ///< bead records in frames so far, and those in contact
  TemperatureSums temperature;
  ForceSums forces_sum;
};

/// The initial state of a scene: beads placed, no step done.
/// \throws ConfigError, InputError if the start is impossible
RunState placed(const Scene& scene, Progress& progress = Progress::none());

/// Largest number of steps of a run between two updates of its Progress: 2 million particle-steps, but at
/// least 64 steps.
std::int64_t steps_per_call(std::size_t beads);

/// Mean of m v^2/2 + I omega^2/2 over the beads, m g sigma; 0 without beads.
double kinetic_energy_per_bead(const System& s);

/// The step of a cycle that is nearest to `phase`, which is in cycles.
std::int64_t first_step(const Plan& plan, double phase);
/// Starts the drive of a settled system at the phase of the scene. The beads are shifted with the plate to
/// its position at that phase and, if scene.comoving, take its velocity.
void begin_drive(const Scene& scene, const Plan& plan, System& system);

/// A run of a scene: the bed settles on the plate at rest, then the plate drives it.
class Simulation {
 public:
  /// Places the beads and lets them settle.
  /// \throws ConfigError, InputError if the scene or start is impossible; RunError if settling fails
  /// \param threads for this one system; 0: chosen from the number of beads. The bits do not depend on it.
  explicit Simulation(const Scene& scene, Progress& progress = Progress::none(),
                      SolverKind kind = SolverKind::best, int threads = 1);
  /// Continues from a state of the same scene; does no step yet.
  Simulation(Scene scene, RunState state, SolverKind kind = SolverKind::best, int threads = 1);

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const Plan& plan() const { return plan_; }
  [[nodiscard]] const RelaxationResult& settled() const { return settled_; }
  [[nodiscard]] const System& system() const { return system_; }
  /// Warnings for the user: those of the plan, a bed that did not come to rest, a start in motion that does
  /// not continue bit for bit and, before the drive, an abrupt start.
  [[nodiscard]] std::vector<std::string> warnings() const;
  /// Metadata of the trajectory; of its provenance only `config`, the scene. Tracers are chosen when the bed
  /// has settled.
  [[nodiscard]] TrajectoryInfo trajectory_info() const;

  /// Completes the settling, if it is not complete.
  /// \param times receives the time of the stage "settling"; null: not timed
  void settle(Progress& progress = Progress::none(), StageTimes* times = nullptr);
  /// Runs discard + cycles periods and appends the frames of the latter to `sink`, `phases` per cycle, cycle
  /// 0 first.
  /// \throws RunError if the run fails (the frames up to there have been appended), Interrupted
  /// \param most ends the call after this number of frames; the next call continues from there
  /// \param times receives the times of the stages "stepping", "samples", "forces", "frames", "writing";
  ///     null: not timed
  void run(TrajectorySink& sink, Progress& progress = Progress::none(),
           std::int64_t most = std::numeric_limits<std::int64_t>::max(), StageTimes* times = nullptr);
  /// The present state. It is consistent whenever settle() and run() call progress.update: the frames of all
  /// steps before state().step have been appended, and no others.
  [[nodiscard]] RunState state() const;

  /// Number of steps under drive done by this object.
  [[nodiscard]] std::int64_t steps_done() const { return steps_done_; }
  [[nodiscard]] std::int64_t list_builds() const { return solver_->list_builds(); }
  /// Fraction of bead records in frames in which the bead touches another or a wall. In a dilute gas it
  /// equals t_c times the collision rate; theories of hard beads require a value below 0.1.
  [[nodiscard]] std::optional<double> contact_fraction() const;
  [[nodiscard]] const Solver& solver() const { return *solver_; }

 private:
  void advance(const std::vector<std::int64_t>& pieces, const std::function<void()>& after, StageTimes* times,
               std::string_view stage);
  [[nodiscard]] Frame snapshot(std::int64_t cycle, int phase) const;
  /// The step of frame k, counted from phase 0 of the drive, and the last frame at or before a step. If the
  /// frequency changes, the step is the one nearest to the phase of the frame.
  [[nodiscard]] std::int64_t step_of(std::int64_t frame) const;
  [[nodiscard]] std::int64_t frame_at(std::int64_t step) const;
  /// Samples between frames, an even number or 0.
  [[nodiscard]] std::int64_t samples_per_phase() const;
  /// Whole steps from a frame to sample j = 0 .. samples_per_phase() after it.
  /// \param interval to the next frame, steps
  [[nodiscard]] std::int64_t sample_at(std::int64_t j, std::int64_t interval) const;
  void take_sample(std::int64_t j, std::int64_t interval);
  /// Forces on the walls and stress at this instant.
  [[nodiscard]] BedForces forces_now();

  Scene scene_;
  Plan plan_;
  System system_;
  std::vector<std::uint8_t> tracer_;
  double height_ = 0;
  std::unique_ptr<Solver> solver_;
  bool driven_ = false;
  int quiet_ = 0;
  RelaxationResult settled_;
  std::int64_t steps_done_ = 0;
  std::int64_t looked_at_ = 0, touching_ = 0;  ///< bead records in frames, and those in contact
  TemperatureSums temperature_;
  ForceSums forces_sum_;
  std::vector<double> masses_;
  Frame sampled_;              ///< velocities of a sample; with contacts also positions and forces
  NearPairs near_;             ///< of the samples
  TrajectoryInfo of_samples_;  ///< box, walls, radii and masses of these
};

}  // namespace twincell::sim
