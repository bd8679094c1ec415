#include "cli/scene_notes.hpp"

#include <fmt/format.h>

#include "trajectory/unit_checks.hpp"

namespace twincell::cli {

void note_units(const Common& common, const sim::Scene& scene) {
  if (!scene.scale.sigma_m || !(scene.g() > 0)) return;
  if (scene.scale.gravity_m_s2 && scene.g() != 1)
    note(common,
         fmt::format("cell.gravity = {:g} is in units of scale.gravity_m_s2: gravity is {:.4g} m/s^2.",
                     scene.g(), scene.g() * *scene.scale.gravity_m_s2));
  for (const std::string& doubt : implausible_numbers(shaken_cell(scene.scale, scene.drive)))
    note(common, doubt);
}

}  // namespace twincell::cli
