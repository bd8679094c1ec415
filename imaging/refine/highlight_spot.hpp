#pragma once
/// \file
/// The highlight that all discs of a frame have in common, in addition to their radial profile.

#include <opencv2/core.hpp>

#include "imaging/disc/detection.hpp"

namespace twincell::imaging {

/// t(x - x_k, y - y_k), a picture inside the rims (r < 0.9 R), linear between values half a pixel apart.
class HighlightSpot {
 public:
  /// No highlight.
  HighlightSpot() = default;

  /// t and its slopes at a pixel, darkness and darkness per px.
  struct Level {
    double value = 0, along_x = 0, along_y = 0;
  };
  [[nodiscard]] Level at(const Detection& disc, int x, int y) const {
    return side_ == 0 ? Level{} : inside(disc, x, y);
  }
  [[nodiscard]] bool empty() const { return side_ == 0; }

  /// Estimates the spot: the mean residual of the discs after their profile is subtracted.
  class Estimate {
   public:
    /// \param radius_px R
    explicit Estimate(double radius_px);
    /// Adds a pixel of a disc; `residual` is its darkness without profile, ground and neighbours.
    void add(const Detection& disc, int x, int y, double residual);
    /// The spot. Cells that few discs show are shrunk towards 0, and the spot vanishes between 0.75 R and 0.9
    /// R.
    [[nodiscard]] HighlightSpot spot() const;

   private:
    double radius_;
    cv::Mat1d sum_, weight_;
  };

 private:
  explicit HighlightSpot(const cv::Mat1f& values) : values_(values), side_(values.cols) {}
  [[nodiscard]] Level inside(const Detection& disc, int x, int y) const;

  cv::Mat1f values_;  // their middle is the centre of a disc
  int side_ = 0;      // values along each side; 0: no highlight
};

}  // namespace twincell::imaging
