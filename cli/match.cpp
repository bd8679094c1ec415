// twincell match STACK CELL.toml: builds the twin of a filmed cell and compares the two.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/comparing_options.hpp"
#include "cli/locating_options.hpp"
#include "cli/phase_options.hpp"
#include "cli/plan_text.hpp"
#include "cli/verb.hpp"
#include "imaging/stack/open_frames.hpp"
#include "twin/twin.hpp"

namespace twincell::cli {
namespace {

struct MatchOptions {
  TwinOptions twin;
  PhaseFlags phase;
  LocatingFlags locating;
  std::string output;
  ComparingFlags flags;
};

void run(const Common& common, MatchOptions& o) {
  resolve(o.flags, common);
  o.twin.threads = common.n_threads();
  const std::filesystem::path folder = o.output;
  const TwinProvenance provenance = {
      .of_experiment =
          [&](const CellDescription& cell) {
            Provenance p = common.provenance();
            p.config = cell.text;
            p.inputs = {file_of_stack(o.twin.stack), o.twin.cell_file};
            for (const std::string& file : {o.locating.mask, o.locating.background})
              if (!file.empty()) p.inputs.emplace_back(file);
            return p.to_json();
          },
      .of_simulation =
          [&](const sim::Scene& scene, const std::vector<sim::Bead>& beads) {
            return scene_provenance(common, scene, beads, {});
          }};
  CellDescription cell = read_cell(o.twin.cell_file);
  o.twin.phases = phase_source(o.phase, cell, o.twin.cell_file.string());
  o.twin.phase_lock = lock_of_chosen(cell.phase_lock, frames_of(o.locating));
  o.twin.locator = locator_of(o.locating, cell.pixels_per_sigma, cell.bright);
  o.twin.region = region_of(o.locating);
  o.twin.open_stack = [&] {
    return open_for_locating(o.twin.stack.string(), o.locating, o.twin.locator, common);
  };
  if (!cell.included.overridden.empty())
    note(common,
         fmt::format("values in {} take precedence over those measured in {}: {}", o.twin.cell_file.string(),
                     cell.included.file.string(), fmt::join(cell.included.overridden, ", ")));
  const Twin twin = make_twin(o.twin, folder, provenance, progress_bars(common));
  if (!twin.phases.warning.empty()) note(common, twin.phases.warning + ".");

  o.flags.options.experiments = {twin.experiment};
  o.flags.options.simulations = twin.simulations;
  o.flags.options.scratch = folder;
  std::vector<std::string> simulations;
  for (const auto& file : twin.simulations) simulations.push_back(file.string());
  const nlohmann::json said = {{"experiment", twin.experiment.string()},
                               {"scene", twin.scene.string()},
                               {"twins", simulations},
                               {"pixels_per_sigma", twin.pixels_per_sigma},
                               {"drive", twin.drive.empty() ? "as the cell states it" : twin.drive},
                               {"phase_lock", json_of(twin.phases)},
                               {"position_error", twin.position_error},
                               {"beads", twin.beads},
                               {"cycles", twin.cycles}};
  compare_and_report(
      common, o.flags.options, folder / "report", said,
      (twin.drive.empty() ? "" : "drive " + twin.drive + "\n") + phases_in_words(twin.phases) +
          fmt::format("{} beads in the first packing, {:.4g} px per bead, located to {:.2g} sigma; {} twins "
                      "over {} cycles; {}\n",
                      twin.beads, twin.pixels_per_sigma, twin.position_error, twin.simulations.size(),
                      twin.cycles, twin.scene.string()));
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
  add_locating_flags(verb, o->locating);
  verb.add_flag(
      "--trust-stated-drive", o->twin.trust_stated_drive,
      "Use the drive and the frames per cycle that the cell states, even if the plate or the bed in the film "
      "moves differently");
  verb.add_option("--range", o->twin.link.range_diameters,
                  "Largest distance of a bead from its predicted position, bead diameters, above 0, at most "
                  "10; default: 2");
  verb.add_option("--memory", o->twin.link.memory,
                  "Number of frames for which a bead may be missing, 0 to 1000; default: 3");
  add_phase_flags(verb, o->phase);
  add_comparing_flags(verb, o->flags);
  verb.callback([&common, o] { run(common, *o); });
}

}  // namespace twincell::cli
