#pragma once
/// \file
/// Table of the keys of a plan, for docs/keys.md and `twincell keys plan`.

#include "core/key_table.hpp"

namespace twincell::sweep {

/// All keys that read_plan() accepts; one axis stands for all.
const KeyTable& plan_keys();

}  // namespace twincell::sweep
