#include "sweep/point_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>

#include "analysis/observable/observable.hpp"
#include "analysis/observable/results.hpp"
#include "core/cpu_clock.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/provenance.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/start/start.hpp"
#include "sweep/conditions.hpp"
#include "sweep/measure.hpp"
#include "sweep/stop_rule.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::sweep {

namespace {

/// Mutex for HDF5: Debian's HDF5 library is not thread-safe.
std::mutex& hdf5_turn() {
  static std::mutex turn;
  return turn;
}

/// A trajectory writer for use while other threads write their own trajectories.
class SharedWriter {
 public:
  SharedWriter(const std::filesystem::path& path, TrajectoryInfo info) {
    const std::lock_guard lock(hdf5_turn());
    writer_ = std::make_unique<H5mdWriter>(path, std::move(info));
  }
  ~SharedWriter() {
    const std::lock_guard lock(hdf5_turn());
    writer_.reset();
  }
  SharedWriter(const SharedWriter&) = delete;
  SharedWriter& operator=(const SharedWriter&) = delete;
  void append(const Frame& frame) {
    const std::lock_guard lock(hdf5_turn());
    writer_->append(frame);
  }
  void finish() {
    const std::lock_guard lock(hdf5_turn());
    writer_->finish();
  }

 private:
  std::unique_ptr<H5mdWriter> writer_;
};

/// Wraps an error of the disk, to distinguish it from a failure of the simulation.
struct DiskTrouble {
  Error error;
};

template <class Work>
void on_disk(Work work) {
  try {
    work();
  } catch (const Error& e) {
    throw DiskTrouble{e};
  }
}

/// \throws RunError if there is no room for the beads: that is the result of one point, which other points
/// and seeds need not share. ConfigError for what holds for every point, or only now, as the available memory
sim::RunState placed_in_turn(const sim::Scene& scene, Progress& progress) {
  const std::lock_guard lock(hdf5_turn());  // the start may be read from a trajectory file
  try {
    return sim::placed(scene, progress);
  } catch (const sim::NoRoom& e) {
    throw RunError(e.what());
  }
}

/// Value of the result of the plan's criterion; NaN if the run has none.
double asked_of(const Plan& plan, const std::vector<analysis::Result>& results) {
  const analysis::Result& result = analysis::find_result(results, plan.criterion->result);
  if (!result.shape.empty() || !result.text.empty())
    throw ConfigError({.file = plan.file, .key = "search.result"},
                      fmt::format("'{}' is {}; a search compares one number", result.name,
                                  result.text.empty() ? "an array" : "a word"));
  return result.value();
}

/// The warnings that only the run could give; those of its scene are known from the plan.
std::vector<std::string> warnings_of_run(const sim::Plan& plan, const Measured& measured) {
  std::vector<std::string> told;
  for (const std::string& text : measured.warnings)
    if (std::find(plan.warnings.begin(), plan.warnings.end(), text) == plan.warnings.end())
      told.push_back(text);
  return told;
}

}  // namespace

std::string run_point(const Plan& plan, const Point& point, const std::filesystem::path& trajectory,
                      Progress& progress, StageTimes* times, sim::SolverKind solver) {
  const auto begin = std::chrono::steady_clock::now();
  const double cpu_begin = thread_cpu_seconds();
  nlohmann::json document = {{"id", point.id}, {"answer", nullptr}};
  std::int64_t cycles = 0;
  try {
    sim::Scene scene = sim::read_scene_text(point.scene, "point " + point.id, {}, plan.scene_folder);
    sim::RunState state = [&] {
      Stage placing(times, "placing", "points");
      placing.count(1);
      return placed_in_turn(scene, progress);
    }();
    const std::int64_t all_cycles = scene.cycles;
    sim::Simulation run(std::move(scene), std::move(state), solver);
    document["conditions"] = conditions_json(run.trajectory_info().conditions);
    std::optional<StopRule> rule;
    std::unique_ptr<SharedWriter> writer;
    const Observer observer{
        .begin =
            [&](const TrajectoryInfo& info) {
              if (plan.stop_early && plan.criterion) rule.emplace(*plan.criterion, info, all_cycles);
              if (trajectory.empty()) return;
              TrajectoryInfo kept = info;
              Provenance provenance;
              provenance.config = point.scene;
              provenance.seed = point.seed;
              kept.provenance_json = provenance.to_json();
              on_disk([&] { writer = std::make_unique<SharedWriter>(trajectory, std::move(kept)); });
            },
        .frame =
            [&](const Frame& frame) {
              cycles = frame.cycle + 1;
              if (writer) on_disk([&] { writer->append(frame); });
              return !rule || !rule->add_frame(frame);
            }};
    analysis::AnalysisOptions options;
    options.only = plan.results;
    const Measured measured = measure(run, options, "point " + point.id, progress, observer, times);
    const auto& results = measured.results;
    if (writer) on_disk([&] { writer->finish(); });
    if (const auto told = warnings_of_run(run.plan(), measured); !told.empty()) document["warnings"] = told;
    document["results"] = nlohmann::json::parse(analysis::results_json(results));
    if (measured.precise) document["until"] = {{"reached", *measured.precise}, {"text", measured.until}};
    if (measured.rest_height) document["rest_height"] = *measured.rest_height;
    if (measured.contact_fraction) document["contact_fraction"] = *measured.contact_fraction;
    if (rule && !rule->reason().empty()) document["stopped"] = rule->reason();
    if (plan.criterion)
      if (const double value = asked_of(plan, results); std::isfinite(value))
        document["answer"] = value > plan.criterion->above;
  } catch (const RunError& e) {
    document["failed"] = e.what();
  } catch (const DiskTrouble& e) {
    throw Error(e.error);
  }
  document["n_cycles"] = cycles;
  const nlohmann::json provenance = nlohmann::json::parse(Provenance{}.to_json());
  document["computed"] = {
      {"seconds", std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()},
      {"program", version_line()}};
  if (solver != sim::SolverKind::gpu)
    document["computed"]["processor_seconds"] = thread_cpu_seconds() - cpu_begin;
  for (const char* key : {"utc", "processor"}) document["computed"][key] = provenance.at(key);
  return json_text(document) + "\n";
}

}  // namespace twincell::sweep
