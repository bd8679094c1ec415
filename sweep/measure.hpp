#pragma once
/// \file
/// Simulation and analysis in one pass, without storing frames.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/observable/observable.hpp"
#include "core/progress.hpp"
#include "sim/run/simulation.hpp"

namespace twincell::sweep {

/// Results of a run.
struct Measured {
  std::vector<analysis::Result> results;
  std::int64_t cycles = 0;            ///< cycles that were run and analysed
  std::optional<bool> precise;        ///< whether the scene's [until] was reached; empty without [until]
  std::string until;                  ///< the precision reached, in a sentence
  std::optional<double> rest_height;  ///< centre-of-mass height of the resting bed before the drive, sigma
  std::optional<double> contact_fraction;
  std::vector<std::string> warnings;  ///< of the run when the bed had settled (Simulation::warnings)
};

/// Callbacks before the first frame and with every frame. If `frame` returns false at the last phase of a
/// cycle, the run ends there.
struct Observer {
  std::function<void(const TrajectoryInfo&)> begin = [](const TrajectoryInfo&) {};
  std::function<bool(const Frame&)> frame = [](const Frame&) { return true; };
};

/// \throws ConfigError if the drive of the scene has a ramp: results of the whole run would be those of no
/// drive
void require_one_drive(const sim::Scene& scene);

/// Runs the bed and analyses it while it runs, to the scene's last cycle or until its [until] is reached
/// (precision_rule.hpp). delta_h_cm is relative to the rest height given in the options, else to the height
/// of this bed after settling on the plate at rest (A = 0). There is no rest height without gravity, or if
/// the bed still has more than 0.005 m g sigma of energy per bead when settling ends.
/// \param times receives the times of the stages of the simulation and of each observable; null: not timed
/// \throws ConfigError, RunError, Interrupted
Measured measure(sim::Simulation& run, analysis::AnalysisOptions options, const std::string& name,
                 Progress& progress, const Observer& observer = {}, StageTimes* times = nullptr);

}  // namespace twincell::sweep
