#pragma once
/// \file
/// Ratio of the extents of discs along y and x of the picture. The beads are round, so that it is the ratio
/// of the pixels' sides. It differs from 1 if a film was resized along one side, or was recorded by an
/// anamorphic camera.

#include <array>
#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "imaging/disc/detection.hpp"

namespace twincell::imaging {

/// Extent along y over extent along x, and its standard error.
struct Aspect {
  double ratio = 1, error = 0;
  /// The same ratio from the distances of touching discs along y and x; absent if too few touch.
  std::optional<double> of_spacing = {};

  /// A sentence, without a full stop, that says what to do, if the ratio differs from 1 by more than 0.015
  /// and four standard errors, and the spacing by at least half as much in the same direction: light from one
  /// side and highlights change the rims, but not the distances. Empty otherwise.
  [[nodiscard]] std::string doubt() const;
};

/// Collects the rims of the discs of some frames.
///
/// In each direction in which the rim is seen (rim_samples.hpp), the integral of the grey levels along the
/// radius, in units of the step from outside to inside, is the distance of the edge from the centre. Blur
/// does not change it. A path L during the exposure changes it by L^2/(24 R) across the path, which is
/// subtracted, except for the shortest path of all frames: stretched discs look like moving ones, in all
/// frames in the same way. What varies with the cosine of the direction is an error of the centre; the part R
/// e cos 2 turn gives the ratio (1 - e)/(1 + e). Directions beside objects that are not discs, such as a
/// wall, are left out: those in which the outermost level is not that of the background.
class RimAspect {
 public:
  /// \param grey in the orientation in which the discs were located
  /// \param path_px as Located::path_px; discs with a path of more than R/2 are left out
  void add(const cv::Mat& grey, const std::vector<Detection>& discs, std::array<double, 2> path_px = {});
  /// The ratio of the weighted median of e. The standard error contains the scatter of e between discs, for
  /// which discs of other frames do not count as further ones, and 6 % of the deviation from 1, by which
  /// neighbours change the measured ratio. Absent for fewer than five discs.
  [[nodiscard]] std::optional<Aspect> value() const;

 private:
  struct Part {
    double e, weight;
    double across;  ///< (L_x^2 - L_y^2)/R^2 of the path L
  };
  /// Two discs that may touch.
  struct Pair {
    double xx, yy;  ///< squares of their distance along x and y, px^2
  };
  [[nodiscard]] std::optional<double> ratio_of_spacing() const;

  std::vector<Part> discs_;
  std::vector<Pair> pairs_;
  std::size_t most_ = 0;  ///< discs in a frame
};

}  // namespace twincell::imaging
