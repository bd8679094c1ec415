// twincell match STACKS... CELL.toml: builds the twin of each filmed cell and compares both sides.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/comparing_options.hpp"
#include "cli/plan_text.hpp"
#include "cli/verb.hpp"
#include "core/output_rules.hpp"
#include "imaging/stack/open_frames.hpp"
#include "twin/cell_names.hpp"
#include "twin/twin.hpp"

namespace twincell::cli {
namespace {

struct MatchOptions {
  TwinOptions twin;
  std::vector<std::filesystem::path> stacks_and_cells;
  std::string output;
  ComparingFlags flags;
};

/// Makes the twin of `o.twin.stack` in `folder`, and adds its trajectories to the comparison.
Twin add_twin(const Common& common, MatchOptions& o, const std::filesystem::path& folder) {
  const TwinProvenance provenance = {.of_experiment =
                                         [&](const CellDescription& cell) {
                                           Provenance p = common.provenance();
                                           p.config = cell.text;
                                           p.inputs = {file_of_stack(o.twin.stack), o.twin.cell_file};
                                           return p.to_json();
                                         },
                                     .of_simulation =
                                         [&](const sim::Scene& scene, const std::vector<sim::Bead>& beads) {
                                           return scene_provenance(common, scene, beads, {});
                                         }};
  if (const CellDescription cell = read_cell(o.twin.cell_file); !cell.included.overridden.empty())
    note(common,
         fmt::format("values in {} take precedence over those measured in {}: {}", o.twin.cell_file.string(),
                     cell.included.file.string(), fmt::join(cell.included.overridden, ", ")));
  Twin twin = make_twin(o.twin, folder, provenance, progress_bars(common));
  o.flags.options.experiments.push_back(twin.experiment);
  auto& simulations = o.flags.options.simulations;
  simulations.insert(simulations.end(), twin.simulations.begin(), twin.simulations.end());
  return twin;
}

nlohmann::json json_of(const Twin& twin) {
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

std::string text_of(const Twin& twin) {
  return (twin.drive.empty() ? "" : "drive " + twin.drive + "\n") +
         fmt::format(
             "{} beads in the first packing, {:.4g} px per bead, located to {:.2g} sigma; {} twins "
             "over {} cycles; {}\n",
             twin.beads, twin.pixels_per_sigma, twin.position_error, twin.simulations.size(), twin.cycles,
             twin.scene.string());
}

void run(const Common& common, MatchOptions& o) {
  resolve(o.flags, common);
  o.twin.threads = common.n_threads();
  const std::filesystem::path folder = o.output;
  const StacksAndCells pairs = pair_stacks(o.stacks_and_cells);
  const std::vector<std::string> names = names_of_stacks(pairs.stacks);
  const bool several = pairs.stacks.size() > 1;
  // A mistake in the last cell must not appear after the first hour.
  for (const auto& cell : pairs.cells) (void)read_cell(cell);
  if (several) claim_shared_folder(folder, twin_folder());
  nlohmann::json said;
  std::string text;
  for (std::size_t i = 0; i < pairs.stacks.size(); ++i) {
    o.twin.stack = pairs.stacks[i];
    o.twin.cell_file = pairs.cells[i];
    const Twin twin = add_twin(common, o, several ? folder / names[i] : folder);
    text += text_of(twin);
    if (several)
      said["stacks"].push_back(json_of(twin));
    else
      said = json_of(twin);
  }
  o.flags.options.scratch = folder;
  compare_and_report(common, o.flags.options, folder / "report", said, text);
}

}  // namespace

void add_match(CLI::App& program, Common& common) {
  CLI::App& verb = add_verb(
      program, common, "match",
      "Build the twin of each filmed cell: track the stack, simulate from the first packing, and "
      "compare both sides in one phase diagram. Writes the trajectories, the scenes and a report into "
      "a folder.",
      "twincell match frames/ CELL.toml -o twin/\n"
      "  twincell match gamma-0.9/ gamma-1.6/ gamma-2.5/ cells/ -o twins/");
  auto o = std::make_shared<MatchOptions>();
  verb.add_option(
          "stacks_and_cells", o->stacks_and_cells,
          "Stacks (docs/frames.md), one for each drive strength, and the CELL.toml with origin and size "
          "of the cell: one for all stacks, one for each in their order, or the folder that twincell new "
          "wrote; default: CELL.toml in the folder of each stack. Scale, frames per cycle and drive are "
          "measured if the cell does not state them")
      ->required();
  writes(common, verb,
         verb.add_option(
                 "-o,--output", o->output,
                 "Folder for experiment.h5, scene.toml, simulation-N.h5 and report/; several stacks get a "
                 "folder each in it")
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
