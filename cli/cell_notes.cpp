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
  constexpr double kPoor = 0.05;
  if (cell.scale_error_px && cell.pixels_per_sigma && *cell.scale_error_px > kPoor * *cell.pixels_per_sigma)
    note(common,
         fmt::format("camera.scale_error_px = {:g} is {:.2g} % of the scale; it is the standard error "
                     "of camera.pixels_per_sigma = {:g} in px, not in percent.",
                     *cell.scale_error_px, 100 * *cell.scale_error_px / *cell.pixels_per_sigma,
                     *cell.pixels_per_sigma));
}

}  // namespace twincell::cli
