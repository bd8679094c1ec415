#include "sim/scene/unit_doubts.hpp"

#include <fmt/format.h>

#include "trajectory/unit_checks.hpp"

namespace twincell::sim {

std::vector<std::string> doubtful_units(const Scene& scene) {
  if (!scene.scale.sigma_m || !(scene.g() > 0)) return {};
  std::vector<std::string> doubts = implausible_numbers(shaken_cell(scene.scale, scene.drive));
  if (scene.scale.gravity_m_s2 && scene.g() != 1)
    doubts.insert(
        doubts.begin(),
        fmt::format("cell.gravity = {:g} is in units of scale.gravity_m_s2: gravity is {:.4g} m/s^2.",
                    scene.g(), scene.g() * *scene.scale.gravity_m_s2));
  return doubts;
}

}  // namespace twincell::sim
