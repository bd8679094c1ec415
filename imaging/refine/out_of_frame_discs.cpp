#include "imaging/refine/out_of_frame_discs.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace twincell::imaging {

namespace {

constexpr int kRows = 4;            // rows from the border that carry nearly all the information
constexpr int kDepthsPerPixel = 2;  // trial depths of centres per pixel
constexpr double kWitness = 0.1;    // mean residual of five border pixels that starts a closer search
constexpr double kDarkness = 0.35;  // smallest darkness of a disc, part of which its neighbours absorbed
constexpr double kClear = 6;        // smallest darkness in standard deviations

/// Residuals and weights along a border of the frame, by row from the border.
struct Border {
  using Line = std::vector<double>;
  std::array<Line, kRows> left, weight;
};

/// One of the four borders, with coordinates along it and inwards from it.
struct Side {
  bool upright, far;  // upright: left or right border; far: right or bottom border
  int length, deep;

  /// The pixel at position `along` the border, `inside` rows inwards.
  [[nodiscard]] cv::Point2d at(double along, double inside) const {
    const double across = far ? deep - 1 - inside : inside;
    return upright ? cv::Point2d(across, along) : cv::Point2d(along, across);
  }
};

Border border_of(const RingArgs& args, const Side& side) {
  Border border;
  for (int row = 0; row < kRows; ++row) {
    const auto k = static_cast<std::size_t>(row);
    for (int t = 0; t < side.length; ++t) {
      const cv::Point at = side.at(t, row);
      const auto d = static_cast<double>((*args.picture)(at)), model = static_cast<double>((*args.model)(at));
      const bool seen = d < static_cast<double>(kUnseen);
      border.left[k].push_back(seen ? d - model : 0);
      border.weight[k].push_back(
          seen ? 1 / (args.dark_variance + args.light_variance * std::clamp(1 - model, 0.0, 1.0)) : 0);
    }
  }
  return border;
}

/// P of a disc whose centre is `depth` pixels outside the first row, in the rows and columns near it.
std::array<Border::Line, kRows> shape_of(double depth, double radius, double blur, int half) {
  std::array<Border::Line, kRows> shape;
  for (int row = 0; row < kRows; ++row)
    for (int j = -half; j <= half; ++j)
      shape[static_cast<std::size_t>(row)].push_back(
          0.5 * std::erfc((std::hypot(depth + row, j) - radius) / (std::sqrt(2.0) * blur)));
  return shape;
}

}  // namespace

std::vector<Proposal> out_of_frame_discs(const RingArgs& args, double radius_px, double deepest_px) {
  const double blur = std::sqrt(args.blur.variance);
  const int half = cvCeil(radius_px), width = args.picture->cols - kSpareColumns, height = args.picture->rows;
  std::vector<std::array<Border::Line, kRows>> shapes;
  for (int d = 1; d <= cvFloor(deepest_px * kDepthsPerPixel); ++d)
    shapes.push_back(shape_of(static_cast<double>(d) / kDepthsPerPixel, radius_px, blur, half));

  std::vector<Proposal> found;
  for (const Side& side : {Side{false, false, width, height}, Side{false, true, width, height},
                           Side{true, false, height, width}, Side{true, true, height, width}}) {
    if (side.deep < kRows) continue;
    const Border border = border_of(args, side);
    for (int t = 2; t + 2 < side.length; ++t) {
      const double* near = &border.left[0][static_cast<std::size_t>(t - 2)];
      if (near[0] + near[1] + near[2] + near[3] + near[4] < 5 * kWitness) continue;
      Proposal best;
      for (std::size_t d = 0; d < shapes.size(); ++d) {
        double by = 0, of = 0;
        for (std::size_t k = 0; k < kRows; ++k)
          for (int j = std::max(-half, -t); j <= std::min(half, side.length - 1 - t); ++j) {
            const auto at = static_cast<std::size_t>(t + j);
            const double p = shapes[d][k][static_cast<std::size_t>(j + half)], wp = border.weight[k][at] * p;
            by += wp * border.left[k][at];
            of += wp * p;
          }
        const double clear = of > 0 ? by / std::sqrt(of) : 0;
        if (by < kDarkness * of || clear <= std::max(kClear, best.score)) continue;
        const cv::Point2d centre = side.at(t, -static_cast<double>(d + 1) / kDepthsPerPixel);
        best = {centre.x, centre.y, clear};
      }
      if (best.score > 0) found.push_back(best);
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Proposal& a, const Proposal& b) { return a.score > b.score; });
  return found;
}

}  // namespace twincell::imaging
