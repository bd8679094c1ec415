// twincell calibrate beads STACK|TRAJ: diameter, spread of sizes and number of beads.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "calibration/camera/size_statistics.hpp"
#include "calibration/camera/size_statistics_figure.hpp"
#include "cli/calibrate.hpp"
#include "cli/stack_info.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/plural.hpp"
#include "imaging/stack/open_frames.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::cli {
namespace {

struct BeadOptions {
  CalibrateFlags flags;
  int frames = 20;
};

void run(const BeadOptions& o, const Common& common) {
  const bool tracked = is_trajectory(o.flags.stack);
  const imaging::CellDescription cell = tracked ? cell_of(o.flags) : filmed_cell(o.flags, common);
  CalibrationResult out;
  calibration::SizeStatistics c;
  double unit_px = 1;  // px in the unit of length of `c`
  std::optional<double> width = cell.width;
  double width_error = 0;
  if (tracked) {
    const H5mdReader trajectory(o.flags.stack);
    c = calibration::count_beads(calibration::beads_of(trajectory, o.frames));
    const TrajectoryInfo& info = trajectory.info();
    unit_px = info.scale.pixels_per_sigma.value_or(std::nan(""));
    if (info.box.boundary[0] != Boundary::open) width = info.box.size().x();
  } else {
    imaging::LocatorOptions locator;
    locator.preprocess.bright = cell.bright;
    locator.diameter_px = o.flags.diameter_px > 0 ? o.flags.diameter_px : cell.pixels_per_sigma.value_or(0);
    const auto frames = open_stack(o.flags.stack, common);
    cv::Mat first;
    std::optional<imaging::Lens> lens;
    if (cell.rotation_deg != 0 || cell.distortion != 0) {
      if (!imaging::open_frames(o.flags.stack)->next(first))
        throw InputError({.file = o.flags.stack, .key = {}}, "contains no frame.");
      lens = imaging::Lens(first.size(), cell.rotation_deg, cell.distortion);
    }
    ProgressBar bar(common, "beads");
    const calibration::BeadFrames beads =
        calibration::locate_beads(*frames, locator, lens, o.frames, common.n_threads(), bar);
    c = calibration::count_beads(beads);
    for (const std::string& doubt :
         {calibration::others_in_words(beads), beads.aspect ? beads.aspect->doubt() : std::string()})
      if (!doubt.empty()) out.notes.push_back(doubt);
    if (const auto m = calibrated(cell, "cell.width")) width_error = m->standard_error[0];
  }
  const std::string data = data_hash(o.flags.stack);
  const std::string method = plural(c.sizes, "disc") + " in " + plural(c.frames, "frame");
  const auto add = [&](const std::string& name, const calibration::Estimate& e, const std::string& how) {
    out.measured.push_back(
        {.name = name, .value = {e.value}, .standard_error = {e.error}, .method = how, .data = data});
  };
  if (std::isfinite(unit_px))
    add("beads.diameter", {c.diameter.value * unit_px, c.diameter.error * unit_px}, "mean of " + method);
  add("beads.spread", c.spread, "standard deviation over mean of " + method);
  add("beads.mass", c.mass, "mean of d^3 over that of a bead of mean size, " + method);
  if (width) {
    const double layers = c.count.value / *width;
    add("beads.layers",
        {layers, layers * std::hypot(std::isfinite(c.count.error) ? c.count.error / c.count.value : 0,
                                     width_error / *width)},
        "beads of a frame over cell.width (Fortini & Huang 2015)");
  } else {
    out.notes.emplace_back("cell.width is not known, so the number of layers is not computed");
  }
  nlohmann::json& d = out.document;
  d["source"] = o.flags.stack;
  d["frames"] = c.frames;
  d["discs"] = c.sizes;
  d["count"] = {{"value", c.count.value}, {"standard_error", number_or_null(c.count.error)}};
  if (c.spacing)
    d["spacing"] = {{"value", c.spacing->value * unit_px}, {"standard_error", c.spacing->error * unit_px}};
  out.text = fmt::format("{} beads per frame\n", c.count.value);
  if (c.spacing)
    out.text += fmt::format("touching beads are {:.4f} +- {:.4f} px apart, {:.4f} mean diameters\n",
                            c.spacing->value * unit_px, c.spacing->error * unit_px,
                            c.spacing->value / c.diameter.value);
  if (c.spread.value < 2 * c.spread.error) out.text += "sizes: no spread beyond the error of locating them\n";
  out.figures = {calibration::size_statistics_figure(c, unit_px)};
  finish_calibration(o.flags, common, std::move(out));
}

}  // namespace

void add_calibrate_beads(CLI::App& calibrate, Common& common) {
  auto o = std::make_shared<BeadOptions>();
  CLI::App& verb =
      add_verb(calibrate, common, "beads",
               "Measure the bead diameter, the spread of the sizes, the mean mass by volume, and the "
               "effective number of layers. Prints them; -o also writes them to a calibration file.",
               "twincell calibrate beads frames/ --cell CELL.toml -o cell.calibration.toml");
  add_stack_flags(verb, common, o->flags, "beads");
  verb.add_option("--sampled-frames", o->frames, "Number of frames that are evaluated, spread over the stack")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  former_option(verb, "--frames", "--sampled-frames");
  verb.callback([o, &common] { run(*o, common); });
}

}  // namespace twincell::cli
