#include "imaging/cell/plate_row.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/constants.hpp"
#include "core/quantile.hpp"
#include "imaging/preprocess/straight_bars.hpp"

namespace twincell::imaging {

namespace {

constexpr double kPlateQuantile = 0.2;  // of the heights of the columns: beads hide the plate in most of them
constexpr float kHalf = 0.5F;

double value_at(const std::vector<float>& values, double share) {
  return lower_quantile(values, share);
}

/// Values of a row as float, negated where the plate is the bright part.
void read_row(const cv::Mat& grey, int y, bool bright, cv::Mat1f& row) {
  grey.row(y).convertTo(row, CV_32F, bright ? -1 : 1);
}

/// Height of the upper side of a bar above the lowest row; NaN if there is none.
/// \param light, dark levels, negated where the bar is the bright part
double bar_height_px(const cv::Mat& grey, bool bright, double light, double dark) {
  constexpr double kReach = 12;  // px; beads bend within this diameter
  const double per_level = (bright ? 1 : -1) / (light - dark);
  cv::Mat1f darkness;
  grey.convertTo(darkness, CV_32F, per_level, light / (light - dark));
  std::vector<float> highest;
  for (const StraightBar& bar : straight_bars(darkness, Border::bottom, kReach)) {
    std::vector<float> heights;
    for (const BarLine& line : bar.lines) {
      const int y = grey.rows - 1 - line.light;
      const float here = darkness(y, line.number), below = darkness(y + 1, line.number);
      heights.push_back(static_cast<float>(line.light) - (kHalf - here) / std::max(below - here, 1e-6F));
    }
    if (heights.size() > highest.size()) highest = std::move(heights);
  }
  return highest.empty() ? kNaN : value_at(highest, kPlateQuantile);
}

/// The heights without those of the stretches of columns in which something bright lies on the plate, such as
/// the digits of a frame counter: edges that lie clearly below those of most stretches.
/// \param at the column of each height
std::vector<float> heights_of_plate(const std::vector<float>& edges, const std::vector<std::size_t>& at,
                                    std::size_t columns) {
  constexpr std::size_t kStretches = 8;
  constexpr std::size_t kMinEdges = 3;
  constexpr double kBelow_px = 4, kBelow = 0.02;  // of the width: a plate may be turned
  std::array<std::vector<float>, kStretches> stretches;
  for (std::size_t k = 0; k < edges.size(); ++k) stretches[at[k] * kStretches / columns].push_back(edges[k]);
  std::vector<float> lows;
  for (const std::vector<float>& s : stretches)
    if (s.size() >= kMinEdges) lows.push_back(static_cast<float>(value_at(s, kPlateQuantile)));
  const double least =
      lows.empty() ? 0 : value_at(lows, 0.5) - std::max(kBelow_px, kBelow * static_cast<double>(columns));
  std::vector<float> heights;
  for (const std::vector<float>& s : stretches)
    if (s.size() < kMinEdges || value_at(s, kPlateQuantile) >= least)
      heights.insert(heights.end(), s.begin(), s.end());
  return heights;
}

}  // namespace

double plate_height_px(const cv::Mat& grey, bool bright) {
  constexpr int kBorder = 3, kSampledRows = 64;  // px; rows that give the levels
  constexpr double kMinContrast = 0.4;           // of light and plate, fraction of that of light and dark
  constexpr double kLightQuantile = 0.95;
  constexpr double kMinShareOfColumns = 0.1;  // that show the plate
  constexpr std::size_t kMinColumns = 8;
  if (grey.rows < 2 * kBorder || grey.cols < static_cast<int>(kMinColumns)) return kNaN;
  // Levels: the light is the upper end of the values of some rows, the plate the middle of the lowest rows.
  cv::Mat1f row;
  std::vector<float> all, lowest;
  const int stride = std::max(1, grey.rows / kSampledRows);
  for (int y = 0; y < grey.rows; y += stride) {
    read_row(grey, y, bright, row);
    all.insert(all.end(), row.begin(), row.end());
  }
  for (int y = grey.rows - kBorder; y < grey.rows; ++y) {
    read_row(grey, y, bright, row);
    lowest.insert(lowest.end(), row.begin(), row.end());
  }
  const double light = value_at(all, kLightQuantile), dark = value_at(all, 1 - kLightQuantile),
               plate = value_at(lowest, 0.5);
  if (!(light > dark)) return kNaN;
  if (!(light - plate > kMinContrast * (light - dark))) return bar_height_px(grey, bright, light, dark);
  const auto half = static_cast<float>(0.5 * (light + plate));
  // Columns: distance of the first crossing from below.
  const auto columns = static_cast<std::size_t>(grey.cols);
  std::vector<float> below(columns), heights;
  std::vector<std::size_t> at;  // columns of the heights
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
        else {
          heights.push_back(static_cast<float>(h) - (v - half) / std::max(v - below[x], 1e-6F));
          at.push_back(x);
        }
      }
      below[x] = v;
    }
    // The plate has been passed by the most open columns; the rest are beads and walls.
    if (heights.size() > columns / 2 && h > 2 * value_at(heights, kPlateQuantile) + kBorder) break;
  }
  if (heights.size() < std::max(kMinColumns, static_cast<std::size_t>(kMinShareOfColumns * grey.cols)) ||
      no_plate > columns / 10)
    return kNaN;
  return value_at(heights_of_plate(heights, at, columns), kPlateQuantile);
}

}  // namespace twincell::imaging
