#pragma once
/// \file
/// Table of the keys of a scene, for docs/keys.md and `twincell keys scene`.

#include "core/key_table.hpp"

namespace twincell::sim {

/// All spellings of all keys that read_scene() accepts. [contact] stands for the tables of walls as well.
const KeyTable& scene_keys();

}  // namespace twincell::sim
