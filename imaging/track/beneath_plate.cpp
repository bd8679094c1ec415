#include "imaging/track/beneath_plate.hpp"

#include <cmath>

namespace twincell::imaging {

std::vector<char> beneath_plate(const LinkedDetections& linked, const CellDescription& cell,
                                const PixelFrame& pixel_frame) {
  constexpr double kLeastHeight = 0.3;  // of a centre above the plate, radii
  constexpr double kShareOfFrames = 0.9, kMaxShareOfBeads = 0.05;
  std::vector<char> in_plate(linked.tracks.size(), 0);
  const auto drive = cell.drive();
  if (!drive || drive->axis != Axis::z || !linked.phases.locked() || !cell.origin) return in_plate;
  std::vector<std::int64_t> below(linked.tracks.size(), 0), seen(linked.tracks.size(), 0);
  for (std::size_t f = 0; f < linked.frames.size(); ++f) {
    const auto cycles = linked.phases.cycles_at(static_cast<std::int64_t>(f));
    if (!cycles) continue;
    const double plate = drive->displacement(*cycles - std::floor(*cycles));
    for (const TrackedBead& b : linked.frames[f]) {
      const auto t = static_cast<std::size_t>(b.track);
      ++seen[t];
      const double radius =
          linked.tracks[t].radius_px / cell.disc_width_px.value_or(pixel_frame.pixels_per_sigma);
      if (pixel_frame.cell_from_pixel({b.x_px, b.y_px}).z() < plate + kLeastHeight * radius) ++below[t];
    }
  }
  double all = 0, excluded = 0;
  for (std::size_t t = 0; t < seen.size(); ++t) {
    in_plate[t] =
        below[t] > 0 && static_cast<double>(below[t]) >= kShareOfFrames * static_cast<double>(seen[t]);
    all += static_cast<double>(seen[t]);
    if (in_plate[t] != 0) excluded += static_cast<double>(seen[t]);
  }
  if (excluded > kMaxShareOfBeads * all) in_plate.assign(in_plate.size(), 0);
  return in_plate;
}

}  // namespace twincell::imaging
