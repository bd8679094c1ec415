// Fortini & Huang 2015, Table I: the parameters of the model, as in the preset.

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "core/json_text.hpp"
#include "reproduce/p1_scene.hpp"
#include "reproduce/reproduction.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/scene.hpp"

namespace twincell::reproduce {

namespace {

using nlohmann::json;

/// One row of the table: the same number for beads and walls.
struct Row {
  const char *key, *name, *unit;
  double printed;
};
constexpr std::array<Row, 5> kRows = {{{"k_n", "normal stiffness", "k_0", 1e6},
                                       {"k_t", "tangential stiffness", "k_0", 1e4},
                                       {"mu", "static friction", "1", 0.6},
                                       {"gamma_n", "normal damping", "gamma_0", 100},
                                       {"gamma_t", "tangential damping", "gamma_0", 100}}};

Target exactly(const std::string& name, double printed, double held) {
  return {name, fmt::format("{:g} exactly", printed), fmt::format("{}", held),
          judge(exact(held), printed, printed), ""};
}

Reproduction run(const Request&) {
  const sim::Scene scene = sim::read_scene_text(
      "preset = \"fortini-huang-2015\"\nbeads.layers = 20\ndrive.gamma = 1.0\n", "Table I");
  Reproduction r;
  r.title = "Fortini & Huang 2015, Table I: parameters of the model";
  r.complete = true;
  json measured = json::array();
  r.table = fmt::format("  {:<22} {:<8} {:>14} {:>14}\n", "", "", "bead-bead", "bead-wall");
  for (const Row& row : kRows) {
    const double bead = scene.contact.bead.required(row.key);
    const double wall = scene.contact.wall.at("bottom").required(row.key);
    r.targets.push_back(exactly(fmt::format("{}, bead-bead", row.name), row.printed, bead));
    for (const auto& [name, table] : scene.contact.wall)  // a wall that differs has its own line
      if (name == "bottom" || table.required(row.key) != wall)
        r.targets.push_back(exactly(fmt::format("{}, bead-{}", row.name, name == "bottom" ? "wall" : name),
                                    row.printed, table.required(row.key)));
    r.table += fmt::format("  {:<22} {:<8} {:>14g} {:>14g}\n", row.name, row.key, bead, wall);
    measured.push_back({{"coefficient", row.key}, {"unit", row.unit}, {"bead", bead}, {"wall", wall}});
  }
  // Values from section II of the paper.
  r.targets.push_back(exactly("moment of inertia, m sigma^2", 1.0 / 8,
                              scene.inertia_factor * scene.mass * scene.radius * scene.radius));
  r.targets.push_back(exactly("wall separation L_x, sigma", 20, scene.width));
  r.targets.push_back(exactly("frequency omega, 1/t_0", 1, scene.drive.omega));
  r.measured = json_text(measured);
  r.runs = "no run";
  r.conditions = p1_contact_conditions();
  return r;
}

}  // namespace

Reproducible p1_table1() {
  return {.name = "p1-table1",
          .what = "parameters of the model in the preset, compared with the paper",
          .run = run,
          .time_share = 0.1,
          .judges_again = true};
}

}  // namespace twincell::reproduce
