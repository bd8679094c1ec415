#pragma once
/// \file
/// The style of all figures: fonts, line widths, colours, point types, keys and the tics of axes. draw() puts
/// the terminal and head() before the commands of every figure, so that a figure states only its contents.

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace twincell::analysis::figure_style {

/// Largest width, px. A page shows wider figures reduced, and their text with them.
inline constexpr int kWidest = 720;

/// Width of lines between points, and of curves (laws, fits).
inline constexpr double kLine = 1.3, kCurve = 1.8;

/// gnuplot point types.
inline constexpr int kCircle = 7, kSquare = 5, kTriangle = 9, kDiamond = 13, kDown = 11, kPentagon = 15;
/// The point type of the same shape as `filled` (kCircle ...), without its filling.
[[nodiscard]] constexpr int unfilled(int filled) {
  return filled - 1;
}

/// Point type of series i (from 0), whose colour and point are those of line type i + 1 of gnuplot, as head()
/// defines it.
[[nodiscard]] int series_point(std::size_t i);
/// Colour of series i of n in an order (drive strength, height): viridis, from dark blue to yellow.
[[nodiscard]] std::string ordered_colour(std::size_t i, std::size_t n);

/// `set terminal` of one kind of output.
/// \param kind "svg", "pdf" or "png"
/// \param width,height px at 100 %
[[nodiscard]] std::string terminal(const std::string& kind, int width, int height);
/// Commands at the beginning of every figure: palette, line types, borders, grid, key below the plot.
[[nodiscard]] std::string head();

/// Range of one axis. It grows with the numbers that it must show, and gets a margin when it is set.
struct PlotAxis {
  std::string label;         ///< with its unit, as enhanced text
  bool logarithmic = false;  ///< then the range holds positive numbers only
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();

  /// Includes `v`; ignores what cannot be drawn (not finite; on a logarithmic axis not positive).
  void show(double v);
  [[nodiscard]] bool empty() const { return low > high; }
  /// The range with a margin of 4 % of its length, or of its logarithm.
  [[nodiscard]] PlotAxis with_margin() const;
};

/// Labels, ranges with margins, and tics of both axes. On a logarithmic axis the tics are 10^n; if it is
/// shorter than three decades, and the other axis is not a longer logarithmic one, 1, 2, 5 times a power of
/// ten. An empty range is 0 to 1 (1 to 10).
[[nodiscard]] std::string axes(const PlotAxis& x, const PlotAxis& y);

/// What a source states, drawn alike everywhere: a dashed line at x or at y, a band of x, and their
/// entries in the key (clauses of a plot command).
[[nodiscard]] std::string stated_x(double x);
[[nodiscard]] std::string stated_y(double y);
[[nodiscard]] std::string stated_band_x(double low, double high);
[[nodiscard]] std::string stated_line_entry(const std::string& text);
[[nodiscard]] std::string stated_band_entry(const std::string& text);
/// Look of a line that a source states, for use after `with lines`.
inline constexpr const char* kStated = "lw 1.5 dt 4 lc rgb '#555555'";

/// Title of a panel: "(a) 2D rough", the letter in bold. A newline begins a second line.
[[nodiscard]] std::string panel_title(char letter, const std::string& text);

/// Panels of equal size with a common key below them, in `rows` times `columns`.
class Panels {
 public:
  /// \param width,height of the figure, px
  /// \param key_rows lines of the key
  Panels(std::size_t rows, std::size_t columns, int width, int height, int key_rows);
  /// Commands before the first panel.
  [[nodiscard]] static std::string begin();
  /// Commands before panel i, counted along the rows.
  [[nodiscard]] std::string panel(std::size_t i) const;
  /// Commands after the last panel: the key below them.
  /// \param entries clauses of a plot command (`keyentry`)
  [[nodiscard]] std::string end(const std::vector<std::string>& entries) const;

 private:
  std::size_t rows_, columns_;
  double width_, height_, key_;
};

}  // namespace twincell::analysis::figure_style
