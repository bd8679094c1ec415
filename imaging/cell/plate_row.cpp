#include "imaging/cell/plate_row.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace twincell::imaging {

namespace {

double quantile(std::vector<float>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Values of a row as float, negated where the plate is the bright part.
void read_row(const cv::Mat& grey, int y, bool bright, cv::Mat1f& row) {
  grey.row(y).convertTo(row, CV_32F, bright ? -1 : 1);
}

}  // namespace

double plate_height_px(const cv::Mat& grey, bool bright) {
  constexpr int kBorder = 3, kSampled = 64;
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kLeastContrast = 0.4, kLightAt = 0.95, kPlateAt = 0.2, kFewestShare = 0.1;
  constexpr std::size_t kFewest = 8;
  if (grey.rows < 2 * kBorder || grey.cols < static_cast<int>(kFewest)) return kNaN;
  // Levels: the light is the upper end of the values of some rows, the plate the middle of the lowest rows.
  cv::Mat1f row;
  std::vector<float> all, lowest;
  const int stride = std::max(1, grey.rows / kSampled);
  for (int y = 0; y < grey.rows; y += stride) {
    read_row(grey, y, bright, row);
    all.insert(all.end(), row.begin(), row.end());
  }
  for (int y = grey.rows - kBorder; y < grey.rows; ++y) {
    read_row(grey, y, bright, row);
    lowest.insert(lowest.end(), row.begin(), row.end());
  }
  const double light = quantile(all, kLightAt), dark = quantile(all, 1 - kLightAt),
               plate = quantile(lowest, 0.5);
  if (!(light - plate > kLeastContrast * (light - dark)) || !(light > dark)) return kNaN;
  const auto half = static_cast<float>(0.5 * (light + plate));
  // Columns: distance of the first crossing from below.
  const auto columns = static_cast<std::size_t>(grey.cols);
  std::vector<float> below(columns), heights;
  std::vector<std::uint8_t> open(columns, 1);
  std::size_t left = columns, no_plate = 0;
  for (int h = 0; h < grey.rows && left > 0; ++h) {
    read_row(grey, grey.rows - 1 - h, bright, row);
    for (std::size_t x = 0; x < columns; ++x) {
      if (open[x] == 0) continue;
      const float v = row(0, static_cast<int>(x));
      if (v >= half) {
        open[x] = 0;
        --left;
        if (h < kBorder)
          ++no_plate;
        else
          heights.push_back(static_cast<float>(h) - (v - half) / std::max(v - below[x], 1e-6F));
      }
      below[x] = v;
    }
    // The plate has been passed by the most open columns; the rest are beads and walls.
    if (heights.size() > columns / 2 && h > 2 * quantile(heights, kPlateAt) + kBorder) break;
  }
  if (heights.size() < std::max(kFewest, static_cast<std::size_t>(kFewestShare * grey.cols)) ||
      no_plate > columns / 10)
    return kNaN;
  return quantile(heights, kPlateAt);
}

}  // namespace twincell::imaging
