// twincell track STACK: locates the beads, determines the drive phases, links the beads, and writes a
// trajectory.

#include "imaging/track/track.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <fstream>
#include <memory>
#include <optional>

#include "calibration/drive/plate_drive.hpp"
#include "cli/locating_options.hpp"
#include "cli/output.hpp"
#include "cli/phase_options.hpp"
#include "cli/stack_info.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "imaging/benchmark/score.hpp"
#include "imaging/stack/open_frames.hpp"
#include "imaging/track/write_trajectory.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::cli {

namespace {

struct TrackOptions {
  std::string stack, output, cell_file, csv, truth;
  std::vector<double> scored_rows, origin;
  std::vector<std::string> assignments;
  PhaseFlags phase;
  std::optional<double> pixels_per_sigma, gamma, amplitude, width, height;
  std::optional<int> frames_per_cycle, first_phase;
  int shortest = 1;
  bool trust_stated_drive = false;
  LocatingFlags locating;
  LinkOptions link;
};

// The cell description of the file, with the options of the command line taking precedence.
CellDescription resolve_cell(const TrackOptions& o) {
  // Options that set keys of the file are passed on as assignments. If the file states a scale, a value
  // without a unit is therefore refused here too.
  std::vector<std::string> assignments = o.assignments;
  const auto assign = [&](const char* key, std::optional<double> value) {
    if (value) assignments.push_back(fmt::format("{}={}", key, *value));
  };
  assign("cell.width", o.width);
  assign("cell.height", o.height);
  assign("drive.gamma", o.gamma);
  assign("drive.amplitude", o.amplitude);
  refuse_said_twice(assignments);
  CellDescription cell = read_cell(o.cell_file, assignments);
  if (o.pixels_per_sigma) cell.pixels_per_sigma = o.pixels_per_sigma;
  if (o.origin.size() == 2) cell.origin = PixelPoint{o.origin[0], o.origin[1]};
  if (o.frames_per_cycle) cell.phase_lock.frames_per_cycle = *o.frames_per_cycle;
  if (o.first_phase) cell.phase_lock.first_phase = *o.first_phase;
  // Two quantities determine the drive. A third quantity, from the file, would contradict them and is
  // dropped.
  if (o.gamma || o.amplitude) {
    for (const std::string& assignment : o.assignments)
      if (assignment.starts_with("drive."))
        throw ConfigError(
            {"--set", 0, 0, assignment},
            "and --drive-gamma or --drive-amplitude both set the drive; use only one of the two.");
    cell.drive_spec = {.amplitude = o.amplitude ? cell.drive_spec.amplitude : std::nullopt,
                       .omega = {},
                       .frequency = {},
                       .gamma = o.gamma ? cell.drive_spec.gamma : std::nullopt,
                       .k_m = {},
                       .peak_velocity = {}};
  }
  cell.phase_lock.check(Where{.file = {}, .key = "first-phase"});
  return cell;
}

constexpr const char* kHeading = "y,x,frame,particle,radius,tracer,phase,cycle,sigma_y,sigma_x,ambiguous\n";

void write_csv(const std::string& path, const TrackedStack& stack, const FrameRange& range) {
  AtomicPath file(path, Product::table(kHeading));
  {
    std::ofstream out(file.part());
    out << kHeading;
    for (std::size_t f = 0; f < stack.frames.size(); ++f) {
      const FramePhase at = stack.phases.at(static_cast<std::int64_t>(f));
      for (const TrackedBead& b : stack.frames[f])
        out << fmt::format("{:.4f},{:.4f},{},{},{:.4f},{},{},{},{:.4f},{:.4f},{}\n", b.y_px, b.x_px,
                           range.number(static_cast<std::int64_t>(f)), b.track, b.radius_px, b.tracer ? 1 : 0,
                           at.phase, at.cycle, b.sigma_y_px, b.sigma_x_px, b.ambiguous ? 1 : 0);
    }
    if (!out.flush()) throw RunError(path + ": writing the table failed.");
  }
  file.commit();
}

Score score_against(const TrackOptions& o, const TrackedStack& stack, const FrameRange& range) {
  const auto truth = read_truth(o.truth);
  Scorer scorer(o.scored_rows.size() == 2 ? ScoredRows{o.scored_rows[0], o.scored_rows[1]} : ScoredRows{});
  for (std::size_t f = 0; f < stack.frames.size(); ++f) {
    const auto number = static_cast<std::size_t>(range.number(static_cast<std::int64_t>(f)));
    if (number >= truth.size()) break;
    std::vector<FoundBead> found;
    for (const TrackedBead& b : stack.frames[f]) found.push_back({b.x_px, b.y_px, b.track});
    scorer.add(truth[number], found);
  }
  return scorer.score();
}

// The printed summary of the phases, the links and the tracers.
std::string describe(const TrackedStack& stack) {
  std::string text = phases_in_words(stack.phases);
  const LinkReport& l = stack.links;
  text += fmt::format(
      "links: {} made, {} bridge a gap, {} ambiguous; {} births, {} losses; largest sub-network {}; {} "
      "frames matched again, all beads at once\n",
      l.links, l.bridged, l.ambiguous, l.births, l.losses, l.largest_network, l.rematched);
  if (l.unsolved > 0)
    text += fmt::format(
        "frames too crowded for an exact solution: {} beads were linked to their nearest free detection\n",
        l.unsolved);
  std::int64_t tracers = 0, uncertain = 0;
  for (const TrackSummary& t : stack.tracks) {
    tracers += t.is_tracer() ? 1 : 0;
    uncertain += t.is_tracer() && t.ambiguous > 0 ? 1 : 0;
  }
  if (tracers > 0) {
    const auto broken = stack.broken_tracers();
    text += fmt::format(
        "tracers: {} tracks, {} of them with ambiguous links, {} not from the first frame to the last",
        tracers, uncertain, broken.size());
    for (std::size_t i = 0; i < std::min<std::size_t>(broken.size(), 5); ++i) {
      const TrackSummary& t = stack.tracks[static_cast<std::size_t>(broken[i])];
      text += fmt::format("{} {} (frames {} to {})", i == 0 ? ": track" : ",", broken[i], t.first, t.last);
    }
    text += broken.size() > 5 ? ", ...\n" : "\n";
  }
  return text;
}

void run(TrackOptions& o, const Common& common) {
  // Settings: cell, phases, bead diameters.
  CellDescription cell = resolve_cell(o);
  if (!cell.included.overridden.empty())
    note(common, fmt::format("values in {} take precedence over those measured in {}: {}", o.cell_file,
                             cell.included.file.string(), fmt::join(cell.included.overridden, ", ")));
  PhaseSource source = phase_source(o.phase, cell, o.cell_file);
  source.trusted = o.trust_stated_drive;
  (void)cell.drive();  // refuse a contradictory drive before the work starts
  const LocatorOptions locator =
      locator_of(o.locating, cell.pixels_per_sigma,
                 o.cell_file.empty() ? std::nullopt : std::optional<bool>(cell.bright));
  const FrameRange range = frames_of(o.locating);
  cell.phase_lock = lock_of_chosen(cell.phase_lock, range);
  const Region region = region_of(o.locating);
  // Locate and link all frames.
  const auto frames = open_for_locating(o.stack, o.locating, locator, common);
  const std::filesystem::path parent = std::filesystem::path(o.output).parent_path();
  const std::filesystem::path folder = parent.empty() ? "." : parent;
  ProgressBar bar(common, "track");
  const TrackedStack stack =
      track_stack(*frames, locator, o.link, cell, common.n_threads(), bar, source, folder, region);
  check_locating(o.locating, stack.locator.preprocess.bright);
  if (!stack.phases.warning.empty()) note(common, stack.phases.warning + ".");
  TrackPlan plan = plan_trajectory(stack, cell, stack.locator.diameter_px, o.shortest);
  // Check the stated drive against the motion of the plate, or of the bed if the plate is not visible.
  DriveCheck check{.not_comparable = "the stated drive is trusted"};
  if (!o.trust_stated_drive && plan.info.drive) {
    ProgressBar edge(common, "the plate's edge");
    check = check_by_plate(cell, o.stack, common.n_threads(), edge);
    if (check.by.empty() && cell.pixels_per_sigma) {
      BedSteps bed(plan.info);
      write_trajectory(stack, plan, bed);
      check = check_by_bed(bed, plan.info, check.frame_rate_hz);
    }
    if (!check.disagreement.empty())
      note(common,
           "the stated drive does not fit the film: " + check.disagreement + " (--trust-stated-drive).");
  }
  if (plan.info.drive) record(check, plan.info);
  // Write the trajectory, then the table.
  Provenance provenance = common.provenance();
  provenance.config = cell.text;
  provenance.inputs.push_back(file_of_stack(o.stack));
  for (const std::string& file : {o.locating.mask, o.locating.background})
    if (!file.empty()) provenance.inputs.emplace_back(file);
  plan.info.provenance_json = provenance.to_json();
  H5mdWriter writer(o.output, plan.info);
  write_trajectory(stack, plan, writer);
  writer.finish();
  if (!o.csv.empty()) write_csv(o.csv, stack, range);

  if (!cell.pixels_per_sigma)
    note(common, fmt::format("no scale was given: sigma is the bead diameter of {:.3f} px.",
                             stack.locator.diameter_px));
  if (!plan.info.columns.plate_height)
    note(common,
         "the drive or the frames per cycle are unknown: time is the frame number, and the height of the "
         "plate is absent.");
  // Result.
  std::int64_t beads = 0;
  for (const TrackSummary& t : stack.tracks) beads += t.seen;
  nlohmann::json document = {{"stack", o.stack},
                             {"output", o.output},
                             {"frames", stack.frames.size()},
                             {"beads_located", beads},
                             {"tracks", stack.n_tracks},
                             {"slots", plan.info.n_beads},
                             {"outside_cell", stack.outside_cell},
                             {"wrong_radius", stack.wrong_radius}};
  document.update(nlohmann::json::parse(plan.info.tracking_json));
  if (const nlohmann::json said = restrictions(o.locating); !said.is_null()) document["restrictions"] = said;
  std::string text = fmt::format(
      "{} frames, {} beads located, {} tracks ({} written), {} detections outside the cell left out\n",
      stack.frames.size(), beads, stack.n_tracks, plan.info.n_beads, stack.outside_cell);
  if (constexpr double kMany = 0.02;
      static_cast<double>(stack.wrong_radius) > kMany * static_cast<double>(beads))
    text += fmt::format(
        "{} candidates were left out as discs of another size; to locate beads of several sizes, use "
        "--diameter D1 D2 ...\n",
        stack.wrong_radius);
  text += describe(stack);
  if (!o.truth.empty()) {
    const Score s = score_against(o, stack, range);
    document["truth"] = {{"recall", s.recall()},
                         {"precision", s.precision()},
                         {"rms_px", s.rms},
                         {"links", s.links},
                         {"wrong_links", s.wrong_links}};
    text += fmt::format(
        "against the truth: recall {:.4f}, precision {:.4f}, rms {:.4f} px, {} links of which {} wrong\n",
        s.recall(), s.precision(), s.rms, s.links, s.wrong_links);
  }
  print_result(common, document, text);
}

}  // namespace

void add_track(CLI::App& program, Common& common) {
  auto o = std::make_shared<TrackOptions>();
  CLI::App& verb = add_verb(program, common, "track",
                            "Locate the beads in every frame of a stack, determine the drive phases, and "
                            "link the beads into tracks. Writes a trajectory.",
                            "twincell track frames/ -o exp.h5 --cell CELL.toml");
  verb.add_option("stack", o->stack,
                  "Stack: folder of pictures, TIFF, camera file, HDF5 stack or video (docs/frames.md)")
      ->required();
  writes(common, verb,
         verb.add_option("-o,--output", o->output, "Trajectory file to write (H5MD)")->required(),
         Product::trajectory());
  verb.add_option("--cell", o->cell_file, "CELL.toml with scale, origin, size and drive of the cell");
  verb.add_option("--pixels-per-sigma", o->pixels_per_sigma,
                  "Camera pixels per bead diameter; default: the scale in CELL.toml, otherwise the located "
                  "bead diameter")
      ->check(CLI::PositiveNumber);
  verb.add_option("--origin-px", o->origin,
                  "Lower left inside corner of the cell, with the plate at its mean height: x y, px")
      ->expected(2);
  verb.add_option("--set", o->assignments,
                  "Set a key of CELL.toml, as section.key=value (cell.width_mm=40); overrides the file; may "
                  "be repeated")
      ->take_all();
  verb.add_option("--cell-width", o->width,
                  "Distance of the side walls, sigma; if CELL.toml has a [scale], use --set "
                  "cell.width_sigma= or cell.width_mm= instead")
      ->check(CLI::PositiveNumber);
  verb.add_option("--cell-height", o->height,
                  "Height of the cell, sigma; if CELL.toml has a [scale], use --set with a unit instead")
      ->check(CLI::PositiveNumber);
  verb.add_option("--frames-per-cycle", o->frames_per_cycle,
                  "Frames per drive cycle; 0: not phase-locked; default: the value in CELL.toml")
      ->check(CLI::NonNegativeNumber);
  add_phase_flags(verb, o->phase);
  verb.add_option("--first-phase", o->first_phase,
                  "Phase of the first frame, 0 to frames per cycle - 1; default: the value in CELL.toml")
      ->check(CLI::NonNegativeNumber);
  verb.add_option("--drive-gamma", o->gamma, "Drive strength Gamma = A omega^2/g; with --drive-amplitude");
  verb.add_option("--drive-amplitude", o->amplitude,
                  "Amplitude A of the drive, sigma; if CELL.toml has a [scale], use --set "
                  "drive.amplitude_sigma= or drive.amplitude_mm= instead");
  add_locating_flags(verb, o->locating);
  verb.add_option("--range", o->link.range_diameters,
                  "Largest distance of a bead from its predicted position, bead diameters, above 0, at most "
                  "10; default: 2");
  verb.add_option("--memory", o->link.memory,
                  "Number of frames for which a bead may be missing, 0 to 1000; default: 3");
  verb.add_flag("--trust-stated-drive", o->trust_stated_drive,
                "Do not check the stated drive and frames per cycle against the motion of the plate or the "
                "bed in the frames");
  verb.add_option("--shortest", o->shortest,
                  "Smallest number of frames in which a track must be seen to be written; default: 1")
      ->check(CLI::PositiveNumber);
  writes(common, verb,
         verb.add_option("--csv", o->csv, "Table of tracks to write (CSV, trackpy's columns and more)"),
         Product::table(kHeading));
  verb.add_option("--truth", o->truth,
                  "Score the result against the ground truth: truth.csv, or a folder of truth_NN.csv");
  verb.add_option("--scored-rows", o->scored_rows,
                  "First and last row of pixels that is scored, px; default: all rows")
      ->expected(2);
  verb.callback([o, &common] { run(*o, common); });
}

}  // namespace twincell::cli
