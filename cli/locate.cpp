// twincell locate STACK: locates the beads in every frame and writes a table with trackpy's columns.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>

#include "cli/locate_view.hpp"
#include "cli/located_frames.hpp"
#include "cli/locating_options.hpp"
#include "cli/number_checks.hpp"
#include "cli/output.hpp"
#include "cli/settings_table.hpp"
#include "cli/stack_info.hpp"
#include "cli/truth_options.hpp"
#include "cli/verb.hpp"
#include "core/error.hpp"
#include "core/plural.hpp"
#include "imaging/benchmark/score.hpp"
#include "imaging/preprocess/open_flattened.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/stack/repeated_frames.hpp"
#include "imaging/track/debug_pictures.hpp"
#include "imaging/track/locate_stack.hpp"
#include "imaging/track/overlay.hpp"

namespace twincell::cli {

namespace {

struct LocateOptions {
  std::string stack, output, overlay, view, candidates, debug_folder;
  TruthOptions truth;
  std::int64_t overlay_frame = -1;  // -1: the first that is read
  bool explain = false;
  imaging::LocatingRequest locating;
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Refuses options that have no effect or contradict each other, before the work.
void check(const LocateOptions& o) {
  const std::string ending = std::filesystem::path(o.view).extension();
  for (const char* other : {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".pdf", ".csv", ".json"})
    if (ending == other)
      throw ConfigError(Where{.file = {}, .key = "--view"},
                        fmt::format("writes a page, .html, not {}; --overlay writes a picture.", other));
  if (o.overlay_frame >= 0 && o.overlay.empty() && o.debug_folder.empty())
    throw ConfigError(Where{.file = {}, .key = "--frame"},
                      "names the frame of --overlay or --debug-dir, but neither is given.");
}

/// STACK.beads.csv. The name of a folder can end with a slash, and then has an empty file name.
std::string default_output(const std::string& stack) {
  std::filesystem::path path(stack);
  if (path.filename().empty()) path = path.parent_path();
  return path.stem().string() + ".beads.csv";
}

LocatedFrames tables_and_score(const LocateOptions& o) {
  std::optional<TruthOfFrames> truth;
  if (!o.truth.file.empty()) truth = imaging::read_truth(o.truth.file);
  return {o.output, o.candidates, std::move(truth), o.truth.rows()};
}

/// Finds the settings that were not given. With --explain, those of a picture that is refused are printed.
imaging::LocatorConfiguration find_settings(imaging::FramesAhead& frames,
                                            const imaging::LocatorOptions& given, const LocateOptions& o,
                                            const Common& common) {
  try {
    return imaging::configure_locator(frames, given, common.n_threads());
  } catch (const imaging::NoDiscs& refusal) {
    const std::string& refine = given.refine.method;
    if (o.explain)
      print_result(common,
                   {{"stack", o.stack}, {"settings_tried", settings_as_json(refusal.choice(), refine)}},
                   settings_table(refusal.choice(), refine));
    throw;
  }
}

/// The overlay and the pictures of the stages, which show one frame.
class PicturesOfOneFrame {
 public:
  /// \param frame its number in the stack
  PicturesOfOneFrame(const LocateOptions& o, std::int64_t frame) : o_(o), frame_(frame) {}

  /// \param located in px of `grey`
  void add(std::int64_t frame, const cv::Mat& grey, const imaging::Located& located,
           const imaging::LocatorOptions& locator) {
    if (frame != frame_) return;
    if (!o_.overlay.empty()) imaging::write_overlay(o_.overlay, grey, located.beads);
    if (!o_.debug_folder.empty()) imaging::write_debug_pictures(o_.debug_folder, grey, locator);
    drawn_ = true;
  }
  /// \throws ConfigError if the frame is beyond `announced` frames; 0: their number is not known
  void require_below(std::int64_t announced) const {
    if (o_.overlay.empty() || announced == 0 || frame_ < announced) return;
    throw ConfigError(
        Where{.file = {}, .key = "--frame"},
        fmt::format("is {}, but the frames that are read end before {}, counted from 0.", frame_, announced));
  }
  /// \throws ConfigError if the frame was not among the `read` ones
  void require_drawn(std::int64_t read) const {
    if (o_.overlay.empty() || drawn_) return;
    throw ConfigError(Where{.file = {}, .key = "--frame"},
                      fmt::format("is {}, but not among the {} frames that are read.", frame_, read));
  }

 private:
  const LocateOptions& o_;
  std::int64_t frame_;
  bool drawn_ = false;
};

void run(LocateOptions& o, const Common& common) {
  if (o.output.empty()) o.output = default_output(o.stack);
  // Inputs are read and outputs opened first, so that errors in them are reported before the work.
  check(o);
  const imaging::LocatorOptions given = imaging::locator_of(o.locating);
  const imaging::Region region = imaging::region_of(o.locating);
  const imaging::FrameRange range = imaging::frames_of(o.locating);
  const auto stack = open_for_locating(o.stack, o.locating, given, common);
  PicturesOfOneFrame pictures(o, o.overlay_frame < 0 ? range.first : o.overlay_frame);
  pictures.require_below(range.number(static_cast<std::int64_t>(stack->announced())));
  LocatedFrames located_frames = tables_and_score(o);

  ProgressBar bar(common, "locate");
  imaging::RegionFrames seen(*stack, region);
  imaging::FramesAhead ahead(seen);
  const imaging::LocatorConfiguration found = find_settings(ahead, given, o, common);
  const imaging::LocatorOptions& locator = found.locator;
  const imaging::SettingsChoice choice = imaging::in_whole_picture(found.choice, region);

  std::optional<LocateView> view;
  if (!o.view.empty()) view.emplace(o.locating, region, locator, choice);
  imaging::RepeatedFrames repeated;
  const std::int64_t n = imaging::locate_stack(
      ahead, locator, common.n_threads(),
      [&](std::int64_t index, const cv::Mat& grey, const imaging::Located& in_region) {
        repeated.add(grey);
        const std::int64_t frame = range.number(index);
        const imaging::Located located = imaging::in_whole_picture(in_region, region);
        located_frames.add(frame, located);
        if (view) view->add(frame, grey, located);
        pictures.add(frame, grey, in_region, locator);
      },
      bar);
  pictures.require_drawn(n);
  imaging::check_flat(o.locating.flat, locator.preprocess.bright);

  located_frames.commit();
  if (!o.truth.file.empty()) imaging::require_scored(located_frames.score(), o.truth.file);
  if (view) write_text_file(o.view, view->page(o.stack, o.output, n), locate_page());

  const std::int64_t settings_frame = range.number(found.frame);
  const std::string& refine = given.refine.method;
  std::string doubts = located_frames.doubts();
  if (const std::string repeats = imaging::repeats_in_words(repeated.repeats(), range); !repeats.empty())
    doubts += repeats + "\n";
  const std::string of_settings = settings_warnings(choice, refine);
  nlohmann::json document = located_frames.document();
  document.update({{"stack", o.stack}, {"output", o.output}, {"warnings", lines_of(of_settings + doubts)}});
  document.update(found_settings_as_json(given, locator, settings_frame));
  if (!choice.tried.empty()) document["settings_tried"] = settings_as_json(choice, refine);
  if (view) document["view"] = o.view;
  if (nlohmann::json used = imaging::restrictions(o.locating); !used.is_null())
    document["restrictions"] = std::move(used);

  std::string text = fmt::format("{}, {}{}\n", plural(n, "frame"), plural(located_frames.beads(), "bead"),
                                 common.verbose ? "" : "; -v prints each frame");
  if (common.verbose) text += located_frames.lines();
  text += located_frames.unproven_motion();
  text += found_settings_text(given, locator, settings_frame,
                              o.explain ? settings_table(choice, refine) : of_settings);
  if (refine != locator.refine.method) text += located_frames.overlaps();
  text += doubts + o.output + "\n";
  if (view) text += o.view + "\n";
  print_result(common, document, text + located_frames.score_text());
}

}  // namespace

void add_locate(CLI::App& program, Common& common) {
  auto o = std::make_shared<LocateOptions>();
  CLI::App& verb = add_verb(program, common, "locate",
                            "Locate the beads in every frame of a stack. Writes a table of positions, radii "
                            "and uncertainties (CSV, trackpy's columns).",
                            "twincell locate frames/ -o beads.csv --overlay first.png");
  has_details(verb, "beads, edge blur and time of every frame");
  verb.add_option("stack", o->stack,
                  "Stack: folder of pictures, TIFF, camera file, HDF5 stack or video (docs/frames.md)")
      ->required();
  writes(common, verb,
         verb.add_option("-o,--output", o->output,
                         "Table of beads to write (CSV, trackpy's columns); default: STACK.beads.csv"),
         table_of_beads());
  writes(common, verb,
         verb.add_option(
             "--candidates", o->candidates,
             "Table of every candidate in every frame to write (CSV), with the reason why it was dropped"),
         table_of_candidates());
  writes(common, verb,
         verb.add_option("--debug-dir", o->debug_folder,
                         "Folder for pictures of the result of each stage in the frame --frame"),
         imaging::debug_folder());
  writes(common, verb,
         verb.add_option("--overlay", o->overlay,
                         "Picture of the frame --frame to write (PNG), with its beads marked"),
         Product::picture());
  writes(
      common, verb,
      verb.add_option("--view", o->view,
                      fmt::format("Page to write (HTML), which opens offline: the first {} frames with found "
                                  "beads and dropped candidates, and what other settings would keep",
                                  LocateView::kMaxFrames)),
      locate_page());
  former_option(verb, "--overlay-frame", "--frame");
  verb.add_option(
          "--frame", o->overlay_frame,
          "Number of the frame for --overlay and --debug-dir, from 0; default: the first that is read")
      ->check(zero_or_above());
  add_locating_options(verb, o->locating);
  verb.add_flag(
      "--explain", o->explain,
      "Print all settings that were tried, the evidence of the picture for each, and by how much the "
      "chosen ones won");
  add_truth_options(verb, o->truth);
  verb.callback([o, &common] { run(*o, common); });
}

}  // namespace twincell::cli
