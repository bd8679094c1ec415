#pragma once
/// \file
/// Straight bars: side walls, plate or lid with light behind them.
///
/// Every line of pixels, row or column, is searched from the border inwards for its first dark run. These
/// runs are a bar if they begin on one straight line, which may be tilted slightly, over at least four bead
/// diameters and a third of the lines of that side. The rims of beads curve within a diameter, so that
/// neither a row of touching beads nor the face of a crystal is a bar. Rims of beads below 8 px do not curve
/// visibly: no bar is reported for such beads. The same holds for beads below six times the blur, which the
/// caller has to check.

#include <opencv2/core.hpp>
#include <vector>

namespace twincell::imaging {

/// The border from which lines of pixels are counted.
enum class Border { left, right, bottom, top };

/// Pixel i of a line, counted from the border.
cv::Point pixel_from(Border border, cv::Size size, int line, int i);
/// Number of pixels of a line.
int line_length(Border border, cv::Size size);
/// Number of lines: rows for left and right, columns for bottom and top.
int line_count(Border border, cv::Size size);

/// A line of pixels that crosses a bar.
struct BarLine {
  int number = 0;   ///< row or column
  int first = 0;    ///< first dark pixel, from the border
  int light = 0;    ///< first light pixel behind it; a bead that touches the bar is between
  double side = 0;  ///< outer side of the bar, where the darkness is 0.5, px from the border's first pixel
};

/// A bar, seen from a border.
struct StraightBar {
  Border border = Border::left;
  std::vector<BarLine> lines;  ///< ascending; those at which its outer side is seen
  int width = 0;               ///< thickness along the lines, px
};

/// The bars in a picture, seen from one border. Pure.
/// \param darkness 0 in full light, about 1 in a bar
std::vector<StraightBar> straight_bars(const cv::Mat1f& darkness, Border border, double diameter_px);

/// 255 on bars, seen from all borders, with their ends, square or round; empty if there is none. Pure.
/// \param thickest_px thicker bars are left out
cv::Mat1b straight_bars(const cv::Mat1f& darkness, double diameter_px, double thickest_px);

}  // namespace twincell::imaging
