// twincell match STACKS... CELL.toml: builds the twin of each filmed cell and compares both sides.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "analysis/report/report.hpp"
#include "cli/cell_notes.hpp"
#include "cli/comparing_options.hpp"
#include "cli/locating_options.hpp"
#include "cli/phase_options.hpp"
#include "cli/plan_text.hpp"
#include "cli/verb.hpp"
#include "core/output_rules.hpp"
#include "core/plural.hpp"
#include "imaging/stack/different_stacks.hpp"
#include "imaging/stack/open_frames.hpp"
#include "twin/cell_names.hpp"
#include "twin/stated_strengths.hpp"
#include "twin/twin.hpp"

namespace twincell::cli {
namespace {

struct MatchOptions {
  twin::TwinOptions twin;  ///< without the stack and its cell, which each twin has for itself
  std::vector<std::filesystem::path> stacks_and_cells;
  std::string output;
  ComparingFlags flags;
};

twin::TwinProvenance provenance_of(const Common& common, const twin::TwinOptions& options) {
  return {.of_experiment =
              [&common, &options](const imaging::CellDescription& cell) {
                Provenance p = common.provenance();
                p.config = cell.text;
                p.inputs = {imaging::file_of_stack(options.stack), options.cell_file()};
                for (const std::string& file : {options.film.locating.mask, options.film.locating.background})
                  if (!file.empty()) p.inputs.emplace_back(file);
                return p.to_json();
              },
          .of_simulation =
              [&common](const sim::Scene& scene, const std::vector<sim::Bead>& beads) {
                return scene_provenance(common, scene, beads, {});
              }};
}

/// The options of the comparison of the twins with their experiments.
twin::ComparingOptions comparing(const MatchOptions& o, const Common& common,
                                 const std::vector<twin::Twin>& twins) {
  twin::ComparingOptions options = comparing_options(o.flags, common);
  options.scratch = o.output;
  for (const twin::Twin& twin : twins) {
    options.experiments.push_back(twin.experiment);
    options.simulations.insert(options.simulations.end(), twin.simulations.begin(), twin.simulations.end());
  }
  return options;
}

nlohmann::json as_json(const twin::Twin& twin) {
  std::vector<std::string> simulations;
  for (const auto& file : twin.simulations) simulations.push_back(file.string());
  return {{"experiment", twin.experiment.string()},
          {"scene", twin.scene.string()},
          {"twins", simulations},
          {"pixels_per_sigma", twin.pixels_per_sigma},
          {"drive", twin.drive.empty() ? "as the cell states it" : twin.drive},
          {"phase_lock", json_of(twin.phases)},
          {"position_error", twin.position_error},
          {"beads", twin.beads},
          {"cycles", twin.cycles},
          {"discarded_cycles", twin.discarded},
          {"settling_fall", twin.fall}};
}

std::string as_text(const twin::Twin& twin) {
  return (twin.drive.empty() ? "" : "drive " + twin.drive + "\n") + phases_in_words(twin.phases) +
         fmt::format("{} in the first packing, {:.4g} px per bead, located to {:.2g} sigma; {} over {}; {}\n",
                     plural(twin.beads, "bead"), twin.pixels_per_sigma, twin.position_error,
                     plural(twin.simulations.size(), "twin"), plural(twin.cycles, "cycle"),
                     twin.scene.string());
}

/// The options of the twin of one stack.
twin::TwinOptions options_of(const MatchOptions& o, const Common& common, const std::filesystem::path& stack,
                             const std::filesystem::path& cell) {
  twin::TwinOptions options = o.twin;
  options.stack = stack;
  options.film.request.cell_file = cell.string();
  options.film.threads = common.n_threads();
  options.discard = o.flags.discard_cycles;
  options.open = [&o, &common, name = stack.string()](const imaging::LocatorOptions& locator) {
    return open_for_locating(name, o.twin.film.locating, locator, common);
  };
  return options;
}

/// What is doubtful about the twin of a stack, in sentences.
std::vector<std::string> notes_of(const twin::Twin& twin, const std::filesystem::path& stack) {
  std::vector<std::string> notes;
  for (const std::string& doubt : twin.doubts) notes.push_back(fmt::format("{}: {}", stack.string(), doubt));
  if (twin.records_transient())
    notes.push_back(fmt::format(
        "{} begins in mid-motion: the beads of its first packing lie {:.2g} sigma above where they settle, "
        "on average. The twin starts at rest, so its first cycles differ; --set time.discard=8 leaves out "
        "eight of them.",
        stack.string(), twin.fall));
  return notes;
}

/// Makes the twin of one stack in `folder`, and notes what is doubtful about it.
twin::Twin make_noted_twin(const Common& common, const twin::TwinOptions& options,
                           const std::filesystem::path& folder) {
  note_cell(common, imaging::read_cell(options.cell_file()), options.cell_file());
  twin::Twin twin = twin::make_twin(options, folder, provenance_of(common, options), progress_bars(common));
  for (const std::string& sentence : notes_of(twin, options.stack)) note(common, sentence);
  return twin;
}

/// Does work of which an error must say which of several stacks it is about.
void naming(const std::filesystem::path& stack, const std::function<void()>& work) {
  try {
    work();
  } catch (const Interrupted&) {
    throw;
  } catch (const Error& e) {
    const std::string said = e.what();
    if (said.find(stack.string()) != std::string::npos) throw;
    throw Error(e.exit_code(), fmt::format("{}: {}", stack.string(), said));
  }
}

/// \throws ConfigError if the folder holds the result of a match of another layout, or a report that may not
/// be replaced: known before the first hour
void require_layout(const std::filesystem::path& folder, bool several) {
  namespace fs = std::filesystem;
  std::error_code ec;
  if (!fs::is_directory(folder, ec)) return;
  if (several && fs::exists(folder / "experiment.h5", ec))
    throw ConfigError({.file = folder.string()}, "it holds the match of one stack; name a new folder.");
  if (!several)
    for (const auto& entry : fs::directory_iterator(folder, ec))
      if (fs::exists(entry.path() / "experiment.h5", ec))
        throw ConfigError({.file = folder.string()},
                          "it holds the match of several stacks; name a new folder.");
  (void)require_output(folder / "report", analysis::report_folder());
}

/// Makes the twins of all stacks, each in a folder of its own if there are several.
std::vector<twin::Twin> make_twins(const Common& common, const MatchOptions& o,
                                   const twin::StacksAndCells& pairs) {
  const std::filesystem::path folder = o.output;
  const std::vector<std::string> names = twin::names_of_stacks(pairs.stacks);
  const bool several = pairs.stacks.size() > 1;
  require_layout(folder, several);
  if (several) claim_shared_folder(folder, twin::twin_folder());
  std::vector<twin::Twin> twins;
  for (std::size_t i = 0; i < pairs.stacks.size(); ++i) {
    const auto add = [&] {
      twin::TwinOptions options = options_of(o, common, pairs.stacks[i], pairs.cells[i]);
      options.stacks_of_cell = static_cast<std::size_t>(std::ranges::count(pairs.cells, pairs.cells[i]));
      twins.push_back(make_noted_twin(common, options, several ? folder / names[i] : folder));
    };
    several ? naming(pairs.stacks[i], add) : add();
  }
  return twins;
}

/// Whether cells that state Gamma and amplitude state strengths of other stacks.
std::string strengths_doubt(const twin::StacksAndCells& pairs) {
  std::vector<twin::StackDrive> drives;
  for (std::size_t i = 0; i < pairs.stacks.size(); ++i) {
    const imaging::CellDescription cell = imaging::read_cell(pairs.cells[i]);
    drives.push_back({.name = pairs.stacks[i].string(),
                      .gamma = cell.drive_spec.gamma.value_or(0),
                      .amplitude = cell.drive_spec.amplitude.value_or(0),
                      .frames_per_cycle = cell.phase_lock.frames_per_cycle});
  }
  return twin::strengths_doubt(drives);
}

nlohmann::json as_json(const std::vector<twin::Twin>& twins) {
  if (twins.size() == 1) return as_json(twins.front());
  nlohmann::json json;
  for (const twin::Twin& twin : twins) json["stacks"].push_back(as_json(twin));
  return json;
}

void run(const Common& common, const MatchOptions& o) {
  (void)comparing(o, common, {});  // refuse wrong options before the first hour
  const twin::StacksAndCells pairs = twin::pair_stacks(o.stacks_and_cells);
  // A mistake in the last cell or stack must not appear after the first hour.
  for (const auto& cell : pairs.cells) (void)imaging::read_cell(cell);
  imaging::require_different_stacks(pairs.stacks);
  const std::string doubt = strengths_doubt(pairs);
  if (!doubt.empty()) note(common, doubt);
  const std::vector<twin::Twin> twins = make_twins(common, o, pairs);
  std::string text;
  for (const twin::Twin& twin : twins) text += as_text(twin);
  const twin::ComparingOptions options = comparing(o, common, twins);
  analysis::Comparison compared = compare_sides(common, options);
  std::vector<std::string> notes;
  if (!doubt.empty()) notes.push_back(doubt);
  for (std::size_t i = 0; i < twins.size(); ++i)
    for (std::string& note : notes_of(twins[i], pairs.stacks[i])) notes.push_back(std::move(note));
  compared.notes.insert(compared.notes.begin(), notes.begin(), notes.end());
  report_comparison(common, options, compared, std::filesystem::path(o.output) / "report", as_json(twins),
                    text);
}

}  // namespace

void add_match(CLI::App& program, Common& common) {
  CLI::App& verb = add_verb(
      program, common, "match",
      "Build the twin of each filmed cell: track the stack, simulate from the first packing, and "
      "compare both sides in one phase diagram. Writes the trajectories, the scenes and a report into "
      "a folder.",
      "twincell match frames/ CELL.toml -o twin/\n"
      "  twincell match gamma-0.9/ gamma-1.6/ -o twins/");
  takes_seed(verb, common);
  has_details(verb, "all compared numbers, with the parts of their errors and the causes");
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
         twin::twin_folder());
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
  add_locating_options(verb, o->twin.film.locating);
  verb.add_flag(
      "--trust-stated-drive", o->twin.film.trust_stated_drive,
      "Use the drive and the frames per cycle that the cell states, even if the plate or the bed in the film "
      "moves differently");
  verb.add_flag("--trust-stated-cell", o->twin.trust_stated_cell,
                "Use walls and origin that the cell states, even if the bed in the film cannot lie between "
                "them: a bed of two layers that stays a bead diameter away from a wall or the plate");
  verb.add_option("--range", o->twin.film.link.range_diameters,
                  "Largest distance of a bead from its predicted position, bead diameters, above 0, at most "
                  "10; default: 2");
  verb.add_option("--memory", o->twin.film.link.memory,
                  "Number of frames for which a bead may be missing, 0 to 1000; default: 3");
  add_phase_options(verb, o->twin.film.request.phase);
  add_comparing_flags(verb, o->flags);
  verb.callback([&common, o] { run(common, *o); });
}

}  // namespace twincell::cli
