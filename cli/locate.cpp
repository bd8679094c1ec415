// twincell locate STACK: beads in every frame, in trackpy's columns.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <optional>

#include "analysis/trajectory/atomic_file.hpp"
#include "analysis/trajectory/error.hpp"
#include "cli/output.hpp"
#include "cli/stack_info.hpp"
#include "cli/verb.hpp"
#include "imaging/overlay.hpp"
#include "imaging/pipeline.hpp"
#include "imaging/score.hpp"

namespace twincell::cli {

namespace {

struct LocateOptions {
  std::string stack, output, overlay, truth;
  std::vector<double> scored_rows;
  std::int64_t overlay_frame = 0;
  LocatorOptions locator;
};

// trackpy's columns in trackpy's order, then our own.
constexpr const char* kHeading =
    "y,x,mass,size,ecc,signal,raw_mass,ep,frame,radius,sigma_x,sigma_y,sigma_radius,score,tracer,edge\n";

std::string row(const Detection& b, std::int64_t frame) {
  const double ep = std::sqrt(0.5 * (b.sigma_x * b.sigma_x + b.sigma_y * b.sigma_y));
  return fmt::format(
      "{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.2f},{:.5f},{},{:.4f},{:.5f},{:.5f},{:.5f},{:.4f},{},{}\n",
      b.y, b.x, b.mass, b.size, b.ecc, b.signal, b.raw_mass, ep, frame, b.radius, b.sigma_x, b.sigma_y,
      b.sigma_radius, b.score, b.tracer ? 1 : 0, b.edge ? 1 : 0);
}

nlohmann::json as_json(const Score& s) {
  return {{"recall", s.recall()},        {"precision", s.precision()}, {"rms_px", s.rms},
          {"bias_x_px", s.bias_x},       {"bias_y_px", s.bias_y},      {"truths", s.truths},
          {"false_finds", s.false_finds}};
}

void run(LocateOptions& o, const Common& common) {
  std::optional<std::vector<std::vector<TruthBead>>> truth;
  if (!o.truth.empty()) truth = read_truth(o.truth);
  ScoredRows rows;
  if (o.scored_rows.size() == 2) rows = {o.scored_rows[0], o.scored_rows[1]};
  Scorer scorer(rows);

  const auto frames = open_stack(o.stack, common);
  const auto announced = static_cast<std::int64_t>(frames->announced());
  if (!o.overlay.empty() && announced > 0 && o.overlay_frame >= announced)
    throw ConfigError(Where{.file = {}, .key = "--overlay-frame"},
                      fmt::format("{} was asked for, the stack has {} frames, counted from 0.",
                                  o.overlay_frame, announced));
  AtomicPath table(o.output);
  std::ofstream out(table.part());
  out << kHeading;
  nlohmann::json document = {{"stack", o.stack}, {"output", o.output}, {"frames", nlohmann::json::array()}};
  std::string text;
  bool drawn = false;
  ProgressBar bar(common, "locate");
  const bool estimated = o.locator.diameter_px <= 0;
  const std::int64_t n = locate_stack(
      *frames, o.locator, common.n_threads(),
      [&](std::int64_t frame, const cv::Mat& grey, const Located& located) {
        for (const Detection& b : located.beads) out << row(b, frame);
        nlohmann::json f = {{"frame", frame}, {"beads", located.beads.size()}, {"blur_px", located.blur_px}};
        text += fmt::format("frame {}: {} beads, edge blur {:.2f} px;", frame, located.beads.size(),
                            located.blur_px);
        for (const StageReport& stage : located.stages) {
          f["stages"][stage.stage] = {{"ms", 1000 * stage.seconds}, {"beads", stage.beads}};
          text += fmt::format(" {} {:.1f} ms", stage.stage, 1000 * stage.seconds);
          if (stage.stage != "prepare") text += fmt::format(" ({})", stage.beads);
        }
        text += "\n";
        document["frames"].push_back(f);
        if (truth && static_cast<std::size_t>(frame) < truth->size()) {
          std::vector<FoundBead> found;
          for (const Detection& b : located.beads) found.push_back({b.x, b.y, -1});
          scorer.add((*truth)[static_cast<std::size_t>(frame)], found);
        }
        if (!o.overlay.empty() && frame == o.overlay_frame) {
          write_overlay(o.overlay, grey, located.beads);
          drawn = true;
        }
      },
      bar);
  out.close();
  if (!out) throw RunError(o.output + ": cannot be written.");
  if (!o.overlay.empty() && !drawn)
    throw ConfigError(
        Where{.file = {}, .key = "--overlay-frame"},
        fmt::format("{} was asked for, the stack has {} frames, counted from 0.", o.overlay_frame, n));
  table.commit();
  document["diameter_px"] = o.locator.diameter_px;
  if (estimated)
    text += fmt::format("bead diameter estimated from the first frame: {:.2f} px\n", o.locator.diameter_px);
  if (truth) {
    const Score s = scorer.score();
    document["truth"] = as_json(s);
    text += fmt::format(
        "against the truth: recall {:.4f}, precision {:.4f}, rms {:.4f} px per coordinate, bias {:+.4f} "
        "{:+.4f} px\n",
        s.recall(), s.precision(), s.rms, s.bias_x, s.bias_y);
  }
  print_result(common, document, text);
}

}  // namespace

void add_locate(CLI::App& program, Common& common) {
  auto o = std::make_shared<LocateOptions>();
  CLI::App& verb = add_verb(program, common, "locate", "Beads in every frame of a stack",
                            "twincell locate frames/ -o beads.csv --diameter 15 --overlay first.png");
  verb.add_option("stack", o->stack,
                  "Folder of pictures, TIFF, camera file, HDF5 stack or video (docs/frames.md)")
      ->required();
  verb.add_option("-o,--output", o->output, "Bead table (CSV, trackpy's columns)")->required();
  verb.add_option("--overlay", o->overlay, "PNG of a frame with its beads marked");
  verb.add_option("--overlay-frame", o->overlay_frame, "Which frame, from 0")->check(CLI::NonNegativeNumber);
  verb.add_option("--diameter", o->locator.diameter_px,
                  "Bead diameter, px; absent: estimated from the first frame")
      ->check(CLI::Range(3.0, 400.0));
  verb.add_option("--locator", o->locator.finder, "Finder")->check(CLI::IsMember(finder_names()));
  verb.add_option("--min-score", o->locator.find.min_score,
                  "Share of a circle's edge that must be seen, 0 .. 1");
  verb.add_flag("--bright", o->locator.preprocess.bright, "Beads are brighter than what lies behind them");
  verb.add_option("--truth", o->truth, "Score against truth.csv or a folder of truth_NN.csv");
  verb.add_option("--scored-rows", o->scored_rows, "First and last row that is scored, px")->expected(2);
  verb.callback([o, &common] { run(*o, common); });
}

}  // namespace twincell::cli
