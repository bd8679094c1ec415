// twincell calibrate KIND: measures scale, drive, walls, beads and contacts with standard errors, and writes
// them to a file that scenes include.

#include "cli/calibrate.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "cli/stack_info.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/output_rules.hpp"
#include "core/sha256.hpp"
#include "imaging/settings/configure_locator.hpp"

// The list: a kind of calibration is calibrate_NAME.cpp, which defines add_calibrate_NAME. Order of --help:
// each kind can use the results of the earlier ones.
#define TWINCELL_KINDS(EACH) \
  EACH(camera)               \
  EACH(walls)                \
  EACH(plate)                \
  EACH(beads)                \
  EACH(contacts)

namespace twincell::cli {

#define TWINCELL_DECLARE(name) void add_calibrate_##name(CLI::App& calibrate, Common& common);
TWINCELL_KINDS(TWINCELL_DECLARE)
#undef TWINCELL_DECLARE

namespace {

constexpr AddKind kKinds[] = {
#define TWINCELL_ADDRESS(name) add_calibrate_##name,
    TWINCELL_KINDS(TWINCELL_ADDRESS)
#undef TWINCELL_ADDRESS
};

/// Calibrations of several kinds write their figures into one folder.
///
/// \param certain files that are certainly written
Product calibration_figures(std::vector<std::string> certain = {}) {
  return Product::shared_folder("the figures of a calibration", std::move(certain));
}

Product calibration_product() {
  return Product::text("a calibration", "# twincell ");
}

const Quantity& quantity(const std::string& name) {
  const auto& all = quantities();
  return *std::find_if(all.begin(), all.end(), [&](const Quantity& q) { return q.name == name; });
}

std::string table_of(const std::vector<Measurement>& measured) {
  std::string s = fmt::format("{:<26}  {:<24}  {:<22}  {}\n", "quantity", "value", "standard error", "unit");
  for (const Measurement& m : measured) {
    std::vector<std::string> values, errors;
    for (const double v : m.value) values.push_back(fmt::format("{:.7g}", v));
    for (const double e : m.standard_error)
      errors.push_back(std::isfinite(e) ? fmt::format("{:.2g}", e) : "-");
    s += fmt::format("{:<26}  {:<24}  {:<22}  {}\n", m.name, fmt::format("{}", fmt::join(values, ", ")),
                     fmt::format("{}", fmt::join(errors, ", ")), quantity(m.name).unit);
  }
  return s;
}

nlohmann::json json_of(const Measurement& m) {
  nlohmann::json j;
  const auto list = [](const std::vector<double>& v) {
    if (v.size() == 1) return number_or_null(v.front());
    nlohmann::json a = nlohmann::json::array();
    for (const double x : v) a.push_back(number_or_null(x));
    return a;
  };
  j["value"] = list(m.value);
  j["standard_error"] = list(m.standard_error);
  j["unit"] = quantity(m.name).unit;
  j["method"] = m.method;
  j["data"] = m.data;
  return j;
}

/// Whether the beads of the first frames are brighter than the background, as `locate` and `new` find it.
bool shows_bright_beads(const CalibrateFlags& flags, const imaging::CellDescription& cell,
                        const Common& common) {
  imaging::LocatorOptions given;
  given.diameter_px = flags.diameter_px > 0 ? flags.diameter_px : cell.disc_px().value_or(0);
  given.polarity_known = false;
  try {
    const auto frames = open_stack(flags.stack, common);
    imaging::FramesAhead ahead(*frames);
    return imaging::configure_locator(ahead, given, common.n_threads()).locator.preprocess.bright;
  } catch (const imaging::NoDiscs&) {
    return false;  // edges alone: dark, unless --bright
  }
}

}  // namespace

std::string data_hash(const std::string& stack) {
  return "sha256:" + sha256_of(imaging::file_of_stack(stack));
}

void add_output_flags(CLI::App& verb, Common& common, CalibrateFlags& flags, const std::string& figure) {
  writes(common, verb,
         verb.add_option("-o,--output", flags.output,
                         "Calibration file to write (TOML), which a scene or CELL.toml can include; "
                         "quantities of other runs are kept in it"),
         calibration_product());
  writes(common, verb, verb.add_option("--figures", flags.figures, "Folder for the figures and their data"),
         calibration_figures(analysis::figure_files(figure)));
}

void add_stack_flags(CLI::App& verb, Common& common, CalibrateFlags& flags, const std::string& figure) {
  verb.add_option("stack", flags.stack,
                  "Stack: folder of pictures, TIFF, camera file, HDF5 stack or video (docs/frames.md)")
      ->required();
  verb.add_option("--cell", flags.cell_file,
                  "CELL.toml with the quantities of the cell that are already known");
  verb.add_option("--diameter", flags.diameter_px,
                  "Bead diameter, px; default: the scale in CELL.toml, otherwise estimated")
      ->check(CLI::Range(3.0, 400.0));
  CLI::Option* bright =
      verb.add_flag("--bright", flags.bright, "Beads, walls and plate are brighter than the background");
  verb.add_flag("--dark", flags.dark,
                "Beads, walls and plate are darker than the background; default: as CELL.toml states if they "
                "are bright there, otherwise determined from the first frames")
      ->excludes(bright);
  add_output_flags(verb, common, flags, figure);
}

imaging::CellDescription cell_of(const CalibrateFlags& flags) {
  return flags.cell_file.empty() ? imaging::CellDescription{} : imaging::read_cell(flags.cell_file);
}

imaging::CellDescription filmed_cell(const CalibrateFlags& flags, const Common& common) {
  imaging::CellDescription cell = cell_of(flags);
  if (flags.bright || flags.dark) {
    cell.bright = flags.bright;
  } else if (!cell.bright && shows_bright_beads(flags, cell, common)) {
    cell.bright = true;
    note(common, flags.stack +
                     ": the beads are brighter than the background, and so are walls and plate (--dark: "
                     "darker).");
  }
  return cell;
}

calibration::CellGeometry geometry_of(const CalibrateFlags& flags, const imaging::CellDescription& cell,
                                      const Common& common, calibration::StackEdges& edges) {
  const double diameter = calibration::diameter_for_edges(
      flags.stack, cell.bright,
      flags.diameter_px > 0 ? flags.diameter_px : cell.pixels_per_sigma.value_or(0));
  const auto frames = open_stack(flags.stack, common);
  {
    ProgressBar bar(common, "edges");
    edges = calibration::read_stack_edges(*frames,
                                          {.bright = cell.bright,
                                           .diameter_px = diameter,
                                           .refine = cell.refine.value_or(imaging::BeadsAtEdges{}.refine)},
                                          common.n_threads(), bar);
  }
  try {
    return calibration::fit_cell_geometry(edges);
  } catch (const InputError& e) {
    throw InputError({.file = flags.stack, .key = {}}, e.what());
  }
}

std::optional<Measurement> calibrated(const imaging::CellDescription& cell, const std::string& name) {
  const auto& taken = cell.included.taken;
  if (std::find(taken.begin(), taken.end(), name) == taken.end()) return std::nullopt;
  const Calibration file = read_calibration(cell.included.file);
  return *file.find(name);
}

std::optional<KnownNumber> scale_of(const imaging::CellDescription& cell,
                                    const calibration::CellGeometry& geometry) {
  if (cell.pixels_per_sigma) {
    return KnownNumber{
        .value = *cell.pixels_per_sigma, .error = cell.scale_error_px, .from = "the cell's scale"};
  }
  if (!cell.width || !geometry.has_left || !geometry.has_right) return std::nullopt;
  return KnownNumber{.value = geometry.width_px() / *cell.width,
                     .error = geometry.width_error_px() / *cell.width,
                     .from = "the walls' distance over cell.width"};
}

void finish_calibration(const CalibrateFlags& flags, const Common& common, CalibrationResult result) {
  for (const std::string& sentence : result.notes) note(common, sentence);
  std::string text =
      (result.measured.empty() ? std::string() : table_of(result.measured) + "\n") + result.text;
  nlohmann::json document = std::move(result.document);
  document["measured"] = nlohmann::json::object();
  for (const Measurement& m : result.measured) document["measured"][m.name] = json_of(m);
  document["notes"] = result.notes;
  if (!flags.figures.empty()) {
    AtomicPath folder(flags.figures, calibration_figures());
    for (const analysis::Figure& f : result.figures) {
      analysis::draw(f, folder.part());
      const std::string file = (std::filesystem::path(flags.figures) / (f.name + ".svg")).string();
      document["figures"].push_back(file);
      text += "picture: " + file + "\n";
    }
    folder.commit();
  }
  if (!flags.output.empty()) {
    Calibration file;
    if (flags.output != kStandardOutput && std::filesystem::exists(flags.output))
      file = read_calibration(flags.output);
    for (Measurement& m : result.measured) file.put(std::move(m));
    if (result.camera) file.camera = std::move(result.camera);
    write_text_file(flags.output, calibration_text(file, version_line() + ", last: " + common.command_line),
                    calibration_product());
    document["output"] = flags.output;
    text += flags.output + "\n";
  }
  document["provenance"] = nlohmann::json::parse(common.provenance().to_json());
  print_result(common, document, text);
}

void add_calibrate(CLI::App& program, Common& common) {
  CLI::App& verb = add_verb(program, common, "calibrate",
                            "Measure scale, walls, drive, beads or contacts, with standard errors. Prints "
                            "the values; -o also writes them to a calibration file.",
                            "twincell calibrate plate frames/ --cell CELL.toml -o cell.calibration.toml");
  verb.require_subcommand(1);
  for (const AddKind add : kKinds) add(verb, common);
}

}  // namespace twincell::cli
