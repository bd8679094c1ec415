#pragma once
/// \file
/// A simulation and its analysis in one pass: no frame is kept.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/observable/observable.hpp"
#include "core/progress.hpp"
#include "sim/run/simulation.hpp"

namespace twincell::sweep {

/// What a run gave.
struct Measured {
  std::vector<Result> results;
  std::int64_t cycles = 0;            ///< that were run and analysed
  std::optional<bool> precise;        ///< whether the scene's [until] was reached; empty: it has none
  std::string until;                  ///< what became of it, in a sentence
  std::optional<double> rest_height;  ///< sigma; of the bed as it rested before the drive
  std::optional<double> contact_fraction;
};

/// Called before the first frame and with every frame; `frame` false ends the run with its cycle.
struct Observer {
  std::function<void(const TrajectoryInfo&)> begin = [](const TrajectoryInfo&) {};
  std::function<bool(const Frame&)> frame = [](const Frame&) { return true; };
};

/// Runs the bed and analyses it while it runs, to the scene's last cycle or until its [until] is reached
/// (precision_rule.hpp). The height at rest from which delta_h_cm is taken is that of this very bed, settled
/// on the plate at rest (A = 0), unless the options name one; there is none without gravity, or where the bed
/// still moves with more than 0.005 m g sigma a bead when settling ends.
/// \throws ConfigError, RunError, Interrupted
Measured measure(sim::Simulation& run, AnalysisOptions options, const std::string& name, Progress& progress,
                 const Observer& beside = {});

}  // namespace twincell::sweep
