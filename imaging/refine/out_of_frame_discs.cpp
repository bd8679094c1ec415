#include "imaging/refine/out_of_frame_discs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace twincell::imaging {

namespace {

constexpr int kRows = 4;                // rows from the border that carry nearly all the information
constexpr int kDepthsPerPixel = 2;      // trial depths of centres per pixel
constexpr double kWitness = 0.1;        // mean residual of five border pixels that starts a closer search
constexpr double kMinSignificance = 6;  // of the darkness, standard deviations

/// Residuals and weights along a border of the frame, by row from the border. Beyond both ends there are
/// `half` places without weight.
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

Border border_of(const RingArgs& args, const Side& side, int half) {
  Border border;
  for (int row = 0; row < kRows; ++row) {
    const auto k = static_cast<std::size_t>(row);
    border.left[k].assign(static_cast<std::size_t>(half), 0);
    border.weight[k].assign(static_cast<std::size_t>(half), 0);
    for (int t = 0; t < side.length; ++t) {
      const cv::Point at = side.at(t, row);
      const auto d = static_cast<double>((*args.picture)(at)), model = static_cast<double>((*args.model)(at));
      const bool seen = d < static_cast<double>(kUnseen);
      border.left[k].push_back(seen ? d - model : 0);
      border.weight[k].push_back(
          seen ? 1 / (args.dark_variance + args.light_variance * std::clamp(1 - model, 0.0, 1.0)) : 0);
    }
    border.left[k].resize(border.left[k].size() + static_cast<std::size_t>(half), 0);
    border.weight[k].resize(border.weight[k].size() + static_cast<std::size_t>(half), 0);
  }
  return border;
}

/// P of a disc whose centre is `depth` pixels outside the first row, in the rows and columns near it.
using Shape = std::array<Border::Line, kRows>;
Shape shape_of(double depth, double radius, double blur, int half) {
  Shape shape;
  for (int row = 0; row < kRows; ++row)
    for (int j = -half; j <= half; ++j)
      shape[static_cast<std::size_t>(row)].push_back(
          0.5 * std::erfc((std::hypot(depth + row, j) - radius) / (std::sqrt(2.0) * blur)));
  return shape;
}

/// Fits the darkness of a disc at each of several consecutive places along a border: the darkness is by / of,
/// its weight of. The innermost loop is over the places, so that the compiler computes several at once.
struct Darkness {
  Border::Line by, of;

  void fit(const Border& border, const Shape& shape, std::size_t first, std::size_t places) {
    by.assign(places, 0);
    of.assign(places, 0);
    double *const sums = by.data(), *const weights = of.data();
    for (std::size_t k = 0; k < kRows; ++k)
      for (std::size_t j = 0; j < shape[k].size(); ++j) {
        const double p = shape[k][j];
        const double *left = border.left[k].data() + first + j, *weight = border.weight[k].data() + first + j;
        for (std::size_t t = 0; t < places; ++t) {
          const double wp = weight[t] * p;
          sums[t] += wp * left[t];
          weights[t] += wp * p;
        }
      }
  }
};

}  // namespace

std::vector<Proposal> out_of_frame_discs(const RingArgs& args, double radius_px, double deepest_px,
                                         double least_darkness) {
  const double blur = std::sqrt(args.blur.variance);
  const int half = cvCeil(radius_px), width = args.picture->cols - kSpareColumns, height = args.picture->rows;
  std::vector<Shape> shapes;
  for (int d = 1; d <= cvFloor(deepest_px * kDepthsPerPixel); ++d)
    shapes.push_back(shape_of(static_cast<double>(d) / kDepthsPerPixel, radius_px, blur, half));

  std::vector<Proposal> found;
  Darkness dark;
  for (const Side& side : {Side{false, false, width, height}, Side{false, true, width, height},
                           Side{true, false, height, width}, Side{true, true, height, width}}) {
    if (side.deep < kRows) continue;
    const Border border = border_of(args, side, half);
    const auto is_dark = [&](int t) {
      if (t + 2 >= side.length) return false;
      const double* near = &border.left[0][static_cast<std::size_t>(half + t - 2)];
      return near[0] + near[1] + near[2] + near[3] + near[4] >= 5 * kWitness;
    };
    for (int begin = 2; begin + 2 < side.length;) {
      if (!is_dark(begin)) {
        ++begin;
        continue;
      }
      int end = begin;
      while (is_dark(end)) ++end;
      const auto places = static_cast<std::size_t>(end - begin);
      std::vector<Proposal> best(places);
      for (std::size_t d = 0; d < shapes.size(); ++d) {
        dark.fit(border, shapes[d], static_cast<std::size_t>(begin), places);
        for (std::size_t t = 0; t < places; ++t) {
          const double by = dark.by[t], of = dark.of[t];
          const double clear = of > 0 ? by / std::sqrt(of) : 0;
          if (by < least_darkness * of || clear <= std::max(kMinSignificance, best[t].score)) continue;
          const cv::Point2d centre =
              side.at(begin + static_cast<int>(t), -static_cast<double>(d + 1) / kDepthsPerPixel);
          best[t] = {centre.x, centre.y, clear};
        }
      }
      std::copy_if(best.begin(), best.end(), std::back_inserter(found),
                   [](const Proposal& p) { return p.score > 0; });
      begin = end;
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Proposal& a, const Proposal& b) { return a.score > b.score; });
  return found;
}

}  // namespace twincell::imaging
