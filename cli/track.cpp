// twincell track STACK: locates the beads, determines the drive phases, links the beads, and writes a
// trajectory.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <memory>
#include <optional>
#include <utility>

#include "calibration/film/track_film.hpp"
#include "cli/cell_notes.hpp"
#include "cli/locating_options.hpp"
#include "cli/named_columns.hpp"
#include "cli/number_checks.hpp"
#include "cli/output.hpp"
#include "cli/phase_options.hpp"
#include "cli/profile.hpp"
#include "cli/truth_options.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/plural.hpp"
#include "core/table.hpp"
#include "imaging/benchmark/score.hpp"
#include "imaging/stack/open_frames.hpp"
#include "imaging/track/bed_in_cell.hpp"
#include "imaging/track/write_trajectory.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::cli {

namespace {

struct TrackOptions {
  std::string stack, output, csv;
  TruthOptions truth;
  calibration::FilmOptions film;
  std::vector<std::string> columns;  ///< of a table, QUANTITY=NAME
  std::vector<int> picture;          ///< width and height, px, of the frames of a table
  bool profile = false;
};

constexpr const char* kHeading = "y,x,frame,particle,radius,tracer,phase,cycle,sigma_y,sigma_x,ambiguous\n";

void write_csv(const std::string& path, const imaging::TrackedStack& stack,
               const imaging::FrameRange& range) {
  AtomicPath file(path, Product::table(kHeading));
  {
    std::ofstream out(file.part());
    out << kHeading;
    for (std::size_t f = 0; f < stack.frames.size(); ++f) {
      const imaging::FramePhase at = stack.phases.at(static_cast<std::int64_t>(f));
      for (const imaging::TrackedBead& b : stack.frames[f])
        out << fmt::format("{:.4f},{:.4f},{},{},{:.4f},{},{},{},{:.4f},{:.4f},{}\n", b.y_px, b.x_px,
                           range.number(static_cast<std::int64_t>(f)), b.track, b.radius_px, b.tracer ? 1 : 0,
                           at.phase, at.cycle, b.sigma_y_px, b.sigma_x_px, b.ambiguous ? 1 : 0);
    }
    if (!out.flush()) throw RunError(path + ": writing the table failed.");
  }
  file.commit();
}

imaging::Score score_against(const TrackOptions& o, const imaging::TrackedStack& stack,
                             const imaging::FrameRange& range) {
  const auto truth = imaging::read_truth(o.truth.file);
  imaging::Scorer scorer(o.truth.rows());
  for (std::size_t f = 0; f < stack.frames.size(); ++f) {
    const auto number = static_cast<std::size_t>(range.number(static_cast<std::int64_t>(f)));
    if (number >= truth.size()) break;
    std::vector<imaging::FoundBead> found;
    for (const imaging::TrackedBead& b : stack.frames[f]) found.push_back({b.x_px, b.y_px, b.track});
    scorer.add(truth[number], found);
  }
  const imaging::Score score = scorer.score();
  imaging::require_scored(score, o.truth.file);
  return score;
}

// The printed summary of the phases, the links and the tracers.
std::string describe(const imaging::TrackedStack& stack) {
  std::string text = phases_in_words(stack.phases);
  const imaging::LinkReport& l = stack.links;
  text += fmt::format(
      "links: {} made, {} bridge a gap, {} ambiguous; {} births, {} losses; largest sub-network {}; {} "
      "frames matched again, all beads at once\n",
      l.links, l.bridged, l.ambiguous, l.births, l.losses, l.largest_network, l.rematched);
  if (l.unsolved > 0)
    text += fmt::format(
        "frames too crowded for an exact solution: {} beads were linked to their nearest free detection\n",
        l.unsolved);
  std::int64_t tracers = 0, uncertain = 0;
  for (const imaging::TrackSummary& t : stack.tracks) {
    tracers += t.is_tracer() ? 1 : 0;
    uncertain += t.is_tracer() && t.ambiguous > 0 ? 1 : 0;
  }
  if (tracers > 0) {
    const auto broken = stack.broken_tracers();
    text += fmt::format(
        "tracers: {} tracks, {} of them with ambiguous links, {} not from the first frame to the last",
        tracers, uncertain, broken.size());
    for (std::size_t i = 0; i < std::min<std::size_t>(broken.size(), 5); ++i) {
      const imaging::TrackSummary& t = stack.tracks[static_cast<std::size_t>(broken[i])];
      text += fmt::format("{} {} (frames {} to {})", i == 0 ? ": track" : ",", broken[i], t.first, t.last);
    }
    text += broken.size() > 5 ? ", ...\n" : "\n";
  }
  return text;
}

/// What is missing for times and heights of the plate, and what gives it.
std::string unknown_in_words(const imaging::PhaseTable& phases, const imaging::PhaseRequest& request) {
  if (phases.locked()) return "the drive is not stated (two keys of [drive], such as gamma and amplitude)";
  if (request.phase_lock == "none") return "--phase-lock none leaves out the phases";
  return "the frames per cycle are not stated, so that no frame has a phase; give them (--phase-lock N, or "
         "camera.frames_per_cycle), or let the plate or the bed show them (--phase-lock found), or, if the "
         "period is not a whole number of frames, list them (twincell calibrate plate --phases LIST.csv, "
         "then "
         "--phase-lock LIST.csv)";
}

/// Links the beads of a table, or locates the beads of the frames and links them.
calibration::TrackedFilm track(const TrackOptions& o, const Common& common, StageTimes* times) {
  calibration::FilmOptions film = o.film;
  const std::filesystem::path parent = std::filesystem::path(o.output).parent_path();
  film.folder = parent.empty() ? "." : parent;
  film.threads = common.n_threads();
  if (imaging::is_located_table(o.stack)) {
    imaging::LocatedTableOptions table{.columns = named_columns(o.columns)};
    if (!o.picture.empty()) table.picture = {o.picture[0], o.picture[1]};
    return calibration::track_table(read_table(o.stack), std::move(table), film, progress_bars(common),
                                    times);
  }
  const auto open = [&](const imaging::LocatorOptions& locator) {
    return open_for_locating(o.stack, film.locating, locator, common);
  };
  return calibration::track_film(open, o.stack, film, progress_bars(common), times);
}

/// Prints what the film contradicts or leaves open.
void print_doubts(const TrackOptions& o, const calibration::TrackedFilm& film,
                  const imaging::FrameRange& range, const Common& common) {
  const imaging::CellDescription& cell = film.cell;
  const imaging::TrackedStack& stack = film.stack;
  note_cell(common, cell, o.film.request.cell_file);
  if (!stack.spacing_doubt.empty()) note(common, stack.spacing_doubt);
  if (imaging::is_located_table(o.stack) && range.first > 0 && stack.phases.locked())
    note(common,
         fmt::format("the first frame of {} has the number {}; its phase is {}, as frames count from 0 and "
                     "--first-phase is that of frame 0.",
                     o.stack, range.first, stack.phases.at(0).phase));
  if (!film.check.disagreement.empty())
    note(common,
         "the stated drive does not fit the film: " + film.check.disagreement + " (--trust-stated-drive).");
  for (const std::string& doubt : stack.doubts(cell)) note(common, doubt);
}

/// Writes the trajectory, then the table.
void write_tracks(const TrackOptions& o, calibration::TrackedFilm& film, const imaging::FrameRange& range,
                  const Common& common, StageTimes* times) {
  Provenance provenance = common.provenance();
  provenance.config = film.cell.text;
  provenance.inputs.push_back(imaging::file_of_stack(o.stack));
  for (const std::string& file : {o.film.locating.mask, o.film.locating.background})
    if (!file.empty()) provenance.inputs.emplace_back(file);
  TrajectoryInfo& info = film.plan.info;
  info.provenance_json = provenance.to_json();
  Stage writing(times, "writing", "frames");
  H5mdWriter writer(o.output, info);
  imaging::BedInCell watched(writer, info, film.cell, film.stack.width_px, film.stack.height_px);
  imaging::write_trajectory(film.stack, film.plan, watched);
  writer.finish();
  if (const std::string left_out = film.plan.in_plate_note(); !left_out.empty()) note(common, left_out);
  for (const std::string& doubt : watched.doubts()) note(common, doubt);
  if (!o.csv.empty()) write_csv(o.csv, film.stack, range);
  writing.count(static_cast<double>(film.stack.frames.size()));
}

/// The result, as a document and as text.
std::pair<nlohmann::json, std::string> summary(const TrackOptions& o, const calibration::TrackedFilm& film) {
  const imaging::TrackedStack& stack = film.stack;
  const TrajectoryInfo& info = film.plan.info;
  std::int64_t beads = 0;
  for (const imaging::TrackSummary& t : stack.tracks) beads += t.seen;
  nlohmann::json document = {{"stack", o.stack},
                             {"output", o.output},
                             {"frames", stack.frames.size()},
                             {"beads_located", beads},
                             {"tracks", stack.n_tracks},
                             {"slots", info.n_beads},
                             {"outside_cell", stack.outside_cell},
                             {"wrong_radius", stack.wrong_radius},
                             {"paler", stack.paler}};
  if (stack.aspect)
    document["aspect"] = {{"value", stack.aspect->ratio}, {"standard_error", stack.aspect->error}};
  document.update(film.report());
  if (const nlohmann::json said = imaging::restrictions(o.film.locating); !said.is_null())
    document["restrictions"] = said;
  std::string text =
      fmt::format("{}, {} located, {} ({} written), {} outside the cell left out\n",
                  plural(stack.frames.size(), "frame"), plural(beads, "bead"),
                  plural(stack.n_tracks, "track"), info.n_beads, plural(stack.outside_cell, "detection"));
  if (constexpr double kMany = 0.02;
      static_cast<double>(stack.wrong_radius) > kMany * static_cast<double>(beads))
    text += fmt::format(
        "{} candidates were left out as discs of another size; to locate beads of several sizes, use "
        "--diameter D1 D2 ...\n",
        stack.wrong_radius);
  return {std::move(document), text + describe(stack)};
}

void run(const TrackOptions& o, const Common& common) {
  Profile profile(o.profile);
  (void)imaging::Scorer(o.truth.rows());  // refuse rows in the wrong order before the work
  const bool of_table = imaging::is_located_table(o.stack);
  for (const auto& [given, option] :
       {std::pair(!o.columns.empty(), "--columns"), {!o.picture.empty(), "--picture-size"}})
    if (given && !of_table)
      throw ConfigError({.file = {}, .key = option}, "applies to a table of located beads (.csv).");

  calibration::TrackedFilm film = track(o, common, profile.times());
  const imaging::FrameRange range = of_table ? film.stack.range : imaging::frames_of(o.film.locating);
  print_doubts(o, film, range, common);
  write_tracks(o, film, range, common, profile.times());
  if (!film.cell.pixels_per_sigma)
    note(common, fmt::format("no scale was given: sigma is the bead diameter of {:.3f} px.",
                             film.stack.locator.diameter_px));
  if (!film.plan.info.columns.plate_height)
    note(common, unknown_in_words(film.stack.phases, o.film.request.phase) +
                     ": time is the frame number, and the height of the plate is absent.");

  auto [document, text] = summary(o, film);
  if (!o.truth.file.empty()) {
    const imaging::Score s = score_against(o, film.stack, range);
    document["truth"] = {{"recall", s.recall()},
                         {"precision", s.precision()},
                         {"rms_px", s.rms},
                         {"links", s.links},
                         {"wrong_links", s.wrong_links}};
    text += fmt::format(
        "against the truth: recall {:.4f}, precision {:.4f}, rms {:.4f} px, {} links of which {} wrong\n",
        s.recall(), s.precision(), s.rms, s.links, s.wrong_links);
  }
  profile.add_to(document, text, common.n_threads());
  print_result(common, document, text);
}

}  // namespace

void add_track(CLI::App& program, Common& common) {
  auto o = std::make_shared<TrackOptions>();
  CLI::App& verb = add_verb(program, common, "track",
                            "Locate the beads in every frame of a stack, determine the drive phases, and "
                            "link the beads into tracks. Writes a trajectory.",
                            "twincell track frames/ -o exp.h5 --cell CELL.toml");
  verb.add_option(
          "stack", o->stack,
          "Stack: folder of pictures, TIFF, camera file, HDF5 stack or video (docs/frames.md); or a table of "
          "located beads (.csv) with columns frame, x, y (docs/tracking.md)")
      ->required();
  writes(common, verb,
         verb.add_option("-o,--output", o->output, "Trajectory file to write (H5MD)")->required(),
         Product::trajectory(word_of(Origin::experiment)));
  auto heading = std::make_unique<OptionHeading>(verb, "Cell and drive");
  verb.add_option("--cell", o->film.request.cell_file,
                  "CELL.toml with scale, origin, size and drive of the cell");
  verb.add_option("--pixels-per-sigma", o->film.request.pixels_per_sigma,
                  "Camera pixels per bead diameter; default: the scale in CELL.toml, otherwise the located "
                  "bead diameter")
      ->check(above_zero());
  verb.add_option("--origin-px", o->film.request.origin,
                  "Lower left inside corner of the cell, with the plate at its mean height: x y, px")
      ->type_name("FLOAT x 2");
  verb.add_option("--set", o->film.request.assignments,
                  "Set a key of CELL.toml, as section.key=value (cell.width_mm=40); overrides the file; may "
                  "be repeated")
      ->take_all();
  verb.add_option("--cell-width", o->film.request.width,
                  "Distance of the side walls, sigma; if CELL.toml has a [scale], use --set "
                  "cell.width_sigma= or cell.width_mm= instead")
      ->check(above_zero());
  verb.add_option("--cell-height", o->film.request.height,
                  "Height of the cell, sigma; if CELL.toml has a [scale], use --set with a unit instead")
      ->check(above_zero());
  verb.add_option("--frames-per-cycle", o->film.request.frames_per_cycle,
                  "Frames per drive cycle; 0: not phase-locked; default: the value in CELL.toml")
      ->check(CLI::Range(0, 100000));
  add_phase_options(verb, o->film.request.phase);
  verb.add_option("--first-phase", o->film.request.first_phase,
                  "Phase of the first frame, 0 to frames per cycle - 1; default: the value in CELL.toml")
      ->check(zero_or_above());
  verb.add_option("--drive-gamma", o->film.request.gamma,
                  "Drive strength Gamma = A omega^2/g; with --drive-amplitude");
  verb.add_option("--drive-amplitude", o->film.request.amplitude,
                  "Amplitude A of the drive, sigma; if CELL.toml has a [scale], use --set "
                  "drive.amplitude_sigma= or drive.amplitude_mm= instead");
  heading.reset();
  add_locating_options(verb, o->film.locating);
  heading = std::make_unique<OptionHeading>(verb, "Linking");
  verb.add_option("--range", o->film.link.range_diameters,
                  "Largest distance of a bead from its predicted position, bead diameters, above 0, at most "
                  "10; default: 2");
  verb.add_option("--memory", o->film.link.memory,
                  "Number of frames for which a bead may be missing, 0 to 1000; default: 3");
  verb.add_flag("--trust-stated-drive", o->film.trust_stated_drive,
                "Do not check the stated drive and frames per cycle against the motion of the plate or the "
                "bed in the frames");
  verb.add_option("--shortest", o->film.shortest,
                  "Smallest number of frames in which a track must be seen to be written; default: 1")
      ->check(above_zero());
  heading.reset();
  writes(common, verb,
         verb.add_option("--csv", o->csv, "Table of tracks to write (CSV, trackpy's columns and more)"),
         Product::table(kHeading));
  heading = std::make_unique<OptionHeading>(verb, "A table of located beads in place of frames");
  verb.add_option(
          "--columns", o->columns,
          "Of a table: column names that differ from the defaults, as QUANTITY=NAME: frame, x, y, radius, "
          "diameter, sigma_x, sigma_y, tracer")
      ->option_text("QUANTITY=NAME ...");
  verb.add_option(
          "--picture-size", o->picture,
          "Of a table: width and height of the frames, px; needed with rotation or distortion of the camera")
      ->expected(2)
      ->delimiter(',')
      ->check(CLI::Range(1, 100000));
  heading.reset();
  add_truth_options(verb, o->truth);
  add_profile_option(verb, o->profile);
  verb.callback([o, &common] { run(*o, common); });
}

}  // namespace twincell::cli
