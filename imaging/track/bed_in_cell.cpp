#include "imaging/track/bed_in_cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/median.hpp"
#include "core/quantile.hpp"
#include "trajectory/boundary_words.hpp"

namespace twincell::imaging {

BedInCell::BedInCell(TrajectorySink& writer, const TrajectoryInfo& info, const CellDescription& cell,
                     int width_px, int height_px)
    : writer_(writer), info_(info) {
  if (!cell.origin || !cell.pixels_per_sigma) return;
  if (info.box.boundary[0] == Boundary::wall) width_ = cell.width.value_or(0);
  if (info.box.boundary[0] == Boundary::periodic) period_ = cell.width.value_or(0);
  picture_left_ = -cell.origin->x_px / *cell.pixels_per_sigma;
  picture_right_ = picture_left_ + width_px / *cell.pixels_per_sigma;
  plate_ = info.columns.plate_height && cell.origin->y_px < height_px;
}

void BedInCell::append(const Frame& frame) {
  constexpr std::size_t kMinBeads = 5;
  double left = HUGE_VAL, right = -HUGE_VAL, low = HUGE_VAL;
  std::size_t n = 0;
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    if (!frame.present(i) || !std::isfinite(frame.position[i].x()) || !std::isfinite(frame.position[i].z()))
      continue;
    const double radius = radius_of(info_.radius, i);
    left = std::min(left, frame.position[i].x() - radius);
    right = std::max(right, frame.position[i].x() + radius);
    low = std::min(low, frame.position[i].z() - radius);
    ++n;
  }
  if (n >= kMinBeads) {
    beads_.push_back(static_cast<double>(n));
    left_.push_back(left);
    right_.push_back(width_ + period_ - right);
    if (plate_ && std::isfinite(frame.plate_height)) below_.push_back(low - frame.plate_height);
  }
  writer_.append(frame);
}

bool BedInCell::is_layered() const {
  constexpr double kMinLayers = 2;
  if (width_ <= 0 || beads_.empty()) return false;
  // Over the width of the bed, not that of the cell, which may be what is wrong.
  const double bed = width_ - upper_median(left_) - upper_median(right_);
  return upper_median(beads_) >= kMinLayers * std::min(bed, width_);
}

bool BedInCell::stops_at_periods() const {
  constexpr double kMinLayers = 4;                     // of fewer, none may lie across the sides
  constexpr double kCrossing = 0.2, kOfFrames = 0.05;  // bead diameters; in this share of the frames at least
  if (period_ <= 0 || upper_median(beads_) < kMinLayers * period_) return false;
  return lower_quantile(left_, kOfFrames) > -kCrossing && lower_quantile(right_, kOfFrames) > -kCrossing;
}

std::vector<BedInCell::Finding> BedInCell::findings() const {
  constexpr double kMaxGap = 0.35;        // bead diameters
  constexpr double kRestQuantile = 0.05;  // of the gaps above the plate: the bed rests on it
  constexpr double kCut = 1;  // bead diameters from the border of the picture, within which it cuts the bed
  constexpr std::size_t kMinFrames = 10;
  std::vector<Finding> all;
  if (left_.size() < kMinFrames) return all;
  const auto side = [&](const char* wall, double gap) {
    if (gap > kMaxGap)
      all.push_back(
          {fmt::format("the beads come no closer to the {} wall than {:.2f} bead diameters: the wall is "
                       "elsewhere than cell.width and camera.origin_px state, or the picture does not show "
                       "the beads beside it",
                       wall, gap),
           gap});
    else if (gap < -kMaxGap)
      all.push_back({fmt::format("the beads reach {:.2f} bead diameters into the {} wall: it is elsewhere "
                                 "than cell.width and camera.origin_px state",
                                 -gap, wall),
                     -gap});
  };
  if (is_layered()) {
    const double left = upper_median(left_), right = upper_median(right_);
    if (picture_left_ <= 0 || left > picture_left_ + kCut) side("left", left);
    if (picture_right_ >= width_ || width_ - right < picture_right_ - kCut) side("right", right);
  }
  if (stops_at_periods())
    all.push_back({fmt::format("the beads stop at the {} sides of the cell as at walls",
                               boundary_word(Boundary::periodic)),
                   0});
  if (below_.size() < kMinFrames) return all;
  const double gap = upper_quantile(below_, kRestQuantile);
  if (gap > kMaxGap)
    all.push_back(
        {fmt::format("the lowest bead comes no closer to the plate than {:.2f} bead diameters: the plate is "
                     "elsewhere than camera.origin_px and the phases state, or the picture is upside down",
                     gap),
         gap});
  else if (gap < -kMaxGap)
    all.push_back({fmt::format("beads are up to {:.2f} bead diameters beneath the plate: it is elsewhere "
                               "than camera.origin_px and the phases state",
                               -gap),
                   -gap});
  return all;
}

std::vector<std::string> BedInCell::doubts() const {
  std::vector<std::string> all;
  for (const Finding& f : findings()) all.push_back(f.sentence + ".");
  return all;
}

std::string BedInCell::contradiction() const {
  constexpr double kImpossible = 1;  // bead diameters
  if (!is_layered()) return {};
  for (const Finding& f : findings())
    if (f.gap > kImpossible) return f.sentence;
  return {};
}

}  // namespace twincell::imaging
