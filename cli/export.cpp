// twincell export SCENE.toml --to lammps: writes the scene as the input of another program.
// twincell export TRAJECTORY --to xyz|…: writes a trajectory in the format of another program.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>

#include "analysis/observable/observable.hpp"
#include "cli/output.hpp"
#include "cli/scene_notes.hpp"
#include "cli/stack_info.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/escape.hpp"
#include "core/output_rules.hpp"
#include "core/plural.hpp"
#include "sim/lammps/export_lammps.hpp"
#include "sim/scene/read_scene.hpp"
#include "trajectory/foreign/export_trajectory.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::cli {

namespace {

constexpr const char* kDeck = "lammps";  ///< the word of --to for a scene

Product deck_folder() {
  return Product::whole_folder("a LAMMPS deck");
}

struct ExportOptions {
  std::string input, format, output, from, units = "sigma";
  std::size_t frame = 0;
  bool complete = false;
  std::vector<std::string> assignments;
};

void export_scene(const ExportOptions& o, const Common& common) {
  if (o.units != "sigma")
    throw ConfigError({"", 0, 0, "--units"}, "applies to a trajectory; a deck is in the units of the scene.");
  if (o.complete)
    throw ConfigError({"", 0, 0, "--complete"}, "applies to a trajectory; the input is a scene.");
  std::vector<std::string> assignments = with_seed(o.assignments, common);
  sim::Scene scene = sim::read_scene(o.input, assignments);
  protect_named_inputs(common, scene.named_files());
  note_units(common, scene);
  std::string otherwise;
  if (!scene.integrator_stated) {
    const double own = scene.steps_per_contact;
    assignments.emplace_back("time.integrator=verlet");
    scene = sim::read_scene(o.input, assignments);
    otherwise = fmt::format(
        "time.integrator is not set: the deck uses \"verlet\", LAMMPS's own integrator, at {:g} steps per "
        "contact, and simulate uses \"{}\" at {:g}; with --set time.integrator=verlet both use the same.",
        scene.steps_per_contact, sim::kDefaultIntegrator.word, own);
  }
  AtomicPath folder(o.output, deck_folder());
  ProgressBar settling(common, "settling");
  const sim::LammpsDeck deck = o.from.empty() ? sim::lammps_deck(scene, settling)
                                              : sim::lammps_deck(scene, H5mdReader(o.from), o.frame);
  write_text_file(folder.part() / sim::LammpsDeck::kInputName, deck.input);
  write_text_file(folder.part() / sim::LammpsDeck::kDataName, deck.data);
  folder.commit();
  if (!otherwise.empty()) note(common, otherwise);
  const std::string run_command =
      fmt::format("cd {} && lmp -in {}", shell_word(folder.final().string()), sim::LammpsDeck::kInputName);
  print_result(common,
               {{"output", folder.final().string()}, {"run", run_command}, {"import", deck.import_command}},
               fmt::format("{}\n  run     {}\n  import  {}\n", folder.final().string(), run_command,
                           deck.import_command));
}

/// q6 and |psi6| of the beads of a planar trajectory, by the neighbour rule of `analyze` without options.
BeadNumbers bond_orders(const TrajectoryInfo& info) {
  if (info.box.dimension != 2) return {};
  const double cutoff = analysis::neighbour_cutoff(info, {});
  return {{"q6", "psi6"}, [&info, cutoff](const Frame& frame) {
            analysis::BondOrder order =
                analysis::bond_order(analysis::find_neighbours(frame, info.box, cutoff));
            return std::vector{std::move(order.q6), std::move(order.psi6)};
          }};
}

/// A trajectory that notes whether beads are missing in the frames that are read.
class WatchedSource : public TrajectorySource {
 public:
  explicit WatchedSource(const TrajectorySource& of) : of_(of) {}
  [[nodiscard]] const TrajectoryInfo& info() const override { return of_.info(); }
  [[nodiscard]] std::size_t n_frames() const override { return of_.n_frames(); }
  [[nodiscard]] std::string name() const override { return of_.name(); }
  void read(std::size_t index, Frame& frame) const override {
    of_.read(index, frame);
    has_gaps_ = has_gaps_ || frame.n_present() < frame.position.size();
  }
  [[nodiscard]] bool has_gaps() const { return has_gaps_; }

 private:
  const TrajectorySource& of_;
  mutable bool has_gaps_ = false;
};

/// Whether programs that read the format take the place of a bead in the list of a frame for its identity.
bool identifies_by_order(const ForeignFormat& format) {
  return format.word == "xyz" || format.word == "lammps-dump" || format.word == "gsd";
}

void export_beads(const ExportOptions& o, const Common& common) {
  const auto refuse = [](const char* option, const char* why) { throw ConfigError({"", 0, 0, option}, why); };
  if (common.seed) refuse("--seed", "applies to a scene; the input is a trajectory.");
  if (!o.assignments.empty()) refuse("--set", "applies to a scene; the input is a trajectory.");
  if (!o.from.empty()) refuse("--from", "applies to a scene; the input is a trajectory.");
  const ForeignFormat& format = foreign_format(o.format, "--to");
  if (format.create == nullptr) refuse("--to", "this format is only read.");
  const Product product = format.folder
                              ? Product::whole_folder(fmt::format("a folder of {} files", format.word))
                              : Product{.name = fmt::format("a file in the format {}", format.word),
                                        .sign = format.mark.empty()         ? Product::Sign::none
                                                : format.mark_is_first_line ? Product::Sign::headings
                                                                            : Product::Sign::head,
                                        .mark = std::string(format.mark)};
  const std::filesystem::path output = require_output(o.output, product);
  const H5mdReader trajectory(o.input);
  const ExportUnits units = o.units == "mm" ? ExportUnits::laboratory(trajectory.info(), "--units")
                                            : ExportUnits::reduced(trajectory.info());
  const WatchedSource source(trajectory);
  std::vector<bool> left_out;
  if (o.complete) {
    ProgressBar looking(common, "looking for missing beads");
    left_out = incomplete_slots(trajectory, looking);
  }
  const auto n_left_out = static_cast<std::size_t>(std::count(left_out.begin(), left_out.end(), true));
  if (n_left_out > 0 && n_left_out == left_out.size())
    throw InputError({o.input, 0, 0, "--complete"}, "no bead is in all frames.");
  AtomicPath written(o.output, product);
  ProgressBar progress(common, "writing");
  const std::size_t frames = export_trajectory(source, format, units, written.part(), output.stem().string(),
                                               progress, bond_orders(trajectory.info()), left_out);
  written.commit();
  if (!o.complete && source.has_gaps() && identifies_by_order(format))
    note(common,
         "beads are missing in some frames, but MDAnalysis, HOOMD-blue and freud take the place of a bead in "
         "the list of a frame for its identity: --complete writes only the beads that are in all frames.");
  print_result(
      common,
      {{"output", o.output},
       {"format", format.word},
       {"frames", frames},
       {"beads", trajectory.info().n_beads - n_left_out},
       {"left_out", n_left_out},
       {"length_unit", units.length_unit},
       {"time_unit", units.time_unit}},
      fmt::format("{} of {}{}, lengths in {}, times in {}\n{}\n", plural(frames, "frame"),
                  plural(trajectory.info().n_beads - n_left_out, "bead"),
                  n_left_out > 0 ? fmt::format(" ({} missing in some frames left out)", n_left_out) : "",
                  units.length_unit, units.time_unit, o.output));
}

void run(const ExportOptions& o, const Common& common) {
  std::error_code error;
  if (!std::filesystem::exists(o.input, error))
    throw InputError({o.input, 0, 0, ""}, "the file does not exist.");
  const bool beads = is_trajectory(o.input);
  if (!beads && o.format != kDeck)
    throw ConfigError(
        {o.input, 0, 0, "--to"},
        fmt::format("only a trajectory (H5MD) is written as {}; a scene is written as {}.", o.format, kDeck));
  if (beads && o.format == kDeck)
    throw ConfigError(
        {o.input, 0, 0, "--to"},
        fmt::format("{} is for a scene, whose start may be a frame of this trajectory (--from); "
                    "for the beads of a trajectory: {}.",
                    kDeck, written_formats()));
  if (beads)
    export_beads(o, common);
  else
    export_scene(o, common);
}

}  // namespace

void add_export(CLI::App& program, Common& common) {
  auto o = std::make_shared<ExportOptions>();
  CLI::App& verb = add_verb(program, common, "export",
                            "Export a trajectory in the format of another program, or a scene as a LAMMPS "
                            "deck, with the commands that run it and import its result.",
                            "twincell export sim.h5 --to xyz -o sim.xyz");
  takes_seed(verb, common);
  verb.add_option("input", o->input, "Trajectory (H5MD) or scene file (TOML, docs/scene.md)")->required();
  std::string formats;
  std::vector<std::string> words = {kDeck};
  for (const ForeignFormat* format : foreign_formats())
    if (format->create != nullptr) {
      formats += fmt::format("; {}: {}", format->word, format->help);
      words.emplace_back(format->word);
    }
  verb.add_option("--to", o->format,
                  fmt::format("Format (docs/formats.md). lammps: deck of a scene{}", formats))
      ->required()
      ->check(CLI::IsMember(words))
      ->option_text("WORD");
  // What may be replaced depends on the format; run() checks it.
  common.outputs.push_back(
      {verb.add_option("-o,--output", o->output, "File to write; for lammps and vtk: folder")->required(),
       nullptr, deck_folder()});
  verb.add_option(
          "--units", o->units,
          "Units of a trajectory; sigma: bead diameter and t0 = sqrt(sigma/g); mm: mm and s, where the "
          "trajectory states its scale")
      ->check(CLI::IsMember({"sigma", "mm"}))
      ->capture_default_str();
  verb.add_flag("--complete", o->complete,
                "Write only the beads that are in all frames of a trajectory, for programs that take the "
                "order of the beads for their identity");
  verb.add_option("--set", o->assignments,
                  "Set a key of the scene, as section.key=value; overrides the file; may be repeated")
      ->take_all();
  CLI::Option* from = verb.add_option("--from", o->from,
                                      "Trajectory (H5MD) of this scene; the deck starts from its frame "
                                      "--frame; default: the start of the scene");
  verb.add_option("--frame", o->frame, "Index of the frame of --from, from 0; default: 0")->needs(from);
  verb.callback([o, &common] { run(*o, common); });
}

}  // namespace twincell::cli
