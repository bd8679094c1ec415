#include "cli/scene_notes.hpp"

#include <algorithm>

#include "core/key_assignments.hpp"
#include "sim/scene/unit_doubts.hpp"
#include "sim/start/start.hpp"

namespace twincell::cli {

void note_units(const Common& common, const sim::Scene& scene) {
  for (const std::string& doubt : sim::doubtful_units(scene)) note(common, doubt);
}

void note_seed(const Common& common, const sim::Scene& scene, const std::vector<std::string>& assignments) {
  const bool given = std::any_of(assignments.begin(), assignments.end(), [](const std::string& assignment) {
    return assigned_key(assignment) == "start.seed";
  });
  if (given && !sim::has_chance(scene))
    note(common,
         "the seed has no effect: nothing in the start is drawn at random, and every start.seed gives the "
         "same run.");
}

}  // namespace twincell::cli
