#pragma once
/// \file
/// Table of the keys of a CAMERA.toml, for docs/keys.md and `twincell keys camera`.

#include "core/key_table.hpp"

namespace twincell::imaging {

/// The options of camera_option_list(), and the seed.
const KeyTable& camera_keys();

}  // namespace twincell::imaging
