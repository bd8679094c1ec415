#pragma once
/// \file
/// The run-time face of the simulator: a scene goes in, a trajectory comes out.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/trajectory/progress.hpp"
#include "analysis/trajectory/trajectory.hpp"
#include "sim/kernel.hpp"
#include "sim/scene.hpp"
#include "sim/start.hpp"

namespace twincell::sim {

/// How the bed came to rest before the drive began.
struct Settled {
  double time = 0;             ///< t0 it took
  double energy_per_bead = 0;  ///< kinetic energy left, m g sigma
  bool reached = false;        ///< below scene.rest_energy; otherwise the time limit ended it
};

/// A scene made ready. Construction places the beads and lets them settle on the resting plate; `run` drives
/// them.
class Simulation {
 public:
  /// \throws ConfigError, InputError for a scene or start that cannot be; RunError if settling goes wrong
  /// \param threads for this one system; 0: as many as its size is worth. The bits do not depend on it.
  explicit Simulation(Scene scene, Progress& progress = Progress::none(), KernelKind kind = KernelKind::best,
                      int threads = 1);

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const Plan& plan() const { return plan_; }
  [[nodiscard]] const Settled& settled() const { return settled_; }
  [[nodiscard]] const System& system() const { return system_; }
  /// What a user should know before the run: those of the plan, an abrupt start, a bed that did not come to
  /// rest.
  [[nodiscard]] std::vector<std::string> warnings() const;
  /// What the trajectory will hold, apart from provenance.
  [[nodiscard]] TrajectoryInfo trajectory_info() const;

  /// Runs discard + cycles periods and hands over the frames of the latter, `phases` a cycle, cycle 0 first.
  /// \throws RunError when the run goes wrong (frames up to there have been handed over), Interrupted
  void run(TrajectorySink& sink, Progress& progress = Progress::none());

  /// Steps done and neighbour lists built by `run`.
  [[nodiscard]] std::int64_t steps_done() const { return steps_done_; }
  [[nodiscard]] std::int64_t list_builds() const { return kernel_->list_builds(); }
  /// Share of beads and frames in which a bead touched another or a wall. In a dilute gas it is t_c times the
  /// collision rate; theories of hard beads want it below 0.1.
  [[nodiscard]] std::optional<double> contact_fraction() const;
  [[nodiscard]] const Kernel& kernel() const { return *kernel_; }

 private:
  void settle(Progress& progress);
  void start_drive(System& system) const;
  [[nodiscard]] Frame snapshot(std::int64_t cycle, int phase) const;

  Scene scene_;
  Plan plan_;
  System system_;
  std::vector<std::uint8_t> tracer_;
  double height_ = 0;
  std::unique_ptr<Kernel> kernel_;
  Settled settled_;
  std::int64_t steps_done_ = 0;
  std::int64_t looked_at_ = 0, touching_ = 0;  ///< beads in frames, and those of them in contact
};

}  // namespace twincell::sim
