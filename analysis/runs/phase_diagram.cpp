#include "analysis/runs/phase_diagram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "analysis/motion/tracers.hpp"

namespace twincell::analysis {
namespace {

/// Index of the first (`forward`) or the last frame at phase 0; `start` if there is no such frame. If the
/// frames have no phase, the first or the last frame.
std::size_t find_phase_0(const TrajectorySource& trajectory, std::size_t start, bool forward) {
  Frame frame;
  const std::size_t n = trajectory.n_frames();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t index = forward ? i : n - 1 - i;
    trajectory.read(index, frame);
    if (frame.phase == 0 || !trajectory.info().columns.phase) return index;
  }
  return start;
}

}  // namespace

std::string side_name(Side side) {
  return side == Side::experiment ? "experiment" : "simulation";
}

Run analyze_run(const TrajectorySource& trajectory, Side side, const AnalysisOptions& options,
                Progress& progress) {
  const TrajectoryInfo& info = trajectory.info();
  if (!info.drive)
    throw InputError({.file = trajectory.name(), .key = "drive"},
                     "the trajectory does not state its drive, so that it has no Gamma");
  if (info.drive->ramp)
    throw InputError(
        {.file = trajectory.name(), .key = "drive.ramp"},
        "the drive of the run changes, so that the run has no one Gamma; `analyze --window-cycles` gives "
        "its results for windows of cycles");
  Run run;
  run.side = side;
  run.start = info.conditions.start;
  run.name = std::filesystem::path(trajectory.name()).filename().string();
  run.results = analyze(trajectory, options, progress);
  run.phase = phase_named(find_result(run.results, "phase").text);
  run.cutoff = neighbour_cutoff(info, options);
  run.gamma = info.conditions.gamma.value_or(info.drive->gamma());
  run.k_m = info.drive->k_m();
  run.omega = info.drive->omega;
  run.box = info.box;
  run.radius = info.radius;
  run.phases_per_cycle = info.phases_per_cycle;
  run.n_frames = trajectory.n_frames();
  run.first = snapshot(trajectory, find_phase_0(trajectory, 0, true), run.cutoff);
  run.last = snapshot(trajectory, find_phase_0(trajectory, run.n_frames - 1, false), run.cutoff);
  run.tracers = choose_tracers(info, run.first.frame, {options.tracers, options.tracer_band}).slots;
  run.n_beads = run.first.frame.n_present();
  run.n_l = info.conditions.n_l.value_or(static_cast<double>(run.n_beads) / info.box.size().x());
  return run;
}

std::optional<double> Run::drive_error() const {
  if (!amplitude_error) return std::nullopt;
  return std::hypot(*amplitude_error, scale_error.value_or(0));
}

std::vector<Match> match_runs(const std::vector<Run>& runs, double tolerance) {
  std::vector<std::size_t> order(runs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return runs[a].gamma < runs[b].gamma; });
  std::vector<Match> matches;
  std::vector<std::size_t> leaders;  // the run with the smallest Gamma of each match
  for (const std::size_t i : order) {
    const auto fits = [&](std::size_t leader) {
      return runs[i].gamma <= runs[leader].gamma * (1 + tolerance) &&
             same_height(runs[leader].n_l, runs[i].n_l);
    };
    const auto found = std::find_if(leaders.rbegin(), leaders.rend(), fits);
    const auto m =
        found == leaders.rend() ? matches.size() : static_cast<std::size_t>(leaders.rend() - found) - 1;
    if (found == leaders.rend()) {
      matches.emplace_back();
      leaders.push_back(i);
    }
    (runs[i].side == Side::experiment ? matches[m].experiments : matches[m].simulations).push_back(i);
  }
  for (Match& match : matches) {
    const auto n = static_cast<double>(match.experiments.size() + match.simulations.size());
    for (const auto* members : {&match.experiments, &match.simulations})
      for (const std::size_t i : *members) {
        match.gamma += runs[i].gamma / n;
        match.n_l += runs[i].n_l / n;
      }
  }
  return matches;
}

bool same_height(double a, double b) {
  return std::abs(a - b) <= 0.1 * a;
}

std::vector<double> heights_of(const std::vector<Match>& matches) {
  std::vector<double> heights;
  for (const Match& match : matches)
    if (std::none_of(heights.begin(), heights.end(), [&](double h) { return same_height(h, match.n_l); }))
      heights.push_back(match.n_l);
  std::sort(heights.begin(), heights.end());
  return heights;
}

std::string condition_text(const Match& match, bool height) {
  return fmt::format("Gamma {:.3g}", match.gamma) +
         (height ? fmt::format(", N_l = {:.3g}", match.n_l) : std::string());
}

BedPhase common_phase(const std::vector<Run>& runs, const std::vector<std::size_t>& members) {
  if (members.empty()) return BedPhase::undetermined;
  const BedPhase phase = runs[members.front()].phase;
  const bool agree =
      std::all_of(members.begin(), members.end(), [&](std::size_t i) { return runs[i].phase == phase; });
  return agree ? phase : BedPhase::undetermined;
}

}  // namespace twincell::analysis
