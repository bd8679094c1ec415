// twincell calibrate walls STACK|TRAJ: positions and tilts of the side walls.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "calibration/camera/bead_walls.hpp"
#include "calibration/camera/edge_map_figure.hpp"
#include "cli/calibrate.hpp"
#include "cli/stack_info.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::cli {
namespace {

Measurement tilts(double left, double left_error, double right, double right_error, const std::string& method,
                  const std::string& data) {
  return {.name = "cell.side_tilt",
          .value = {left, right},
          .standard_error = {left_error, right_error},
          .method = method,
          .data = data};
}

void of_trajectory(const CalibrateFlags& flags, const Common& common) {
  const H5mdReader trajectory(flags.stack);
  const calibration::BeadWalls w = calibration::walls_from_beads(trajectory);
  const std::string data = data_hash(flags.stack);
  CalibrationResult out;
  const std::string method = fmt::format("outermost beads in {} heights", w.rows);
  out.measured.push_back({.name = "cell.width",
                          .value = {w.width},
                          .standard_error = {w.width_error},
                          .method = method,
                          .data = data});
  out.measured.push_back(
      tilts(w.tilt_left, w.tilt_left_error, w.tilt_right, w.tilt_right_error, method, data));
  out.document["walls"] = {{"left", {{"x", w.x_left}, {"standard_error", w.x_left_error}}},
                           {"right", {{"x", w.x_left + w.width}, {"standard_error", w.x_right_error}}}};
  out.text = fmt::format(
      "left wall at x = {:.4f} +- {:.4f} sigma, right wall at {:.4f} +- {:.4f}, from the beads that touch "
      "them\n",
      w.x_left, w.x_left_error, w.x_left + w.width, w.x_right_error);
  finish_calibration(flags, common, std::move(out));
}

void of_stack(const CalibrateFlags& flags, const Common& common) {
  const imaging::CellDescription cell = filmed_cell(flags, common);
  calibration::StackEdges edges;
  const calibration::CellGeometry g = geometry_of(flags, cell, common, edges);
  if (!g.has_left || !g.has_right)
    throw InputError({.file = flags.stack, .key = {}},
                     fmt::format("shows no {} wall: each needs a {} border of 3 px with {} next to it.",
                                 g.has_left    ? "right"
                                 : g.has_right ? "left"
                                               : "side",
                                 cell.bright ? "bright" : "dark", cell.bright ? "darkness" : "light"));
  const std::string data = data_hash(flags.stack);
  CalibrationResult out;
  const double width = g.width_px(), error = g.width_error_px();
  const auto err = [&](const char* name) { return g.fit.standard_error(name); };
  const std::string method = "lines through the walls' edges, fitted with the plate's";
  // A width in sigma needs a scale that is not derived from the width itself.
  const auto scale_measured = calibrated(cell, "camera.pixels_per_sigma");
  if (scale_measured && scale_measured->method == kScaleByWalls) {
    out.notes.push_back(
        fmt::format("the scale in {} was derived from cell.width, so the width is not measured again: remove "
                    "cell.width from CELL.toml, and calibrate camera takes the scale from the beads",
                    cell.included.file.string()));
  } else if (cell.pixels_per_sigma) {
    const KnownNumber scale = *scale_of(cell, g);
    const double w = width / scale.value;
    out.measured.push_back(
        {.name = "cell.width",
         .value = {w},
         .standard_error = {w * std::hypot(error / width, scale.error.value_or(0) / scale.value)},
         .method = method,
         .data = data});
    if (!scale.error)
      out.notes.emplace_back("the error of cell.width assumes that the cell's scale is exact");
  } else {
    out.notes.emplace_back(
        "no scale is known, so the width is given only in px: measure the bead diameter in px with calibrate "
        "beads, or state camera.pixels_per_sigma in CELL.toml");
  }
  if (!g.has_plate)
    out.notes.emplace_back(
        "no plate is visible: tilts are measured against the columns of the picture, not against the normal "
        "of the plate");
  out.measured.push_back(tilts(g.fit.value("tilt_left"), err("tilt_left"), g.fit.value("tilt_right"),
                               err("tilt_right"), method, data));
  out.document["stack"] = flags.stack;
  out.document["walls"] = {
      {"left", {{"x_px", g.fit.value("x_left")}, {"standard_error", number_or_null(err("x_left"))}}},
      {"right", {{"x_px", g.fit.value("x_right")}, {"standard_error", number_or_null(err("x_right"))}}},
      {"width_px", {{"value", width}, {"standard_error", number_or_null(error)}}},
      {"foot_row_px", g.plate_row}};
  out.text = fmt::format(
      "left wall at {:.3f} +- {:.3f} px, right wall at {:.3f} +- {:.3f} px (at row {:.2f}, undistorted "
      "picture): {:.3f} +- {:.3f} px apart\n",
      g.fit.value("x_left"), err("x_left"), g.fit.value("x_right"), err("x_right"), g.plate_row, width,
      error);
  const double lean = g.fit.value("tilt_left") + g.fit.value("tilt_right"),
               lean_error = std::hypot(err("tilt_left"), err("tilt_right"));
  out.text += fmt::format("the cell is {} at the top: opening angle {:.3f} +- {:.3f} degrees\n",
                          std::abs(lean) < 2 * lean_error ? "as wide"
                          : lean > 0                      ? "wider"
                                                          : "narrower",
                          lean, lean_error);
  out.figures = {calibration::edge_map_figure(g)};
  finish_calibration(flags, common, std::move(out));
}

}  // namespace

void add_calibrate_walls(CLI::App& calibrate, Common& common) {
  auto flags = std::make_shared<CalibrateFlags>();
  CLI::App& verb = add_verb(calibrate, common, "walls",
                            "Measure the width of the cell and the tilts of the side walls. Prints them; -o "
                            "also writes them to a calibration file.",
                            "twincell calibrate walls frames/ --cell CELL.toml -o cell.calibration.toml");
  add_stack_flags(verb, common, *flags, "edges");
  verb.callback([flags, &common] {
    if (is_trajectory(flags->stack))
      of_trajectory(*flags, common);
    else
      of_stack(*flags, common);
  });
}

}  // namespace twincell::cli
