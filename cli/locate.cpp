// twincell locate STACK: locates the beads in every frame and writes a table with trackpy's columns.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <sstream>

#include "cli/locate_view.hpp"
#include "cli/locating_options.hpp"
#include "cli/numbers.hpp"
#include "cli/output.hpp"
#include "cli/settings_table.hpp"
#include "cli/stack_info.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/counted.hpp"
#include "core/error.hpp"
#include "imaging/benchmark/score.hpp"
#include "imaging/disc/position_error.hpp"
#include "imaging/preprocess/open_flattened.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/track/debug_pictures.hpp"
#include "imaging/track/locate_stack.hpp"
#include "imaging/track/motion_in_exposure.hpp"
#include "imaging/track/overlay.hpp"

namespace twincell::cli {

namespace {

struct LocateOptions {
  std::string stack, output, overlay, view, truth, candidates, debug_folder;
  std::vector<double> scored_rows;
  std::int64_t overlay_frame = -1;  // -1: the first that is read
  bool explain = false;
  imaging::LocatingRequest locating;
};

// Headings of the tables. kHeading has trackpy's columns in trackpy's order, then the additional columns.
constexpr const char* kCandidateHeading = "frame,x,y,radius,darkness,interior,score,ring_share,verdict\n";
constexpr const char* kHeading =
    "y,x,mass,size,ecc,signal,raw_mass,ep,frame,radius,sigma_x,sigma_y,sigma_radius,score,tracer,edge\n";

std::string row(const imaging::Detection& b, std::int64_t frame) {
  const double ep = imaging::position_error(b);
  return fmt::format(
      "{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.2f},{:.5f},{},{:.4f},{:.5f},{:.5f},{:.5f},{:.4f},{},{}\n",
      b.y, b.x, b.mass, b.size, b.ecc, b.signal, b.raw_mass, ep, frame, b.radius, b.sigma_x, b.sigma_y,
      b.sigma_radius, b.score, b.tracer ? 1 : 0, b.edge ? 1 : 0);
}

nlohmann::json as_json(const imaging::Score& s) {
  return {{"recall", s.recall()},      {"precision", s.precision()},  {"rms_px", s.rms},
          {"rms_sure_px", s.rms_sure}, {"bias_x_px", s.bias_x},       {"bias_y_px", s.bias_y},
          {"truths", s.truths},        {"false_finds", s.false_finds}};
}

std::string candidate_row(const imaging::Detection& b, std::int64_t frame) {
  return fmt::format("{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{}\n", frame, b.x, b.y, b.radius,
                     b.darkness, b.interior, b.score, b.ring_share, imaging::word_of(b.verdict));
}

/// A table that appears complete or not at all. If the name is empty, nothing is written.
class TableFile {
 public:
  TableFile(const std::string& name, const char* heading) : name_(name) {
    if (name.empty()) return;
    path_.emplace(name, Product::table(heading));
    out_.open(path_->part());
    out_ << heading;
  }
  TableFile& operator<<(const std::string& text) {
    if (path_) out_ << text;
    return *this;
  }
  void commit() {
    if (!path_) return;
    out_.close();
    if (!out_) throw RunError(name_ + ": cannot be written.");
    path_->commit();
  }

 private:
  std::string name_;
  std::optional<AtomicPath> path_;
  std::ofstream out_;
};

nlohmann::json in_words(const std::map<imaging::Verdict, std::size_t>& counts) {
  nlohmann::json words = nlohmann::json::object();
  for (const auto& [why, count] : counts) words[std::string(imaging::word_of(why))] = count;
  return words;
}

/// Warnings about the table: frames without beads, and candidates that were left out if they are many. Empty
/// if there is no reason for doubt.
std::string doubts(const std::map<imaging::Verdict, std::size_t>& left_out, std::size_t beads,
                   std::size_t bare, std::size_t frames) {
  constexpr double kMany = 0.02;  // of the beads
  std::string text;
  if (bare > 0) text += fmt::format("no bead in {} of {} frames\n", bare, frames);
  std::size_t all = 0, wrong_radius = 0;
  std::string reasons;
  for (const auto& [why, count] : left_out) {
    if (why == imaging::Verdict::outside || why == imaging::Verdict::in_wall) continue;  // not visible beads
    if (why == imaging::Verdict::wrong_radius) wrong_radius = count;
    all += count;
    reasons += fmt::format("{}{} {}", reasons.empty() ? "" : ", ", count, imaging::word_of(why));
  }
  const double many = kMany * static_cast<double>(beads);
  if (static_cast<double>(all) > many)
    text += fmt::format(
        "in addition to {} beads, candidates were left out: {} (--candidates lists them, --overlay shows the "
        "beads)\n",
        beads, reasons);
  if (static_cast<double>(wrong_radius) > many && wrong_radius > 1)
    text += "to locate beads of several sizes, use --diameter D1 D2 ...\n";
  if (all > beads)
    text +=
        "more candidates were left out than beads were found: check --overlay; --diameter with --dark or "
        "--bright may give a better result\n";
  return text;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

void run(LocateOptions& o, const Common& common) {
  // The name of a folder can end with a slash, and then has an empty file name.
  if (o.output.empty()) {
    std::filesystem::path stack(o.stack);
    if (stack.filename().empty()) stack = stack.parent_path();
    o.output = stack.stem().string() + ".beads.csv";
  }
  // Inputs are read and outputs opened first, so that errors in them are reported before the work.
  std::optional<std::vector<std::vector<imaging::TruthBead>>> truth;
  if (!o.truth.empty()) truth = imaging::read_truth(o.truth);
  imaging::ScoredRows rows;
  if (o.scored_rows.size() == 2) rows = {o.scored_rows[0], o.scored_rows[1]};
  imaging::Scorer scorer(rows);

  const imaging::LocatorOptions given = imaging::locator_of(o.locating);
  const imaging::Region region = imaging::region_of(o.locating);
  const imaging::FrameRange range = imaging::frames_of(o.locating);
  const std::string ending = std::filesystem::path(o.view).extension();
  for (const char* other : {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".pdf", ".csv", ".json"})
    if (ending == other)
      throw ConfigError(Where{.file = {}, .key = "--view"},
                        fmt::format("writes a page, .html, not {}; --overlay writes a picture.", other));
  if (o.overlay_frame >= 0 && o.overlay.empty() && o.debug_folder.empty())
    throw ConfigError(Where{.file = {}, .key = "--frame"},
                      "names the frame of --overlay or --debug-dir, but neither is given.");
  if (o.overlay_frame < 0) o.overlay_frame = range.first;
  const auto frames = open_for_locating(o.stack, o.locating, given, common);
  const std::int64_t announced = range.number(static_cast<std::int64_t>(frames->announced()));
  if (!o.overlay.empty() && announced > 0 && o.overlay_frame >= announced)
    throw ConfigError(Where{.file = {}, .key = "--frame"},
                      fmt::format("is {}, but the frames that are read end before {}, counted from 0.",
                                  o.overlay_frame, announced));
  TableFile table(o.output, kHeading);
  TableFile candidates(o.candidates, kCandidateHeading);
  nlohmann::json document = {{"stack", o.stack}, {"output", o.output}, {"frames", nlohmann::json::array()}};
  std::string text;
  bool drawn = false;
  ProgressBar bar(common, "locate");
  const std::string refine = given.refine.method;
  const bool find_diameter = given.diameter_px <= 0, find_polarity = !given.polarity_known;
  std::vector<std::pair<std::string, std::string>> lines;  // of each frame, with --verbose
  std::map<imaging::Verdict, std::size_t> left_out;
  std::size_t beads = 0, bare = 0;  // frames without a bead
  // Settings that the user did not give are determined from the first frames.
  imaging::RegionFrames seen(*frames, region);
  imaging::FramesAhead ahead(seen);
  const auto [locator, settings_index, choice] = [&] {
    try {
      return imaging::configure_locator(ahead, given, common.n_threads());
    } catch (const imaging::NoDiscs& refusal) {
      if (o.explain)
        print_result(common,
                     {{"stack", o.stack}, {"settings_tried", settings_as_json(refusal.choice(), refine)}},
                     settings_table(refusal.choice(), refine));
      throw;
    }
  }();
  const std::int64_t settings_frame = range.number(settings_index);
  std::optional<LocateView> view;
  if (!o.view.empty()) view.emplace(o.locating, region, locator, choice);
  imaging::MotionInExposure motion;
  const std::int64_t n = imaging::locate_stack(
      ahead, locator, common.n_threads(),
      [&](std::int64_t index, const cv::Mat& grey, const imaging::Located& as_located) {
        const std::int64_t frame = range.number(index);
        const imaging::Located located = imaging::in_whole_picture(as_located, region);
        for (const imaging::Detection& b : located.beads) table << row(b, frame);
        for (const std::vector<imaging::Detection>* list : {&located.beads, &located.dropped})
          for (const imaging::Detection& b : *list) candidates << candidate_row(b, frame);
        nlohmann::json f = {{"frame", frame}, {"beads", located.beads.size()}, {"blur_px", located.blur_px}};
        std::string line = fmt::format("frame {}: {}, edge blur {:.2f} px", frame,
                                       counted(located.beads.size(), "bead"), located.blur_px);
        motion.add(located);
        std::string stages;
        for (const imaging::StageReport& stage : located.stages) {
          f["stages"][stage.stage] = {{"ms", 1000 * stage.seconds}, {"beads", stage.beads}};
          stages += fmt::format(" {} {:.1f} ms", stage.stage, 1000 * stage.seconds);
          if (stage.stage != "prepare") stages += fmt::format(" ({})", stage.beads);
        }
        if (common.verbose) lines.emplace_back(line, stages);
        std::map<imaging::Verdict, std::size_t> reasons;
        for (const imaging::Detection& b : located.dropped) ++reasons[b.verdict];
        f["dropped"] = in_words(reasons);
        for (const auto& [why, count] : reasons) left_out[why] += count;
        beads += located.beads.size();
        bare += located.beads.empty() ? 1 : 0;
        document["frames"].push_back(f);
        if (truth && static_cast<std::size_t>(frame) < truth->size()) {
          std::vector<imaging::FoundBead> found;
          for (const imaging::Detection& b : located.beads) found.push_back({b.x, b.y, -1});
          scorer.add((*truth)[static_cast<std::size_t>(frame)], found);
        }
        if (!o.overlay.empty() && frame == o.overlay_frame) {
          imaging::write_overlay(o.overlay, grey, as_located.beads);
          drawn = true;
        }
        if (view) view->add(frame, grey, located);
        if (!o.debug_folder.empty() && frame == o.overlay_frame)
          imaging::write_debug_pictures(o.debug_folder, grey, locator);
      },
      bar);
  if (!o.overlay.empty() && !drawn)
    throw ConfigError(Where{.file = {}, .key = "--frame"},
                      fmt::format("is {}, but not among the {} frames that are read.", o.overlay_frame, n));
  imaging::check_flat(o.locating.flat, locator.preprocess.bright);
  table.commit();
  candidates.commit();
  if (view) {
    document["view"] = o.view;
    write_text_file(o.view, view->page(o.stack, o.output, n), locate_page());
  }
  // Motion during the exposure needs the beads of the next frame, so it is told after all frames.
  for (std::int64_t index = 0; index < n; ++index) {
    const auto at = static_cast<std::size_t>(index);
    if (motion.claimed(at)) document["frames"][at]["path_px"] = motion.path(at);
    if (!common.verbose) continue;
    text += lines[at].first;
    if (motion.claimed(at))
      text += fmt::format(", moved by {:.2f} px during the exposure",
                          std::hypot(motion.path(at)[0], motion.path(at)[1]));
    text += ";" + lines[at].second + "\n";
  }
  if (const std::size_t unproven = motion.unproven(); unproven > 0)
    text += fmt::format(
        "in {} the edges are blurred more along one direction than across it, though {}: no motion is "
        "concluded from it\n",
        counted(unproven, "frame"),
        n == 1 ? "one frame does not show how beads move"
               : "the beads do not move that far from frame to frame");
  if (const nlohmann::json said = imaging::restrictions(o.locating); !said.is_null())
    document["restrictions"] = said;
  // Report the settings that were determined from the frames, with the options that set them.
  document["diameter_px"] = locator.diameter_px;
  if (!locator.other_diameters_px.empty()) document["other_diameters_px"] = locator.other_diameters_px;
  document["refine"] = locator.refine.method;
  document["bright"] = locator.preprocess.bright;
  text = fmt::format("{}, {}{}\n", counted(n, "frame"), counted(beads, "bead"),
                     common.verbose ? "" : "; -v prints each frame") +
         text;
  const std::string shown = settings_frame == 0 ? "the first frame" : fmt::format("frame {}", settings_frame);
  if (find_diameter || find_polarity) document["settings_frame"] = settings_frame;
  if (find_diameter) {
    std::string sizes = fmt::format("{:.2f}", locator.diameter_px);
    for (const double other : locator.other_diameters_px) sizes += fmt::format(" and {:.2f}", other);
    text += fmt::format("bead diameter found from {}: {} px (--diameter)\n", shown, sizes);
  }
  if (!choice.tried.empty()) document["settings_tried"] = settings_as_json(choice, refine);
  const std::string of_settings = settings_warnings(choice, refine);
  text += o.explain ? settings_table(choice, refine) : of_settings;
  if (refine != locator.refine.method && imaging::model_of(locator.refine) == imaging::DiscModel::circle)
    text += fmt::format(
        "the insides of the discs differ in {}: the discs are fitted by their rims (--refine edges)\n",
        shown);
  if (refine != locator.refine.method &&
      imaging::model_of(locator.refine) == imaging::DiscModel::shared_profile)
    text += fmt::format(
        "the discs are alike but not plain in {}: they are fitted by their common profile (--refine "
        "profile)\n",
        shown);
  if (locator.preprocess.contrast < 1 && imaging::model_of(locator.refine) != imaging::DiscModel::circle) {
    document["contrast"] = locator.preprocess.contrast;
    text += fmt::format("beads are pale: darkness is in units of {:.2f} of the light\n",
                        locator.preprocess.contrast);
  }
  if (find_polarity && imaging::model_of(locator.refine) ==
                           imaging::DiscModel::shared_profile)  // they may have rings of both kinds
    text += fmt::format("frames are read as with --{}, which explains {} better (--dark, --bright)\n",
                        locator.preprocess.bright ? "bright" : "dark", shown);
  else if (find_polarity)
    text += fmt::format("beads are {} than the background in {} (--dark, --bright)\n",
                        locator.preprocess.bright ? "brighter" : "darker", shown);
  document["left_out"] = in_words(left_out);
  const std::string warnings = doubts(left_out, beads, bare, static_cast<std::size_t>(n));
  document["warnings"] = lines_of(of_settings + warnings);
  text += warnings;
  text += o.output + "\n";
  if (view) text += o.view + "\n";
  if (truth) {
    const imaging::Score s = scorer.score();
    document["truth"] = as_json(s);
    text += fmt::format(
        "against the truth: recall {:.4f}, precision {:.4f}, rms {:.4f} px per coordinate, bias {:+.4f} "
        "{:+.4f} px\n",
        s.recall(), s.precision(), s.rms, s.bias_x, s.bias_y);
    if (s.sure < s.found)
      text += fmt::format("of the {} beads with the most certain truth: rms {:.4f} px\n", s.sure, s.rms_sure);
  }
  print_result(common, document, text);
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
         Product::table(kHeading));
  writes(common, verb,
         verb.add_option(
             "--candidates", o->candidates,
             "Table of every candidate in every frame to write (CSV), with the reason why it was dropped"),
         Product::table(kCandidateHeading));
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
                                  LocateView::kMostFrames)),
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
  verb.add_option("--truth", o->truth,
                  "Score the result against the ground truth: truth.csv, or a folder of truth_NN.csv");
  verb.add_option("--scored-rows", o->scored_rows,
                  "First and last row of pixels that is scored, px; default: all rows")
      ->expected(2);
  verb.callback([o, &common] { run(*o, common); });
}

}  // namespace twincell::cli
