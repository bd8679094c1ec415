#pragma once
/// \file
/// Phase boundaries: the Gamma at which the phase of the bed changes, from the given runs.

#include <optional>
#include <string>
#include <vector>

#include "analysis/runs/phase_diagram.hpp"

namespace twincell::analysis {

/// A point on a phase boundary (Fortini & Huang 2015, Fig. 3): bracketed by runs, or fitted by a sweep.
struct PhaseBoundary {
  Side side = Side::simulation;
  std::string start = {};               ///< kind of start of the simulation; empty: unknown
  BedPhase onset = BedPhase::bouncing;  ///< the phase that begins here: bouncing or convecting
  double n_l = 0;                       ///< N_l sigma, mean of the runs of known phase
  std::size_t n_runs = 0;               ///< runs that decide whether they have the phase
  /// Lower end of the bracket: the largest Gamma of the runs at which the phase is still absent, and below
  /// which no run has it. Absent if every run has the phase, or seeds differ at the lowest of them.
  std::optional<double> below = {};
  /// Upper end of the bracket: the smallest Gamma of the runs at which the phase is present, and above which
  /// every run has it. Absent if no run has the phase, or seeds differ at the highest of them.
  std::optional<double> above = {};
  bool overlap = false;  ///< inside the bracket, runs with the phase are below runs without: seeds differ
  bool sweep = false;    ///< from a sweep: `below` and `above` are the ends of its interval
  std::optional<double> fitted = {};  ///< the onset fitted by a sweep
  std::string axes = {};  ///< other axes of the sweep with their values, "drive.omega = 2"; empty: none
  /// The fitted onset, else the middle of the bracket; absent if the bracket is open on one side.
  [[nodiscard]] std::optional<double> gamma() const;
  /// Half width of the bracket; absent if it is open.
  [[nodiscard]] std::optional<double> half_width() const;
};

/// One boundary of each kind for each side, start and N_l (runs within 10 %) that has runs of known phase. A
/// convecting bed also counts as bouncing. A run that leaves open whether it has the phase
/// (phase_evidence.hpp) does not count.
std::vector<PhaseBoundary> find_boundaries(const std::vector<Run>& runs);

/// Origin of a boundary: "experiment", "simulation", "simulation (random)", "sweep (random)", "sweep (random,
/// drive.omega = 2)"; "twins" for simulations that start from a filmed packing.
std::string boundary_of(const PhaseBoundary& boundary);
/// Position of a boundary in Gamma: "between 0.9 and 1.6", "above 2.5", "below 0.9"; "1.27 ± 0.07" if a sweep
/// fitted it.
std::string boundary_text(const PhaseBoundary& boundary);

}  // namespace twincell::analysis
