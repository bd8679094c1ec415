// twincell calibrate camera STACK: the map between pixels and positions in the cell.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>

#include "calibration/camera/edge_map_figure.hpp"
#include "calibration/camera/size_statistics.hpp"
#include "calibration/camera/target_fit.hpp"
#include "calibration/drive/drive_fit.hpp"
#include "cli/calibrate.hpp"
#include "cli/number_checks.hpp"
#include "cli/stack_info.hpp"
#include "core/constants.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/plural.hpp"
#include "imaging/stack/open_frames.hpp"

namespace twincell::cli {
namespace {

struct CameraCalibration {
  CalibrateFlags flags;
  int frames = 12;
  std::string target, kind = "chessboard";
  std::vector<int> grid;
  std::optional<double> focal_px, spacing;
};

/// Row of the plate's mean height in the undistorted picture: from a fit of its harmonic motion, or the mean
/// over the frames if the plate is at rest.
calibration::Estimate mean_row(const calibration::CellGeometry& g) {
  try {
    const calibration::DriveFit lock =
        calibration::fit_drive(g.heights_px(), {.model_error = calibration::kHeightModelError_px});
    return {g.plate_row - lock.z0, std::hypot(lock.z0_error, g.plate_row_error_of_map)};
  } catch (const InputError&) {
    return {g.plate_row, g.plate_row_error};
  }
}

void add_target(const CameraCalibration& o, nlohmann::json& d, std::string& text) {
  cv::Mat picture;
  if (!imaging::open_frames(o.target)->next(picture))
    throw InputError({.file = o.target, .key = {}}, "contains no picture.");
  if (o.grid.size() != 2)
    throw ConfigError({.file = {}, .key = "--target-grid"},
                      "is missing; give the numbers of points along x and y, for example 9 6.");
  const imaging::TargetPattern pattern{
      .kind = row_named(imaging::kTargetKinds, o.kind, "--target-kind", "target").value,
      .columns = o.grid[0],
      .rows = o.grid[1]};
  const auto points = imaging::find_target(picture, pattern);
  if (points.empty())
    throw InputError({.file = o.target, .key = {}}, fmt::format("shows no complete {} of {} x {} points.",
                                                                o.kind, pattern.columns, pattern.rows));
  const calibration::TargetFit t = calibration::fit_target(points, pattern, picture.size());
  nlohmann::json& out = d["target"];
  out["rms_px"] = t.rms_px;
  text += fmt::format("target: {} points, rms {:.3f} px\n", points.size(), t.rms_px);
  for (std::size_t i = 0; i < t.fit.names.size(); ++i) {
    const double e = t.fit.standard_errors.empty() ? kNaN : t.fit.standard_errors[i];
    out[t.fit.names[i]] = {{"value", t.fit.values[i]}, {"standard_error", number_or_null(e)}};
    text += fmt::format("  {:<20} {:.6g} +- {:.2g}\n", t.fit.names[i], t.fit.values[i], e);
  }
  if (o.spacing) {
    const double s = t.fit.values[0] / *o.spacing,
                 e = t.fit.standard_error("pixels_per_spacing") / *o.spacing;
    out["pixels_per_sigma"] = {{"value", s}, {"standard_error", number_or_null(e)}};
    text += fmt::format("  pixels per sigma     {:.6g} +- {:.2g}\n", s, e);
  }
  if (o.focal_px) {
    // The depth grows as tan(tilt) across the plane, which appears in the picture as tan(tilt)/f.
    for (const char* axis : {"x", "y"}) {
      const std::string name = std::string("gradient_") + axis;
      const double tilt = std::atan(*o.focal_px * t.fit.value(name)) * 180 / M_PI,
                   e = *o.focal_px * t.fit.standard_error(name) * 180 / M_PI;
      out[std::string("tilt_") + axis + "_deg"] = {{"value", tilt}, {"standard_error", number_or_null(e)}};
      text += fmt::format("  camera's tilt in {}   {:.4g} +- {:.2g} degrees\n", axis, tilt, e);
    }
  }
}

/// The geometry of the cell, and what else the results of this kind are computed from.
struct MeasuredCamera {
  const CameraCalibration& options;
  const imaging::CellDescription& cell;
  const calibration::CellGeometry& geometry;
  std::string data;                                   // hash of the stack
  std::optional<calibration::SizeStatistics> census;  // of the beads; absent if none are found
  std::optional<calibration::Estimate>
      by_walls;  // pixels per sigma; absent if a wall or their distance is unknown
};

/// Sizes of the beads, located in the picture after correction of rotation and distortion.
std::optional<calibration::SizeStatistics> census_of(const CameraCalibration& o,
                                                     const imaging::CellDescription& cell,
                                                     const calibration::CellGeometry& g, const Common& common,
                                                     std::vector<std::string>& notes) {
  imaging::LocatorOptions locator;
  locator.preprocess.bright = cell.bright;
  locator.diameter_px = o.flags.diameter_px > 0 ? o.flags.diameter_px : cell.pixels_per_sigma.value_or(0);
  std::optional<imaging::Lens> lens;
  if (g.rotation_deg != 0 || g.distortion != 0) lens = imaging::Lens(g.size, g.rotation_deg, g.distortion);
  try {
    const auto frames = open_stack(o.flags.stack, common);
    ProgressBar bar(common, "beads");
    return calibration::count_beads(
        calibration::locate_beads(*frames, locator, lens, o.frames, common.n_threads(), bar));
  } catch (const InputError& e) {
    notes.push_back(fmt::format("no scale from the beads: {}", e.what()));
    return std::nullopt;
  }
}

/// Pixels per sigma from the distance of the walls over the known width of the cell.
std::optional<calibration::Estimate> scale_by_walls(const imaging::CellDescription& cell,
                                                    const calibration::CellGeometry& g) {
  if (!g.has_left || !g.has_right || !cell.width) return std::nullopt;
  double e = g.width_error_px() / *cell.width;
  if (const auto m = calibrated(cell, "cell.width"))
    e = std::hypot(e, g.width_px() / *cell.width * m->standard_error[0] / *cell.width);
  return calibration::Estimate{g.width_px() / *cell.width, e};
}

struct Scale {
  calibration::Estimate pixels_per_sigma;
  std::string method;
};

/// The scale from the walls if their distance is known, otherwise from the diameter of the beads.
Scale measured_scale(const MeasuredCamera& m) {
  if (m.by_walls) return {*m.by_walls, kScaleByWalls};
  if (m.census)
    return {m.census->diameter, fmt::format("mean diameter of {} in {}", plural(m.census->sizes, "disc"),
                                            plural(m.census->frames, "frame"))};
  throw InputError({.file = m.options.flags.stack, .key = {}},
                   "gives no scale: no beads are found, and cell.width or a side wall is missing.");
}

/// Adds scale, origin, rotation and distortion.
void add_quantities(CalibrationResult& out, const MeasuredCamera& m, const Scale& scale,
                    const calibration::Estimate& row) {
  const calibration::CellGeometry& g = m.geometry;
  const auto add = [&](const std::string& name, std::vector<double> value, std::vector<double> error,
                       const std::string& how) {
    out.measured.push_back({.name = name,
                            .value = std::move(value),
                            .standard_error = std::move(error),
                            .method = how,
                            .data = m.data});
  };
  const auto err = [&](const char* name) { return g.fit.standard_error(name); };
  add("camera.pixels_per_sigma", {scale.pixels_per_sigma.value}, {scale.pixels_per_sigma.error},
      scale.method);
  if (g.has_left && g.has_plate)
    add("camera.origin_px", {g.fit.value("x_left"), row.value}, {err("x_left"), row.error},
        "foot of the left wall and mean height of the plate, picture without turn and distortion");
  else
    out.notes.emplace_back("the origin is not measured, because it needs the left wall and the plate");
  if (g.has_plate)
    add("camera.rotation_deg", {g.rotation_deg}, {err("rotation")}, "slope of the plate's edge");
  if (g.distortion_found)
    add("camera.distortion", {g.distortion}, {*g.distortion_error},
        g.distortion != 0 ? "bend of walls and plate"
                          : "bend of walls and plate: less than three standard errors, taken as 0");
}

/// Adds the covariance of the stored quantities. The rows of `map` lead from the parameters of the fit to
/// these quantities.
void add_covariance(CalibrationResult& out, const MeasuredCamera& m, const Scale& scale,
                    const calibration::Estimate& row) {
  const calibration::CellGeometry& g = m.geometry;
  if (!g.has_left || !g.has_plate || g.fit.covariance.size() == 0) return;
  const auto place = [&](const char* name) {
    return std::find(g.fit.names.begin(), g.fit.names.end(), name) - g.fit.names.begin();
  };
  const auto n = static_cast<Eigen::Index>(g.fit.names.size());
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(5, n);
  if (m.by_walls) {
    map(0, place("x_right")) = 1 / *m.cell.width;
    map(0, place("x_left")) = -1 / *m.cell.width;
  }
  map(1, place("x_left")) = 1;
  map(3, place("rotation")) = 1;
  if (g.distortion != 0) map(4, place("distortion")) = 1;
  Eigen::MatrixXd c = map * g.fit.covariance * map.transpose();
  c(0, 0) = scale.pixels_per_sigma.error * scale.pixels_per_sigma.error;
  c(2, 2) = row.error * row.error;
  MeasuredCovariance stored{
      .names = {"pixels_per_sigma", "origin_x_px", "origin_y_px", "rotation_deg", "distortion"},
      .matrix = {}};
  for (Eigen::Index r = 0; r < 5; ++r)
    for (Eigen::Index k = 0; k < 5; ++k) stored.matrix.push_back(std::isfinite(c(r, k)) ? c(r, k) : 0);
  out.document["covariance"] = {{"names", stored.names}, {"matrix", stored.matrix}};
  out.camera = std::move(stored);
}

/// Perspective: only walls and beads together distinguish a tilted camera from tilted walls.
void report_perspective(CalibrationResult& out, const calibration::SizeStatistics& census, cv::Size size) {
  constexpr double kSure = 4, kWorthSaying = 2e-3;
  const double change_x = census.gradient_x.value * size.width,
               error_x = census.gradient_x.error * size.width,
               change_y = census.gradient_y.value * size.height,
               error_y = census.gradient_y.error * size.height;
  out.document["perspective"] = {
      {"across", {{"value", number_or_null(change_x)}, {"standard_error", number_or_null(error_x)}}},
      {"downwards", {{"value", number_or_null(change_y)}, {"standard_error", number_or_null(error_y)}}}};
  out.text += fmt::format(
      "  beads grow by {:.2f} +- {:.2f} % from left to right, by {:.2f} +- {:.2f} % from top to bottom\n",
      100 * change_x, 100 * error_x, 100 * change_y, 100 * error_y);
  const auto seen = [&](double change, double error) {
    return std::abs(change) > kSure * error && std::abs(change) > kWorthSaying;
  };
  if (seen(change_x, error_x) || seen(change_y, error_y))
    out.notes.push_back(fmt::format(
        "the camera is tilted, or the beads are sorted by size: they grow by {:.1f} % from left to right "
        "and by {:.1f} % from top to bottom. Perspective is not modelled: scale and tilts of the walls are "
        "means over the picture; a --target distinguishes the two cases",
        100 * change_x, 100 * change_y));
}

/// Comparison of the scales, printed only.
void report_scales(CalibrationResult& out, const MeasuredCamera& m) {
  nlohmann::json& d = out.document;
  const auto scale_line = [&](const char* what, const calibration::Estimate& e) {
    d["scales"][what] = {{"value", e.value}, {"standard_error", number_or_null(e.error)}};
    out.text += fmt::format("  {:<10} {:.5f} +- {:.5f}\n", what, e.value, e.error);
  };
  out.text = "pixels per sigma\n";
  if (m.by_walls) scale_line("walls", *m.by_walls);
  if (m.census) {
    scale_line("diameter", m.census->diameter);
    if (m.census->spacing) scale_line("spacing", *m.census->spacing);
    report_perspective(out, *m.census, m.geometry.size);
  }
  if (m.by_walls && m.census) {
    const calibration::Estimate &beads = m.census->diameter, &walls = *m.by_walls;
    const double apart = (beads.value - walls.value) / std::hypot(beads.error, walls.error);
    d["scales"]["standard_errors_apart"] = number_or_null(apart);
    out.text += fmt::format("  walls and diameters are {:.1f} standard errors apart\n", std::abs(apart));
    // A width in sigma is often the distance of the walls in px over the diameter in px.
    constexpr double kSame = 2e-3;
    const double width_px = m.geometry.width_px();
    const bool measured = calibrated(m.cell, "cell.width").has_value(),
               product = m.cell.pixels_per_sigma &&
                         std::abs(*m.cell.pixels_per_sigma * *m.cell.width / width_px - 1) < kSame;
    if (measured || product)
      out.notes.push_back(fmt::format(
          "the two scales are independent only if cell.width was measured in the laboratory: {}; if it was "
          "derived from the bead diameter in the picture, as twincell new does without --cell-width-mm, they "
          "agree whatever the true scale is",
          measured ? "it comes from a calibration of the film"
                   : "it is the distance of the walls in px over camera.pixels_per_sigma"));
  }
}

/// Distortion as fitted, residuals of the edges, blur.
void report_edges(CalibrationResult& out, const calibration::CellGeometry& g) {
  if (g.distortion_found)
    out.text += fmt::format("distortion k1 = {:.2g} +- {:.1g}{}\n", *g.distortion_found, *g.distortion_error,
                            g.distortion == 0 ? ": not significant" : "");
  double squares = 0;
  for (const calibration::EdgeResidual& r : g.residuals) squares += r.distance_px * r.distance_px;
  const double rms = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, g.residuals.size())));
  out.document["residuals"] = {{"points", g.residuals.size()}, {"rms_px", rms}};
  out.document["blur_px"] = g.blur_px;
  out.text += fmt::format("{} points on walls and plate, rms {:.3f} px; blur {:.2f} px\n", g.residuals.size(),
                          rms, g.blur_px);
}

void run(const CameraCalibration& o, const Common& common) {
  const imaging::CellDescription cell = filmed_cell(o.flags, common);
  CalibrationResult out;
  out.document["stack"] = o.flags.stack;
  calibration::StackEdges edges;
  const calibration::CellGeometry g = geometry_of(o.flags, cell, common, edges);
  MeasuredCamera m{o, cell, g, data_hash(o.flags.stack), {}, {}};
  m.census = census_of(o, cell, g, common, out.notes);
  m.by_walls = scale_by_walls(cell, g);
  const Scale scale = measured_scale(m);
  const calibration::Estimate row = mean_row(g);
  add_quantities(out, m, scale, row);
  add_covariance(out, m, scale, row);
  report_scales(out, m);
  report_edges(out, g);
  if (!o.target.empty()) add_target(o, out.document, out.text);
  out.figures = {calibration::edge_map_figure(g)};
  finish_calibration(o.flags, common, std::move(out));
}

}  // namespace

void add_calibrate_camera(CLI::App& calibrate, Common& common) {
  auto o = std::make_shared<CameraCalibration>();
  CLI::App& verb = add_verb(calibrate, common, "camera",
                            "Measure scale, origin, rotation and distortion of the picture from the edges of "
                            "the cell and the beads. Prints them; -o also writes them to a calibration file.",
                            "twincell calibrate camera frames/ --cell CELL.toml -o cell.calibration.toml");
  add_stack_flags(verb, common, o->flags, "edges");
  verb.add_option("--sampled-frames", o->frames,
                  "Number of frames in which beads are located, spread over the stack")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  former_option(verb, "--frames", "--sampled-frames");
  verb.add_option("--target", o->target,
                  "Picture of a chessboard or of a grid of dots, to measure the tilt of the camera");
  verb.add_option("--target-kind", o->kind, "Pattern of --target: chessboard (default) or dots")
      ->check(CLI::IsMember(words_of(imaging::kTargetKinds)));
  verb.add_option("--target-grid", o->grid, "Number of inner corners, or dots, of --target along x and y")
      ->expected(2)
      ->delimiter(',');
  verb.add_option("--target-spacing", o->spacing, "Distance between neighbouring points of --target, sigma")
      ->check(above_zero());
  verb.add_option("--focal-px", o->focal_px,
                  "Focal length, px; converts the change of scale across --target to the tilt of the camera")
      ->check(above_zero());
  verb.callback([o, &common] { run(*o, common); });
}

}  // namespace twincell::cli
