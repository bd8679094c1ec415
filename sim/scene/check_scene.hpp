#pragma once
/// \file
/// Checks of a scene that involve several of its tables.

#include "core/config.hpp"
#include "sim/scene/scene.hpp"

namespace twincell::sim {

/// \pre all tables are read, and the drive is solved
/// \param root the whole scene, whose keys are named
/// \throws ConfigError naming a key if beads do not fit into the cell or meet two images of another, if they
/// leave the cell for ever, if the drive moves nothing or contradicts another table, or if a table is about a
/// wall that the cell does not have
void check_scene(const Scene& s, const ConfigSection& root);

}  // namespace twincell::sim
