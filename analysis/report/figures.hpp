#pragma once
/// \file
/// Figures drawn by gnuplot as a child process. Each figure keeps NAME.gp and NAME.dat next to NAME.svg,
/// NAME.pdf and NAME.png. `gnuplot NAME.gp` in that folder draws the figure again, so that it can be
/// restyled.

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/runs/phase_diagram.hpp"

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

/// Writes NAME.gp and NAME.dat into `folder` and draws NAME.svg, NAME.pdf and NAME.png.
/// \throws RunError if gnuplot is missing or fails, with the message of gnuplot
void draw(const Figure& figure, const std::filesystem::path& folder);

/// The phases in the plane (N_l sigma, Gamma), with a K_m axis on the right if all runs have the same omega
/// (Fortini & Huang 2015, Fig. 3).
Figure phase_diagram_figure(const std::vector<Run>& runs);
/// The phases of both sides along Gamma, for runs that all have the same N_l.
Figure phase_strip_figure(const std::vector<Run>& runs);
/// s_b and s_c against Gamma with intervals and thresholds.
Figure thresholds_figure(const std::vector<Run>& runs);
/// s(k) minus its mean against the phase, both sides.
Figure s_k_figure(const std::vector<Run>& runs);
/// s_j against the cycle, both sides.
Figure s_j_figure(const std::vector<Run>& runs);
/// The beads of one snapshot, as a panel of a figure.
struct BeadPanel {
  std::string title;
  const Snapshot* moment;
  Box box;
  std::vector<double> radius;  ///< per slot, sigma; empty: 1/2
};
/// Snapshots in rows of `columns` panels, with the beads to scale and coloured by local structure (Fortini &
/// Huang 2015, Fig. 1). \pre panels is not empty
Figure beads_figure(const std::vector<BeadPanel>& panels, const std::string& name, const std::string& title,
                    std::size_t columns);
/// First and last frame of one run of each side (one side may be absent), with the beads to scale and
/// coloured by local structure (Fortini & Huang 2015, Fig. 1).
Figure snapshots_figure(const std::vector<Run>& runs, const Match& match, const std::string& name);

}  // namespace twincell::analysis
