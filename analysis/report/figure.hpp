#pragma once
/// \file
/// A figure drawn by gnuplot as a child process. It keeps NAME.gp and NAME.dat next to NAME.svg, NAME.pdf and
/// NAME.png. `gnuplot NAME.gp` in that folder draws the figure again, so that it can be restyled.

#include <filesystem>
#include <string>
#include <vector>

namespace twincell::analysis {

/// A figure as text.
struct Figure {
  std::string name = {};  ///< file name without extension
  std::string title = {};
  std::string caption = {};  ///< one paragraph: the content of the figure and its source
  int width = 540;           ///< pixels at 100 %
  int height = 480;
  std::string plot = {};  ///< gnuplot commands without terminal and output; reads NAME.dat
  std::string data = {};  ///< content of NAME.dat
  /// The SVG drawing, if that of gnuplot would be too large; empty: gnuplot draws it.
  std::string svg = {};
};

/// Names of the files that draw() writes for a figure of this name.
std::vector<std::string> figure_files(const std::string& name);

/// Writes NAME.gp and NAME.dat into `folder` and draws NAME.svg, NAME.pdf and NAME.png.
/// \throws RunError if gnuplot is missing or fails, with the message of gnuplot
void draw(const Figure& figure, const std::filesystem::path& folder);

}  // namespace twincell::analysis
