#include "imaging/track/inside_cell.hpp"

#include <fmt/format.h>

#include <string>

#include "core/error.hpp"

namespace twincell::imaging {

InsideCell::InsideCell(const CellDescription& cell, cv::Size picture) : cell_(cell) {
  if (cell.origin && cell.pixels_per_sigma) frame_ = cell.pixel_frame(picture);
  if (const std::optional<Drive> drive = cell.drive())
    lowest_ = drive->axis == Axis::z ? -drive->displacement_bound() : 0;
}

bool InsideCell::operator()(PixelPoint centre) const {
  if (!frame_) return true;
  const Vec3 r = frame_->cell_from_pixel(centre);
  return !(cell_.width && (r.x() < 0 || r.x() > *cell_.width)) &&
         !(cell_.height && r.z() > *cell_.height + 0.5) && !(lowest_ && r.z() < *lowest_);
}

void require_some_inside(const CellDescription& cell, std::size_t inside, std::size_t outside,
                         bool of_table) {
  if (inside == 0 && outside == 0 && of_table) throw InputError(Where{}, "The table has no bead.");
  if (inside == 0 && outside == 0)
    throw InputError(
        Where{},
        "No bead was located in any frame; --dark, --bright or --diameter may help, and twincell "
        "locate STACK --view page.html shows what was considered.");
  if (inside >= outside) return;
  throw ConfigError(
      Where{.file = {}, .key = "camera.origin_px"},
      fmt::format("is {:g}, {:g}, but {} the {} located beads {} inside the cell{}{}; correct the origin, "
                  "camera.pixels_per_sigma = {:g}, or the size of the cell, {}.",
                  cell.origin->x_px, cell.origin->y_px,
                  inside == 0 ? std::string("none of") : fmt::format("only {} of", inside), inside + outside,
                  inside == 0 ? "lies" : "lie", cell.width ? fmt::format(" of width {:g}", *cell.width) : "",
                  cell.height ? fmt::format(" and height {:g}", *cell.height) : "", *cell.pixels_per_sigma,
                  of_table ? "or write the table in px with y downwards"
                           : "or select a part of the picture (--roi)"));
}

}  // namespace twincell::imaging
