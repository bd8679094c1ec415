#include "cli/cell_notes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "trajectory/unit_checks.hpp"

namespace twincell::cli {

void note_cell(const Common& common, const imaging::CellDescription& cell, const std::string& file) {
  if (!cell.included.overridden.empty())
    note(common, fmt::format("values in {} take precedence over those measured in {}: {}", file,
                             cell.included.file.string(), fmt::join(cell.included.overridden, ", ")));
  for (const std::string& doubt : implausible_numbers(cell.shaken_cell())) note(common, doubt);
}

}  // namespace twincell::cli
