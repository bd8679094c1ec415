// twincell keys [FILE]: prints all keys of CELL.toml, of a scene, of a plan and of CAMERA.toml.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <memory>

#include "cli/output.hpp"
#include "cli/verb.hpp"
#include "imaging/camera/camera_keys.hpp"
#include "imaging/cell/cell_keys.hpp"
#include "sim/scene/scene_keys.hpp"
#include "sweep/plan_keys.hpp"

namespace twincell::cli {

namespace {

/// All files with keys, in the order of the page.
std::array<const KeyTable*, 4> tables() {
  return {&imaging::cell_keys(), &sim::scene_keys(), &sweep::plan_keys(), &imaging::camera_keys()};
}

nlohmann::json json_of(const KeyTable& table) {
  const auto rules = rules_of(table);
  nlohmann::json list = nlohmann::json::array();
  for (const KeyRow& row : table.rows)
    list.push_back({{"key", row.key},
                    {"unit", row.unit},
                    {"range", range_of(rules, row.key)},
                    {"default", row.absent},
                    {"example", row.example},
                    {"meaning", row.meaning}});
  return list;
}

void run(const Common& common, const std::string& name, bool markdown) {
  std::string text =
      markdown
          ? "# Keys of the files\n\n`twincell keys --markdown` prints this page, `twincell keys scene` one "
            "part of it. The ranges are those that the readers check. An unknown key is an error, and the "
            "message suggests the nearest known one. `--set section.key=value` on the command line "
            "overrides a file.\n"
          : "";
  nlohmann::json document = nlohmann::json::object();
  for (const KeyTable* table : tables()) {
    if (!name.empty() && table->name != name) continue;
    if (common.json)
      document[table->name] = json_of(*table);
    else
      text += (text.empty() ? "" : "\n") + (markdown ? key_markdown(*table) : key_text(*table));
  }
  print_result(common, document, text);
}

}  // namespace

void add_keys(CLI::App& program, Common& common) {
  struct Chosen {
    std::string name;
    bool markdown = false;
  };
  auto chosen = std::make_shared<Chosen>();
  CLI::App& verb =
      add_verb(program, common, "keys",
               "Print all keys of CELL.toml, of a scene, of a plan and of CAMERA.toml with unit, "
               "range, default, example and meaning.",
               "twincell keys scene");
  std::vector<std::string> names;
  for (const KeyTable* table : tables()) names.push_back(table->name);
  verb.add_option("file", chosen->name, "Kind of file; default: all")->check(CLI::IsMember(names));
  verb.add_flag("--markdown", chosen->markdown, "Print tables in Markdown, as in docs/keys.md");
  verb.callback([chosen, &common] { run(common, chosen->name, chosen->markdown); });
}

}  // namespace twincell::cli
