#pragma once
/// \file
/// Where along Gamma one phase of the bed gives way to another, from the runs at hand.

#include <optional>
#include <string>
#include <vector>

#include "analysis/runs/phase_diagram.hpp"

namespace twincell {

/// A point on a phase boundary (Fortini & Huang 2015, Fig. 3): bracketed by runs, or fitted by a sweep.
struct PhaseBoundary {
  Side side = Side::simulation;
  std::string start = {};               ///< kind of start of the simulation; empty: not known
  BedPhase onset = BedPhase::bouncing;  ///< the phase that begins here: bouncing or convecting
  double n_l = 0;                       ///< N_l sigma, mean of the runs
  std::size_t n_runs = 0;               ///< runs of known phase
  std::optional<double> below = {};  ///< largest Gamma below which no run has the phase; absent: none was run
  std::optional<double> above = {};  ///< smallest Gamma above which every run has it; absent: none was run
  bool overlap = false;  ///< between them runs with the phase lie below runs without: seeds differ
  bool sweep = false;    ///< of a sweep: `below` and `above` are the ends of its interval
  std::optional<double> fitted = {};  ///< the onset that a sweep has fitted
  /// As fitted; else the middle of the bracket, absent if it is open on one side.
  [[nodiscard]] std::optional<double> gamma() const;
  /// Half width of the bracket; absent if it is open.
  [[nodiscard]] std::optional<double> half_width() const;
};

/// One boundary of each kind for each side, start and N_l (runs within 10 %), where runs of known phase
/// exist. A convecting bed counts as bouncing.
std::vector<PhaseBoundary> find_boundaries(const std::vector<Run>& runs);

/// "experiment", "simulation", "simulation, random", "sweep, random".
std::string boundary_of(const PhaseBoundary& boundary);
/// "1.25 ± 0.35", "above 2.5", "below 0.9".
std::string boundary_text(const PhaseBoundary& boundary);

}  // namespace twincell
