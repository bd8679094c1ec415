#pragma once
/// \file
/// What the kinds of `calibrate` share: options, the table of measured quantities, the calibration file. To
/// add a kind, write cli/calibrate_NAME.cpp, add a line here and add a line to the table in calibrate.cpp.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analysis/report/figure.hpp"
#include "calibration/camera/cell_geometry.hpp"
#include "cli/output.hpp"
#include "imaging/cell/cell.hpp"
#include "trajectory/calibration_file.hpp"

namespace CLI {
class App;
}

namespace twincell::cli {

/// Options of all kinds that read a stack.
struct CalibrateFlags {
  std::string stack, cell_file, output, figures;
  double diameter_px = 0;
  bool bright = false, dark = false;
};
/// Adds the stack, --cell, --diameter, --bright and --dark, and what add_output_flags adds.
void add_stack_flags(CLI::App& verb, Common& common, CalibrateFlags& flags, const std::string& figure);
/// Adds -o and --figures.
///
/// \param figure name of the figure that the kind certainly draws
void add_output_flags(CLI::App& verb, Common& common, CalibrateFlags& flags, const std::string& figure);

/// The cell description of --cell, or an empty one without --cell.
imaging::CellDescription cell_of(const CalibrateFlags& flags);
/// The same with the polarity of the stack: that of --bright, --dark or a cell with bright beads, otherwise
/// that of the beads in the first frames, with a note where they are bright.
imaging::CellDescription filmed_cell(const CalibrateFlags& flags, const Common& common);

/// The geometry of the cell, fitted to the edges in the stack.
/// \param cell filmed_cell()
/// \param edges output: the edges, and the bead diameter with which they were read
calibration::CellGeometry geometry_of(const CalibrateFlags& flags, const imaging::CellDescription& cell,
                                      const Common& common, calibration::StackEdges& edges);

/// Method of a scale that was derived from the known width of the cell.
inline constexpr const char* kScaleByWalls = "distance of the side walls over cell.width";

/// A number with its standard error. If the error is absent, the number counts as exact.
struct KnownNumber {
  double value = 0;
  std::optional<double> error;
  std::string from;  ///< "cell.width of CELL.toml and the walls"
};
/// Pixels per sigma: from the cell description, otherwise the distance of the walls over cell.width. Absent
/// if neither is known.
std::optional<KnownNumber> scale_of(const imaging::CellDescription& cell,
                                    const calibration::CellGeometry& geometry);
/// The measurement of that name in the calibration file of the cell. Absent if the cell does not take the
/// quantity from there.
std::optional<Measurement> calibrated(const imaging::CellDescription& cell, const std::string& name);

/// The result of a calibration, ready for output.
struct CalibrationResult {
  std::vector<Measurement> measured;
  std::optional<MeasuredCovariance> camera;
  nlohmann::json document;  ///< the results that only this kind has
  std::string text;         ///< the same as text, printed after the table
  std::vector<analysis::Figure> figures;
  std::vector<std::string> notes;
};
/// Prints table and text, or with --json the document with "measured" added. Writes the calibration file and
/// the figures. Other quantities that the calibration file already contains are kept.
void finish_calibration(const CalibrateFlags& flags, const Common& common, CalibrationResult result);

/// "sha256:..." of a file, or of the files of a stack.
std::string data_hash(const std::string& stack);

/// Adds a kind of calibration: calibrate_NAME.cpp defines add_calibrate_NAME, the list in calibrate.cpp names
/// it.
using AddKind = void (*)(CLI::App& calibrate, Common& common);
/// Adds `calibrate contacts infer`.
void add_calibrate_infer(CLI::App& contacts, Common& common);

}  // namespace twincell::cli
