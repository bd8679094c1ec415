#pragma once
/// \file
/// Figures by gnuplot, a child process. Each figure leaves NAME.gp and NAME.dat beside NAME.svg, NAME.pdf and
/// NAME.png: `gnuplot NAME.gp` in that folder draws it again, so that it can be restyled.

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/runs/phase_diagram.hpp"

namespace twincell {

/// A figure as text.
struct Figure {
  std::string name = {};  ///< file name without ending
  std::string title = {};
  std::string caption = {};  ///< one paragraph: what is drawn and from what
  int width = 540;           ///< pixels at 100 %
  int height = 480;
  std::string plot = {};  ///< gnuplot commands, terminal and output excepted; reads NAME.dat
  std::string data = {};  ///< content of NAME.dat
  std::string svg =
      {};  ///< the drawing itself where gnuplot's own would be too large; empty: gnuplot draws it
};

/// Writes NAME.gp and NAME.dat into `folder` and draws NAME.svg, NAME.pdf and NAME.png.
/// \throws RunError if gnuplot is missing or fails, with its own words
void draw(const Figure& figure, const std::filesystem::path& folder);

/// The phases on the plane (N_l sigma, Gamma), K_m on the right if all runs share omega (Fortini & Huang
/// 2015, Fig. 3).
Figure phase_diagram_figure(const std::vector<Run>& runs);
/// The phases of both sides along Gamma: readable when all runs have one N_l.
Figure phase_strip_figure(const std::vector<Run>& runs);
/// s_b and s_c against Gamma with intervals and thresholds.
Figure thresholds_figure(const std::vector<Run>& runs);
/// s(k) about its mean against the phase, both sides.
Figure s_k_figure(const std::vector<Run>& runs);
/// s_j against the cycle, both sides.
Figure s_j_figure(const std::vector<Run>& runs);
/// Beads of one moment.
struct BeadPanel {
  std::string title;
  const Snapshot* moment;
  Box box;
  std::vector<double> radius;  ///< per slot, sigma; empty: 1/2
};
/// Moments side by side, `columns` in a row, beads to scale and coloured by local structure (Fortini & Huang
/// 2015, Fig. 1). \pre there is a panel
Figure beads_figure(const std::vector<BeadPanel>& panels, const std::string& name, const std::string& title,
                    std::size_t columns);
/// First and last frame of one run of each side (either may be absent), beads to scale and coloured by local
/// structure (Fortini & Huang 2015, Fig. 1).
Figure snapshots_figure(const std::vector<Run>& runs, const Match& match, const std::string& name);

}  // namespace twincell
