// twincell export SCENE.toml --to lammps: the scene as another program's input.

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
        "time.integrator is not stated: the deck takes \"verlet\", LAMMPS's own, at {:g} steps per contact, "
        "where simulate takes \"{}\" at {:g}; with --set time.integrator=verlet both do the same.",
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
  CLI::App& verb = add_verb(program, common, "export", "A scene as the input of another program",
                            "twincell export scene.toml --to lammps -o deck/");
  verb.add_option("scene", o->scene, "Scene (TOML, docs/scene.md)")->required();
  verb.add_option("--to", o->format, "Program")->required()->check(CLI::IsMember({"lammps"}));
  writes(common, verb, verb.add_option("-o,--output", o->output, "Folder to write")->required(),
         deck_folder());
  verb.add_option("--set", o->assignments, "section.key=value, over the scene's own; may be repeated")
      ->take_all();
  CLI::Option* from =
      verb.add_option("--from", o->from, "Trajectory (H5MD) of the scene: begin at one of its frames");
  verb.add_option("--frame", o->frame, "Which frame of it")->needs(from);
  verb.callback([o, &common] { run(*o, common); });
}

}  // namespace twincell::cli
