#include "twin/comparison.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "analysis/runs/pooling.hpp"
#include "core/atomic_file.hpp"
#include "core/plural.hpp"
#include "imaging/camera/noise_matched_camera.hpp"
#include "imaging/stack/open_frames.hpp"
#include "imaging/stack/representative_frames.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "trajectory/tracking_record.hpp"
#include "twin/sweep_results.hpp"
#include "twin/virtual_experiment.hpp"

namespace twincell::twin {
namespace {

namespace fs = std::filesystem;

/// Limits of a report page: bead positions of all snapshots together, bytes of pictures, snapshots per run.
constexpr std::size_t kMaxPositions = 400000, kMaxPictureBytes = 3000000, kMaxSnapshots = 20,
                      kMinSnapshots = 4;

/// The trajectories of both sides, experiments first.
struct Sides {
  std::vector<std::unique_ptr<H5mdReader>> trajectories;
  std::size_t n_experiments = 0;

  [[nodiscard]] analysis::Side side_of(std::size_t i) const {
    return i < n_experiments ? analysis::Side::experiment : analysis::Side::simulation;
  }
};

/// Opens the trajectories. \throws ConfigError if the named stacks do not match the experiments
Sides read_sides(const ComparingOptions& options) {
  if (!options.stacks.empty() && options.stacks.size() != options.experiments.size())
    throw ConfigError({.file = {}, .key = "--stack"},
                      fmt::format("{} given for {}; give one for each, in their order.",
                                  plural(options.stacks.size(), "stack"),
                                  plural(options.experiments.size(), "experiment")));
  Sides sides;
  sides.n_experiments = options.experiments.size();
  for (const auto* files : {&options.experiments, &options.simulations})
    for (const fs::path& file : *files) sides.trajectories.push_back(std::make_unique<H5mdReader>(file));
  return sides;
}

/// A note on films of one cell that show nearly, but not exactly, the same number of beads: some beads were
/// missed, or other objects were taken for beads.
void note_unequal_beds(const Sides& sides, const std::vector<analysis::RunEnds>& ends,
                       std::vector<std::string>& notes) {
  constexpr double kSameWidth = 0.02, kSameBed = 0.15;  // relative
  std::size_t fewest = 0, most = 0;
  for (std::size_t e = 1; e < sides.n_experiments; ++e) {
    if (ends[e].first.n_present() < ends[fewest].first.n_present()) fewest = e;
    if (ends[e].first.n_present() > ends[most].first.n_present()) most = e;
  }
  if (sides.n_experiments < 2) return;
  const auto few = static_cast<double>(ends[fewest].first.n_present()),
             many = static_cast<double>(ends[most].first.n_present());
  const auto width = [&](std::size_t e) { return sides.trajectories[e]->info().box.size().x(); };
  if (few == many || few < (1 - kSameBed) * many || std::abs(width(fewest) / width(most) - 1) > kSameWidth)
    return;
  notes.push_back(fmt::format(
      "{} shows {} beads in its first frame and {} shows {}: if the bed was the same, beads were missed or "
      "other objects were taken for beads (twincell locate --overlay).",
      sides.trajectories[fewest]->name(), few, sides.trajectories[most]->name(), many));
}

/// Refuses a run that is on both sides, and two- and three-dimensional runs on one side, whose phase
/// boundaries would be pooled. Notes what is unusual. \throws ConfigError
void check_sides(const Sides& sides, std::vector<std::string>& notes) {
  std::vector<analysis::RunEnds> ends;
  for (const auto& run : sides.trajectories) ends.emplace_back(*run);
  for (std::size_t e = 0; e < sides.n_experiments; ++e)
    for (std::size_t s = sides.n_experiments; s < ends.size(); ++s)
      if (ends[e].of_same_run(ends[s]))
        throw ConfigError({.file = {}, .key = "--simulation"},
                          fmt::format("{} contains the same run, bead for bead, as the experiment {}.",
                                      sides.trajectories[s]->name(), sides.trajectories[e]->name()));
  const auto dimension = [&](std::size_t i) { return sides.trajectories[i]->info().box.dimension; };
  for (std::size_t i = 0; i < sides.trajectories.size(); ++i) {
    const H5mdReader& run = *sides.trajectories[i];
    const std::size_t first = sides.side_of(i) == analysis::Side::experiment ? 0 : sides.n_experiments;
    if (dimension(i) != dimension(first))
      throw ConfigError({.file = run.name(), .key = "--" + analysis::side_name(sides.side_of(i))},
                        fmt::format("has {} dimensions, and {} has {}; compare them in two calls.",
                                    dimension(i), sides.trajectories[first]->name(), dimension(first)));
    if (sides.side_of(i) == analysis::Side::experiment && run.info().source == Origin::simulation)
      notes.push_back(fmt::format("{} is a simulation and is given as experiment.", run.name()));
  }
  note_unequal_beds(sides, ends, notes);
  const std::size_t n = sides.n_experiments;
  if (n > 0 && n < sides.trajectories.size() && dimension(0) != dimension(n))
    notes.push_back(
        fmt::format("the experiment has {} dimensions and the simulation {}; N_l = N sigma/L_x counts "
                    "all beads along the depth.",
                    dimension(0), dimension(n)));
}

/// Number of snapshots that the report can show of each run.
std::size_t snapshots_of_each(const Sides& sides) {
  std::size_t slots = 0;
  for (const auto& trajectory : sides.trajectories) slots += trajectory->info().n_beads;
  return std::clamp(kMaxPositions / std::max<std::size_t>(1, slots), kMinSnapshots, kMaxSnapshots);
}

/// Drops every other picture until the rest fits into `bytes`.
void thin(std::vector<std::string>& pictures, std::size_t bytes) {
  const auto total = [&] {
    std::size_t sum = 0;
    for (const std::string& p : pictures) sum += p.size();
    return sum;
  };
  for (std::size_t stride = 2; total() > bytes && stride < 2 * pictures.size(); stride *= 2)
    for (std::size_t i = 0; i < pictures.size(); ++i)
      if ((pictures.size() - 1 - i) % stride != 0) pictures[i].clear();
}

/// The stack behind a tracked trajectory, if its provenance names one.
fs::path stack_of(const TrajectoryInfo& info) {
  const auto provenance = nlohmann::json::parse(info.provenance_json, nullptr, false);
  const nlohmann::json::json_pointer path("/inputs/0/path");
  if (!provenance.is_object() || !provenance.contains(path) || !provenance.at(path).is_string()) return {};
  return provenance.at(path).get<std::string>();
}

/// The stack of experiment number `i`.
fs::path stack_behind(const ComparingOptions& options, const TrajectorySource& trajectory, std::size_t i) {
  return options.stacks.empty() ? stack_of(trajectory.info()) : options.stacks[i];
}

/// \throws ConfigError if the frames of a stack do not have the size of those that were tracked
void require_size(const fs::path& stack, const analysis::PictureFrame& camera,
                  const std::string& experiment) {
  const auto [width, height] = imaging::size_of_frames(*imaging::open_frames(stack));
  if (width == 0 || (width == camera.width && height == camera.height)) return;
  throw ConfigError(
      {.file = {}, .key = "--stack"},
      fmt::format("frames of {} are {} x {} px, those in which {} was tracked {} x {} px; name its own "
                  "stack.",
                  stack.string(), width, height, experiment, camera.width, camera.height));
}

/// Adds the camera's scale with its error and the frames at the snapshots of an experiment.
/// \param is_named whether the user named the stack
void show_frames(const TrajectoryInfo& info, const fs::path& stack, bool is_named, analysis::Run& run,
                 std::vector<std::string>& notes) {
  std::optional<TrackedCamera> camera;
  try {
    camera = tracked_camera(info, run.name);
  } catch (const InputError& e) {
    notes.push_back(
        fmt::format("the record of the camera is damaged, so its frames are not shown: {}", e.what()));
  }
  if (!camera) return;
  run.show.camera = {.pixels_per_sigma = camera->pixels_per_sigma,
                     .origin_x = camera->origin_x_px,
                     .origin_y = camera->origin_y_px,
                     .width = camera->width_px,
                     .height = camera->height_px};
  if (camera->scale_error_px) run.scale_error = *camera->scale_error_px / camera->pixels_per_sigma;
  if (stack.empty()) return;
  if (is_named) require_size(stack, *run.show.camera, run.name);
  std::vector<std::int64_t> numbers;
  for (const analysis::Snapshot& snapshot : run.show.snapshots) numbers.push_back(snapshot.frame.step);
  try {
    const auto frames = imaging::open_frames(stack);
    constexpr int kLongest_px = 800;
    run.show.pictures =
        imaging::picture_frames(*frames, numbers, kLongest_px, camera->rotation_deg, camera->distortion);
  } catch (const InputError& e) {
    notes.push_back(fmt::format("{}: the report shows no camera frames of it: {}", run.name, e.what()));
  }
}

/// Adds the folder to the names of runs whose files have the same name: "gamma-0.9/experiment.h5".
void tell_apart(std::vector<analysis::Run>& runs, const Sides& sides) {
  std::map<std::string, int> count;
  for (const analysis::Run& run : runs) ++count[run.name];
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (count[runs[i].name] > 1) {
      const fs::path file = fs::absolute(sides.trajectories[i]->name());
      runs[i].name = (file.parent_path().filename() / file.filename()).string();
    }
}

/// \throws ConfigError if two runs of one side are the same run: their scatter would come out too small
void refuse_repeated_runs(const std::vector<analysis::Run>& runs) {
  for (const analysis::Side side : {analysis::Side::experiment, analysis::Side::simulation}) {
    std::vector<std::vector<analysis::Result>> results;
    std::vector<const analysis::Run*> of_side;
    for (const analysis::Run& run : runs)
      if (run.side == side) {
        results.push_back(run.results);
        of_side.push_back(&run);
      }
    const std::vector<std::size_t> first = analysis::repeated_runs(results);
    for (std::size_t i = 0; i < first.size(); ++i)
      if (first[i] != i)
        throw ConfigError({.file = {}, .key = "--" + analysis::side_name(side)},
                          fmt::format("{} and {} are the same run, to the last digit; give it only once.",
                                      of_side[first[i]]->name, of_side[i]->name));
  }
}

/// Temporary folder that is removed on destruction.
struct Scratch {
  explicit Scratch(const fs::path& parent) {
    std::string name = (parent / "twincell-film-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
      throw ConfigError({.file = parent.string()}, "no folder for the film can be created there.");
    path = name;
    care_for_temporary(path);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
    forget_temporary(path);
  }
  fs::path path;
};

/// A camera and the origin of its noise.
struct LikeCamera {
  imaging::CameraOptions options;
  std::string origin;  ///< in words, after a comma; empty if the user chose the camera
};

/// Camera options like those of the experiment, as far as its frames show them: scale, illumination and
/// noise.
LikeCamera camera_of(const TrajectoryInfo& experiment, const fs::path& stack) {
  imaging::CameraOptions camera;
  if (experiment.scale.pixels_per_sigma) camera.pixels_per_sigma = *experiment.scale.pixels_per_sigma;
  if (stack.empty()) return {camera, ", the camera's default noise"};
  const bool bright = tracked_as_bright(experiment);
  try {
    camera = imaging::with_noise_of(*imaging::open_frames(stack), camera.pixels_per_sigma, bright, camera);
  } catch (const InputError&) {  // show_frames() has already reported the missing frames
    return {camera, ", the camera's default noise"};
  }
  return {
      camera,
      fmt::format(", noise as in the experiment's frames: {:.3g} grey levels and {:.3g} electrons a level",
                  camera.read_noise, camera.electrons_per_level)};
}

/// Virtual experiment of a simulation of a match, over as many cycles as the experiment has.
analysis::Checks::Filmed film(const analysis::Run& experiment, analysis::Run& simulation, std::size_t index,
                              const TrajectorySource& trajectory, const TrajectoryInfo& of_experiment,
                              const fs::path& stack, const ComparingOptions& options, Progress& progress) {
  const LikeCamera like = options.camera ? LikeCamera{*options.camera, ""} : camera_of(of_experiment, stack);
  const imaging::CameraOptions& camera = like.options;
  std::size_t frames = experiment.n_frames;
  if (experiment.phases_per_cycle > 0 && simulation.phases_per_cycle > 0)
    frames = frames * static_cast<std::size_t>(simulation.phases_per_cycle) /
             static_cast<std::size_t>(experiment.phases_per_cycle);
  const Beginning seen(trajectory, std::max<std::size_t>(1, frames));
  // Determine the temporary folder only here: without a film, a TMPDIR that does not exist is not an error.
  const Scratch scratch(options.scratch.empty() ? folder_for_temporaries() : options.scratch);
  const fs::path tracked = scratch.path / "filmed.h5";
  film_and_track(seen, camera, tracked, options.threads, simulation.show, progress);
  return {.run = index,
          .seen = analysis::analyze(seen, options.analysis),
          .filmed = analysis::analyze(H5mdReader(tracked), options.analysis),
          .camera = fmt::format("{:.4g} px per bead, {} of {} frames{}", camera.pixels_per_sigma,
                                seen.n_frames(), trajectory.n_frames(), like.origin)};
}

/// Analyses every trajectory and chooses its snapshots and camera frames for the report.
/// \param checks receives the tracer lines of all runs
std::vector<analysis::Run> analyse(const Sides& sides, const ComparingOptions& options,
                                   const ProgressOf& progress, std::vector<std::string>& notes,
                                   analysis::Checks& checks) {
  std::vector<analysis::Run> runs;
  const std::size_t most = snapshots_of_each(sides);
  for (std::size_t i = 0; i < sides.trajectories.size(); ++i) {
    const H5mdReader& trajectory = *sides.trajectories[i];
    const auto bar = progress(trajectory.name());
    analysis::Run run = analysis::analyze_run(trajectory, sides.side_of(i), options.analysis, *bar);
    for (const std::size_t f : analysis::representative_frames(trajectory, most))
      run.show.snapshots.push_back(analysis::snapshot(trajectory, f, run.cutoff));
    if (run.side == analysis::Side::experiment) {
      run.amplitude_error = tracked_amplitude_error(trajectory.info());
      show_frames(trajectory.info(), stack_behind(options, trajectory, i), !options.stacks.empty(), run,
                  notes);
    }
    for (auto& lines : analysis::tracer_lines(trajectory, i, options.analysis))
      checks.tracers.push_back(std::move(lines));
    runs.push_back(std::move(run));
  }
  tell_apart(runs, sides);
  return runs;
}

/// Virtual experiments: the first simulation of every match that has both sides, as its experiment's camera
/// and the tracking would show it. A simulation that cannot be filmed is left out, with a note.
std::vector<analysis::Checks::Filmed> film_matches(const Sides& sides, const ComparingOptions& options,
                                                   const std::vector<analysis::Match>& matches,
                                                   const ProgressOf& progress,
                                                   std::vector<std::string>& notes,
                                                   std::vector<analysis::Run>& runs) {
  std::vector<analysis::Checks::Filmed> filmed;
  for (const analysis::Match& match : matches) {
    if (match.experiments.empty() || match.simulations.empty()) continue;
    const std::size_t e = match.experiments.front(), s = match.simulations.front();
    const H5mdReader& experiment = *sides.trajectories[e];
    const auto bar = progress("filming " + runs[s].name);
    try {
      filmed.push_back(film(runs[e], runs[s], s, *sides.trajectories[s], experiment.info(),
                            stack_behind(options, experiment, e), options, *bar));
    } catch (const Interrupted&) {
      throw;
    } catch (const Error& error) {
      notes.push_back(fmt::format("{} could not be filmed: {}", runs[s].name, error.what()));
    }
  }
  return filmed;
}

/// Notes pairs of runs whose drives have another form: harmonics, a record, a ramp, a motion along x.
void note_other_drives(const Sides& sides, const std::vector<analysis::Run>& runs,
                       const std::vector<analysis::Match>& matches, std::vector<std::string>& notes) {
  const auto form = [&](std::size_t run) {
    const std::optional<Drive>& drive = sides.trajectories[run]->info().drive;
    return drive ? drive->formula() : std::string();
  };
  for (const analysis::Match& match : matches) {
    if (match.experiments.empty()) continue;
    const std::size_t e = match.experiments.front();
    for (const std::size_t s : match.simulations)
      if (!form(e).empty() && !form(s).empty() && form(s) != form(e)) {
        notes.push_back(
            fmt::format("the drive is {} in {} and {} in {}: these runs are compared, but their drives have "
                        "another form.",
                        form(e), runs[e].name, form(s), runs[s].name));
        break;
      }
  }
}

/// Notes pairs of runs that agree in Gamma and not in K_m: Gamma^2/K_m is omega^2 sigma/g.
void note_other_frequencies(const std::vector<analysis::Run>& runs,
                            const std::vector<analysis::Match>& matches, std::vector<std::string>& notes) {
  constexpr double kSame = 0.1;
  for (const analysis::Match& match : matches) {
    if (match.experiments.empty() || match.simulations.empty()) continue;
    const double of_experiment = runs[match.experiments.front()].k_m;
    const auto other = std::find_if(match.simulations.begin(), match.simulations.end(), [&](std::size_t s) {
      return std::abs(runs[s].k_m - of_experiment) > kSame * std::max(runs[s].k_m, of_experiment);
    });
    if (other != match.simulations.end())
      notes.push_back(
          fmt::format("Gamma = {:.4g}: K_m is {:.4g} in {} and {:.4g} in {}: these runs are "
                      "compared, but omega^2 sigma/g differs.",
                      match.gamma, of_experiment, runs[match.experiments.front()].name, runs[*other].k_m,
                      runs[*other].name));
  }
}

/// Notes experiments whose scale has no stated error.
void note_exact_scales(const Sides& sides, const std::vector<analysis::Run>& runs,
                       std::vector<std::string>& notes) {
  std::vector<std::string> names;
  for (std::size_t e = 0; e < sides.n_experiments; ++e)
    if (sides.trajectories[e]->info().scale.pixels_per_sigma && !runs[e].scale_error)
      names.push_back(runs[e].name);
  if (!names.empty())
    notes.push_back(fmt::format(
        "no error of the scale is stated for {} (camera.scale_error_px): the errors of lengths assume none.",
        fmt::join(names, ", ")));
}

/// Drops pictures until those of all runs fit into the page, each run with the same share.
void limit_pictures(std::vector<analysis::Run>& runs) {
  std::size_t with_pictures = 0;
  for (const analysis::Run& run : runs) with_pictures += run.show.pictures.empty() ? 0 : 1;
  for (analysis::Run& run : runs)
    thin(run.show.pictures, kMaxPictureBytes / std::max<std::size_t>(1, with_pictures));
}

}  // namespace

analysis::Comparison compare_runs(const ComparingOptions& options, const ProgressOf& progress) {
  const Sides sides = read_sides(options);
  analysis::Comparison c;
  std::vector<std::string>& notes = c.notes;
  check_sides(sides, notes);
  c.runs = analyse(sides, options, progress, notes, c.checks);
  refuse_repeated_runs(c.runs);
  c.matches = analysis::match_runs(c.runs, options.tolerance);
  note_other_frequencies(c.runs, c.matches, notes);
  note_other_drives(sides, c.runs, c.matches, notes);
  if (options.film) c.checks.filmed = film_matches(sides, options, c.matches, progress, notes, c.runs);
  limit_pictures(c.runs);
  c.boundaries = analysis::find_boundaries(c.runs);
  for (std::string& note : add_sweeps(options.sweeps, c)) notes.push_back(std::move(note));
  c.differences = analysis::find_differences(c.runs, c.matches, c.checks);
  if (!c.differences.empty()) note_exact_scales(sides, c.runs, notes);
  return c;
}

}  // namespace twincell::twin
