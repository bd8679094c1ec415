// twincell match STACK CELL.toml: builds the twin of a filmed cell and compares the two.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/comparing_options.hpp"
#include "cli/plan_text.hpp"
#include "cli/verb.hpp"
#include "imaging/stack/open_frames.hpp"
#include "twin/twin.hpp"

namespace twincell::cli {
namespace {

struct MatchOptions {
  TwinOptions twin;
  std::string output;
  ComparingFlags flags;
};

TwinProvenance provenance_of(const Common& common, const TwinOptions& options) {
  return {.of_experiment =
              [&common, &options](const CellDescription& cell) {
                Provenance p = common.provenance();
                p.config = cell.text;
                p.inputs = {file_of_stack(options.stack), options.cell_file};
                return p.to_json();
              },
          .of_simulation =
              [&common](const sim::Scene& scene, const std::vector<sim::Bead>& beads) {
                return scene_provenance(common, scene, beads, {});
              }};
}

/// Notes the values of the cell that replace measured ones.
void note_overridden(const Common& common, const std::filesystem::path& cell_file) {
  const CellDescription cell = read_cell(cell_file);
  if (cell.included.overridden.empty()) return;
  note(common, fmt::format("values in {} take precedence over those measured in {}: {}", cell_file.string(),
                           cell.included.file.string(), fmt::join(cell.included.overridden, ", ")));
}

ComparingOptions configuration(const MatchOptions& o, const Common& common) {
  ComparingOptions options = comparing_options(o.flags, common);
  options.scratch = o.output;
  return options;
}

nlohmann::json as_json(const Twin& twin) {
  std::vector<std::string> simulations;
  for (const auto& file : twin.simulations) simulations.push_back(file.string());
  return {{"experiment", twin.experiment.string()},
          {"scene", twin.scene.string()},
          {"twins", simulations},
          {"pixels_per_sigma", twin.pixels_per_sigma},
          {"drive", twin.drive.empty() ? "as the cell states it" : twin.drive},
          {"position_error", twin.position_error},
          {"beads", twin.beads},
          {"cycles", twin.cycles}};
}

std::string as_text(const Twin& twin) {
  return (twin.drive.empty() ? "" : "drive " + twin.drive + "\n") +
         fmt::format(
             "{} beads in the first packing, {:.4g} px per bead, located to {:.2g} sigma; {} twins "
             "over {} cycles; {}\n",
             twin.beads, twin.pixels_per_sigma, twin.position_error, twin.simulations.size(), twin.cycles,
             twin.scene.string());
}

void run(const Common& common, const MatchOptions& o) {
  const std::filesystem::path folder = o.output;
  TwinOptions twins = o.twin;
  twins.threads = common.n_threads();
  ComparingOptions options = configuration(o, common);
  note_overridden(common, twins.cell_file);
  const Twin twin = make_twin(twins, folder, provenance_of(common, twins), progress_bars(common));
  options.experiments = {twin.experiment};
  options.simulations = twin.simulations;
  const NotedComparison compared = compare_sides(common, options);
  report_comparison(common, options, compared, folder / "report", as_json(twin), as_text(twin));
}

}  // namespace

void add_match(CLI::App& program, Common& common) {
  CLI::App& verb =
      add_verb(program, common, "match",
               "Build the twin of a filmed cell: track the stack, simulate from the first packing, and "
               "compare both sides. Writes the trajectories, the scene and a report into a folder.",
               "twincell match frames/ CELL.toml -o twin/");
  auto o = std::make_shared<MatchOptions>();
  verb.add_option("stack", o->twin.stack,
                  "Stack: folder of pictures, TIFF, camera file, HDF5 stack or video (docs/frames.md)")
      ->required();
  verb.add_option("cell", o->twin.cell_file,
                  "CELL.toml with the origin and the size of the cell; scale, frames per cycle and drive are "
                  "measured if it does not state them")
      ->required();
  writes(common, verb,
         verb.add_option("-o,--output", o->output,
                         "Folder for experiment.h5, scene.toml, simulation-N.h5 and report/")
             ->required(),
         twin_folder());
  verb.add_option("--scene", o->twin.scene,
                  "Scene file (TOML) with the settings that the cell does not state, such as contacts and "
                  "steps; default: the preset fortini-huang-2015");
  verb.add_option("--set", o->twin.assignments,
                  "Set a key of the twin's scene, as section.key=value; overrides all files; may be repeated")
      ->take_all();
  verb.add_option("--twins", o->twin.twins,
                  "Number of simulations; in all but the first, each bead starts shifted at random within "
                  "the uncertainty of its position")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  verb.add_option("--diameter", o->twin.locator.diameter_px,
                  "Bead diameter, px; default: the scale in CELL.toml, otherwise estimated")
      ->check(CLI::Range(3.0, 400.0));
  verb.add_flag(
      "--trust-stated-drive", o->twin.trust_stated_drive,
      "Use the drive that the cell states, even if the plate or the bed in the film moves differently");
  verb.add_option("--memory", o->twin.link.memory,
                  "Number of frames for which a bead may be missing, 0 to 1000; default: 3");
  add_comparing_flags(verb, o->flags);
  verb.callback([&common, o] { run(common, *o); });
}

}  // namespace twincell::cli
