#pragma once
/// \file
/// What the kinds of `calibrate` share: options, the table of what was measured, the calibration file. A new
/// kind is cli/calibrate_NAME.cpp, a line here and a line in calibrate.cpp's table.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analysis/report/figures.hpp"
#include "calibration/camera/cell_geometry.hpp"
#include "cli/output.hpp"
#include "imaging/cell/cell.hpp"
#include "trajectory/calibration_file.hpp"

namespace CLI {
class App;
}

namespace twincell::cli {

/// Options of all kinds that look at a stack.
struct CalibrateFlags {
  std::string stack, cell_file, output, figures;
  double diameter_px = 0;
  bool bright = false;
};
void add_stack_flags(CLI::App& verb, Common& common, CalibrateFlags& flags);
/// -o and --figures.
void add_output_flags(CLI::App& verb, Common& common, CalibrateFlags& flags);

/// The cell of --cell, or one of which nothing is known.
CellDescription cell_of(const CalibrateFlags& flags);

/// What the edges of the stack say, and the bead diameter that was taken for them.
CellGeometry geometry_of(const CalibrateFlags& flags, const CellDescription& cell, const Common& common,
                         StackEdges& edges);

/// How a scale was measured that takes the cell's width as known.
inline constexpr const char* kScaleByWalls = "distance of the side walls over cell.width";

/// A number with its error; absent error: none.
struct KnownNumber {
  double value = 0;
  std::optional<double> error;
  std::string from;  ///< "cell.width of CELL.toml and the walls"
};
/// Pixels per sigma: of the cell, else of the walls' distance over cell.width. Nothing if neither is known.
std::optional<KnownNumber> scale_of(const CellDescription& cell, const CellGeometry& geometry);
/// The same number as the cell's calibration file has it; nothing if it was not taken from there.
std::optional<Measurement> calibrated(const CellDescription& cell, const std::string& name);

/// A result on its way out.
struct CalibrationResult {
  std::vector<Measurement> measured;
  std::optional<MeasuredCovariance> camera;
  nlohmann::json document;  ///< what only this kind has to say
  std::string text;         ///< the same for people, after the table
  std::vector<Figure> figures;
  std::vector<std::string> notes;
};
/// Prints table and text, or the document with "measured" put in; writes the calibration file (what it
/// already holds of other quantities stays) and the figures.
void finish_calibration(const CalibrateFlags& flags, const Common& common, CalibrationResult result);

/// "sha256:..." of a file or the files of a stack.
std::string data_hash(const std::string& stack);

/// A number for JSON; null where it is not finite.
nlohmann::json finite(double value);

using AddKind = void (*)(CLI::App& calibrate, Common& common);
void add_calibrate_plate(CLI::App& calibrate, Common& common);
void add_calibrate_walls(CLI::App& calibrate, Common& common);
void add_calibrate_beads(CLI::App& calibrate, Common& common);
void add_calibrate_camera(CLI::App& calibrate, Common& common);
void add_calibrate_contacts(CLI::App& calibrate, Common& common);
/// A kind of `calibrate contacts`.
void add_calibrate_infer(CLI::App& contacts, Common& common);

}  // namespace twincell::cli
