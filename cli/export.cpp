// twincell export SCENE.toml --to lammps: writes the scene as the input of another program.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/output.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/escape.hpp"
#include "sim/lammps/export_lammps.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::cli {

namespace {

Product deck_folder() {
  return Product::whole_folder("a LAMMPS deck");
}

struct ExportOptions {
  std::string scene, format, output, from;
  std::size_t frame = 0;
  std::vector<std::string> assignments;
};

void run(const ExportOptions& o, const Common& common) {
  std::vector<std::string> assignments = with_seed(o.assignments, common);
  sim::Scene scene = sim::read_scene(o.scene, assignments);
  std::string otherwise;
  if (!scene.integrator_stated) {
    const double own = scene.steps_per_contact;
    assignments.emplace_back("time.integrator=verlet");
    scene = sim::read_scene(o.scene, assignments);
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

}  // namespace

void add_export(CLI::App& program, Common& common) {
  auto o = std::make_shared<ExportOptions>();
  CLI::App& verb = add_verb(program, common, "export",
                            "Export a scene as the input of another program. Writes a folder with the input "
                            "deck, and prints the commands that run it and import its result.",
                            "twincell export scene.toml --to lammps -o deck/");
  verb.add_option("scene", o->scene, "Scene file (TOML, docs/scene.md)")->required();
  verb.add_option("--to", o->format, "Program for which the deck is written")
      ->required()
      ->check(CLI::IsMember({"lammps"}));
  writes(common, verb, verb.add_option("-o,--output", o->output, "Folder for the deck")->required(),
         deck_folder());
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
