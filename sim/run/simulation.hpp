#pragma once
/// \file
/// The run-time face of the simulator: a scene goes in, a trajectory comes out.

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/scene/scene.hpp"
#include "sim/start/start.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sim {

/// How the bed came to rest before the drive began.
struct RelaxationResult {
  double time = 0;             ///< t0 it took
  double energy_per_bead = 0;  ///< kinetic energy left, m g sigma
  bool reached = false;        ///< below scene.rest_energy; otherwise the time limit ended it
};

/// Of the samples taken since the last frame (Frame::time_mean), each weighted by the steps since the one
/// before.
struct TemperatureSums {
  Vec3 all = Vec3::Zero(), coarse = Vec3::Zero();
  std::int64_t steps = 0;  ///< that they stand for
};

/// All that the rest of a run depends on, besides its scene. A run taken up from it goes on bit for bit.
struct RunState {
  bool driven = false;    ///< false: still settling on the resting plate
  std::int64_t step = 0;  ///< since settling began, or since phase 0 of the drive
  int quiet = 0;          ///< looks in a row at which the settling bed was at rest
  RelaxationResult settled;
  double height = 0;  ///< of the trajectory's box, sigma
  std::vector<Bead> beads;
  std::vector<Force> forces;     ///< at the present positions, or empty
  std::vector<Vec3> rim_speeds;  ///< as in System
  std::vector<ContactMemory> contacts;
  std::vector<double> kernel;                ///< Solver::memory()
  std::vector<std::uint8_t> tracer;          ///< empty: not chosen yet
  std::int64_t looked_at = 0, touching = 0;  ///< beads in frames so far, and those of them in contact
  TemperatureSums temperature;
};

/// The state in which a scene begins: beads placed, nothing moved.
/// \throws ConfigError, InputError for a start that cannot be
RunState placed(const Scene& scene, Progress& progress = Progress::none());

/// m v^2/2 + I omega^2/2, their mean over beads; 0 without beads.
double kinetic_energy_per_bead(const System& s);

/// The step of a cycle that is nearest to this phase of it, cycles.
std::int64_t first_step(const Plan& plan, double phase);
/// Sets the plate of a settled system going, at the scene's phase: beads move along with the plate to where
/// it is.
void begin_drive(const Scene& scene, const Plan& plan, System& system);

/// A scene made ready and run: the bed settles on the resting plate, then the plate drives it.
class Simulation {
 public:
  /// Places the beads and lets them settle.
  /// \throws ConfigError, InputError for a scene or start that cannot be; RunError if settling goes wrong
  /// \param threads for this one system; 0: as many as its size is worth. The bits do not depend on it.
  explicit Simulation(const Scene& scene, Progress& progress = Progress::none(),
                      SolverKind kind = SolverKind::best, int threads = 1);
  /// Goes on from a state of the same scene, nothing moved yet.
  Simulation(Scene scene, RunState state, SolverKind kind = SolverKind::best, int threads = 1);

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const Plan& plan() const { return plan_; }
  [[nodiscard]] const RelaxationResult& settled() const { return settled_; }
  [[nodiscard]] const System& system() const { return system_; }
  /// What a user should know: those of the plan, a bed that did not come to rest, and before the drive an
  /// abrupt start.
  [[nodiscard]] std::vector<std::string> warnings() const;
  /// What the trajectory will hold, apart from provenance. Tracers are chosen when the bed has settled.
  [[nodiscard]] TrajectoryInfo trajectory_info() const;

  /// Settles what is left to settle.
  /// \throws RunError, Interrupted
  void settle(Progress& progress = Progress::none());
  /// Runs discard + cycles periods and hands over the frames of the latter, `phases` a cycle, cycle 0 first.
  /// \param most ends the call when so many frames have been handed over; the next call goes on from there
  /// \throws RunError when the run goes wrong (frames up to there have been handed over), Interrupted
  void run(TrajectorySink& sink, Progress& progress = Progress::none(),
           std::int64_t most = std::numeric_limits<std::int64_t>::max());
  /// The state now. Whenever settle() and run() call progress.update it is whole: frames of all steps before
  /// state().step have been handed over, and no others.
  [[nodiscard]] RunState state() const;

  /// Steps of the drive done by this object.
  [[nodiscard]] std::int64_t steps_done() const { return steps_done_; }
  [[nodiscard]] std::int64_t list_builds() const { return kernel_->list_builds(); }
  /// Share of beads and frames in which a bead touched another or a wall. In a dilute gas it is t_c times the
  /// collision rate; theories of hard beads want it below 0.1.
  [[nodiscard]] std::optional<double> contact_fraction() const;
  [[nodiscard]] const Solver& kernel() const { return *kernel_; }

 private:
  [[nodiscard]] Frame snapshot(std::int64_t cycle, int phase) const;
  /// Steps between frames, and samples taken in them: an even number, or none.
  [[nodiscard]] std::int64_t steps_per_phase() const { return plan_.steps_per_period / scene_.phases; }
  [[nodiscard]] std::int64_t samples_per_phase() const;
  /// Whole steps from a frame to sample j = 0 .. samples_per_phase() after it.
  [[nodiscard]] std::int64_t sample_at(std::int64_t j) const;
  void take_sample(std::int64_t j);

  Scene scene_;
  Plan plan_;
  System system_;
  std::vector<std::uint8_t> tracer_;
  double height_ = 0;
  std::unique_ptr<Solver> kernel_;
  bool driven_ = false;
  int quiet_ = 0;
  RelaxationResult settled_;
  std::int64_t steps_done_ = 0;
  std::int64_t looked_at_ = 0, touching_ = 0;  ///< beads in frames, and those of them in contact
  TemperatureSums temperature_;
  std::vector<double> masses_;
  Frame sampled_;  ///< velocities of a sample
};

}  // namespace twincell::sim
