#include "imaging/preprocess/straight_bars.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/median.hpp"

namespace twincell::imaging {

cv::Point pixel_from(Border border, cv::Size size, int line, int i) {
  switch (border) {
    case Border::left:
      return {i, line};
    case Border::right:
      return {size.width - 1 - i, line};
    case Border::bottom:
      return {line, size.height - 1 - i};
    case Border::top:
      break;
  }
  return {line, i};
}

int line_length(Border border, cv::Size size) {
  return border == Border::bottom || border == Border::top ? size.height : size.width;
}

int line_count(Border border, cv::Size size) {
  return border == Border::bottom || border == Border::top ? size.width : size.height;
}

namespace {

constexpr int kMinLightWidth = 3;             // px; of the light between the border and a bar
constexpr int kMinBarWidth = 4;               // px
constexpr float kBarDarkness = 0.5F;          // of a bar
constexpr double kMaxOffset = 0.4;            // px; of the outer side from its local median
constexpr double kMinStraightShare = 0.8;     // of the lines along a bar
constexpr double kMinCrossedShare = 1.0 / 3;  // of the lines of a side, which a bar crosses
constexpr double kMinLength = 4;              // bead diameters

/// The first dark run behind a light border.
std::optional<BarLine> bar_line(const cv::Mat1f& d, Border border, int number) {
  const cv::Point start = pixel_from(border, d.size(), number, 0),
                  next = pixel_from(border, d.size(), number, 1);
  const auto step = (next.y - start.y) * static_cast<std::ptrdiff_t>(d.step1()) + (next.x - start.x);
  const float* const from = &d(start);
  const int n = line_length(border, d.size());
  int first = 0;
  const float* at = from;
  for (; first < n && *at < kBarDarkness; ++first) at += step;
  if (first < kMinLightWidth) return std::nullopt;
  int light = first;
  for (; light < n && *at >= kBarDarkness; ++light) at += step;
  if (light == n || light - first < kMinBarWidth) return std::nullopt;
  const float before = from[(first - 1) * step], rise = from[first * step] - before;
  return BarLine{.number = number,
                 .first = first,
                 .light = light,
                 .side = first - 1 + static_cast<double>((kBarDarkness - before) / std::max(rise, 1e-6F))};
}

/// The lines at which the outer side is straight: it lies at the median of its neighbours within a radius.
std::vector<BarLine> straight_lines(const std::vector<BarLine>& found, int reach) {
  std::vector<BarLine> straight;
  std::vector<double> near;
  std::size_t begin = 0, end = 0;
  for (const BarLine& line : found) {
    while (found[begin].number < line.number - reach) ++begin;
    while (end < found.size() && found[end].number <= line.number + reach) ++end;
    near.clear();
    for (std::size_t j = begin; j < end; ++j) near.push_back(found[j].side);
    if (std::abs(line.side - upper_median(near)) <= kMaxOffset) straight.push_back(line);
  }
  return straight;
}

/// A bead that touches the bar from inside seems to widen it, so that the narrow lines show its width.
int width_of(const std::vector<BarLine>& lines) {
  std::vector<int> widths;
  widths.reserve(lines.size());
  for (const BarLine& line : lines) widths.push_back(line.light - line.first);
  const auto quarter = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 4);
  std::nth_element(widths.begin(), quarter, widths.end());
  return *quarter;
}

}  // namespace

std::vector<StraightBar> straight_bars(const cv::Mat1f& d, Border border, double diameter_px) {
  constexpr double kMinDiameter = 8;  // px
  constexpr int kSampling = 8;        // every 8th line: most pictures have no bars, as a few lines show
  constexpr double kMaxSlope = 0.1;   // px per line
  const int count = line_count(border, d.size());
  if (diameter_px < kMinDiameter || line_length(border, d.size()) < 2 * kMinLightWidth) return {};
  const double shortest = std::max(kMinLength * diameter_px, kMinCrossedShare * count);
  int sampled = 0;
  for (int number = kSampling / 2; number < count; number += kSampling)
    sampled += bar_line(d, border, number) ? 1 : 0;
  if (sampled * kSampling < kMinStraightShare * shortest - kSampling) return {};
  std::vector<BarLine> found;
  for (int number = 0; number < count; ++number)
    if (const auto line = bar_line(d, border, number)) found.push_back(*line);
  const int reach = std::max(3, static_cast<int>(std::ceil(diameter_px / 2)));
  const std::vector<BarLine> straight = straight_lines(found, reach);
  // Bars: lines that continue each other.
  std::vector<StraightBar> bars;
  for (std::size_t first = 0, next = 0; first < straight.size(); first = next) {
    for (next = first + 1; next < straight.size(); ++next) {
      const BarLine &before = straight[next - 1], &here = straight[next];
      const int gap = here.number - before.number;
      if (gap > reach || std::abs(here.side - before.side) > 2 * kMaxOffset + kMaxSlope * gap) break;
    }
    const int length = straight[next - 1].number - straight[first].number + 1;
    if (length < shortest || static_cast<double>(next - first) < kMinStraightShare * length) continue;
    StraightBar bar{.border = border,
                    .lines = {straight.begin() + static_cast<std::ptrdiff_t>(first),
                              straight.begin() + static_cast<std::ptrdiff_t>(next)}};
    bar.width = width_of(bar.lines);
    bars.push_back(std::move(bar));
  }
  return bars;
}

namespace {

void mark(const StraightBar& bar, const cv::Mat1f& d, cv::Mat1b& marked) {
  const int n = line_length(bar.border, d.size()), count = line_count(bar.border, d.size());
  const auto set = [&](int number, int from, int to, bool only_dark) {
    for (int i = std::max(0, from); i < std::min(n, to); ++i)
      if (const cv::Point at = pixel_from(bar.border, d.size(), number, i);
          !only_dark || d(at) >= kBarDarkness)
        marked(at) = 255;
  };
  // Lines at which a grain of dust or a bead hides the outer side lie between others.
  for (std::size_t k = 0; k < bar.lines.size(); ++k) {
    const int end = k + 1 < bar.lines.size() ? bar.lines[k + 1].number : bar.lines[k].number + 1;
    for (int number = bar.lines[k].number; number < end; ++number)
      set(number, bar.lines[k].first, bar.lines[k].first + bar.width, false);
  }
  // Ends: as far as a semicircle reaches.
  constexpr int kBeyond = 2;  // px
  const double half = 0.5 * bar.width;
  for (const bool up : {false, true}) {
    const BarLine& last = up ? bar.lines.back() : bar.lines.front();
    for (int t = 1; t < half + kBeyond; ++t) {
      const int number = up ? last.number + t : last.number - t;
      if (number < 0 || number >= count) break;
      const double along = std::max(0, t - kBeyond);
      const double side = std::sqrt(std::max(0.0, half * half - along * along));
      set(number, static_cast<int>(std::lround(last.first + half - side)),
          static_cast<int>(std::lround(last.first + half + side)), true);
    }
  }
}

}  // namespace

cv::Mat1b straight_bars(const cv::Mat1f& darkness, double diameter_px, double thickest_px) {
  cv::Mat1b marked;
  for (const Border border : {Border::left, Border::right, Border::bottom, Border::top})
    for (const StraightBar& bar : straight_bars(darkness, border, diameter_px)) {
      if (bar.width > thickest_px) continue;
      if (marked.empty()) marked = cv::Mat1b(darkness.size(), uchar{0});
      mark(bar, darkness, marked);
    }
  return marked;
}

}  // namespace twincell::imaging
