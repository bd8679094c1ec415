#include "cli/scene_notes.hpp"

#include "sim/scene/unit_doubts.hpp"

namespace twincell::cli {

void note_units(const Common& common, const sim::Scene& scene) {
  for (const std::string& doubt : sim::doubtful_units(scene)) note(common, doubt);
}

}  // namespace twincell::cli
