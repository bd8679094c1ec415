#pragma once
/// \file
/// Notes on a cell description that `track` and `match` print.

#include <string>

#include "cli/output.hpp"
#include "imaging/cell/cell.hpp"

namespace twincell::cli {

/// Notes the values of the cell that replace measured ones, and those whose units are doubtful.
/// \param file CELL.toml, for the notes
void note_cell(const Common& common, const imaging::CellDescription& cell, const std::string& file);

}  // namespace twincell::cli
