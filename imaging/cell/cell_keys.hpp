#pragma once
/// \file
/// Table of the keys of a CELL.toml, for docs/cell.md and `twincell new --keys`.
/// tests/unit/imaging/cell_keys_test.cpp compares it with the reader (cell.hpp) and with the page.

#include <string>
#include <vector>

namespace twincell {

/// One spelling of a quantity.
struct CellKey {
  const char* key;           ///< "camera.pixels_per_sigma"
  const char* unit;          ///< "px"; empty for words, switches and counts
  const char* range;         ///< "1 ... 10000"
  const char* absent;        ///< what happens if no spelling of the quantity is stated
  const char* example;       ///< a valid TOML value
  const char* out_of_range;  ///< a TOML value that is refused
  const char* meaning;       ///< a clause; empty: another spelling of the quantity above
};
/// All keys in the order of the page, grouped by table.
const std::vector<CellKey>& cell_keys();

/// The table in Markdown, one row per key.
std::string cell_keys_markdown();

}  // namespace twincell
