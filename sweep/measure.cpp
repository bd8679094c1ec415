#include "sweep/measure.hpp"

#include "analysis/motion/centre_of_mass.hpp"
#include "analysis/observable/timed_analysis.hpp"
#include "core/error.hpp"
#include "sweep/live_trajectory.hpp"
#include "sweep/precision_rule.hpp"

namespace twincell::sweep {

namespace {

double height_of_centre(const std::vector<sim::Bead>& beads) {
  double moment = 0, mass = 0;
  for (const sim::Bead& b : beads) {
    moment += b.mass * b.z;
    mass += b.mass;
  }
  return moment / mass;
}

}  // namespace

void require_one_drive(const sim::Scene& scene) {
  if (scene.drive.ramp)
    throw ConfigError(
        scene.where("drive.ramp"),
        "changes the drive during the run, so that results of the whole run are those of no one "
        "drive; use `simulate`, then `analyze --window-cycles`.");
}

Measured measure(sim::Simulation& run, analysis::AnalysisOptions options, const std::string& name,
                 Progress& progress, const Observer& observer, StageTimes* times) {
  Measured measured;
  std::optional<PrecisionRule> rule;
  const LiveTrajectory live(
      run, name, progress,
      [&](const Frame& frame) {
        measured.cycles = frame.cycle + 1;
        const bool goes_on = observer.frame(frame);
        return !(rule && rule->reached(frame)) && goes_on;
      },
      times);
  measured.warnings = run.warnings();
  const sim::Scene& scene = run.scene();
  if (scene.until) rule.emplace(scene, live.info());
  const bool rests = run.settled().time > 0 && run.settled().energy_per_bead < analysis::kAtRest;
  if (!options.rest_height && scene.g() > 0 && rests && !run.system().beads.empty())
    options.rest_height = height_of_centre(run.system().beads);
  measured.rest_height = options.rest_height;
  observer.begin(live.info());
  measured.results = analysis::analyze(live, options, Progress::none(), times);
  measured.contact_fraction = run.contact_fraction();
  if (rule) {
    measured.precise = rule->is_reached();
    measured.until = rule->text();
  }
  return measured;
}

}  // namespace twincell::sweep
