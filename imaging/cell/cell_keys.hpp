#pragma once
/// \file
/// Table of the keys of a CELL.toml, for docs/keys.md and `twincell keys cell`.

#include "core/key_table.hpp"

namespace twincell::imaging {

/// All spellings of all keys that read_cell() accepts.
const KeyTable& cell_keys();

}  // namespace twincell::imaging
