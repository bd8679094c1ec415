#pragma once
/// \file
/// Convection of the bed: the spread s_j of the tracers' heights from cycle to cycle, its rms s_c, and its
/// drift (Fortini & Huang 2015, eqs. B1 and B2).

#include <optional>
#include <string>
#include <vector>

#include "analysis/motion/tracer_line.hpp"
#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// Keeps the heights of the tracers at the beginning of each cycle.
class TracerSpread {
 public:
  explicit TracerSpread(const AnalysisContext& context)
      : context_(context), line_{.n_tracers = context.tracers.size()} {}

  /// Adds the beginning of a cycle.
  /// \param heights [tracers] in this frame, NaN where a tracer is missing
  void add(const Frame& frame, const std::vector<double>& heights);
  /// Appends s_j, s_c and cycle_of_convection.
  /// \param no_cycles why the frames have no cycles of tracers; empty if they have
  void add_spread(const std::string& no_cycles, std::vector<Result>& all) const;
  /// Appends s_j_growth, s_j_growth_late and drift. Requires s_j in `all`.
  /// \param noise standard uncertainty of one height, sigma; NaN if unknown
  void add_drift(double noise, std::vector<Result>& all) const;
  /// Appends tracers and tracer_heights.
  void add_line(const std::string& no_cycles, std::vector<Result>& all) const;

 private:
  [[nodiscard]] std::string why_no_spread(const std::string& no_cycles, const SeriesAverage& squares) const;
  [[nodiscard]] Result s_j(const std::vector<double>& spread, std::size_t n) const;
  [[nodiscard]] Result s_c(const SeriesAverage& squares) const;
  [[nodiscard]] std::optional<Interval> interval_of_s_c(const SeriesAverage& squares) const;
  [[nodiscard]] Result cycle_of_convection(const std::vector<double>& spread, std::size_t n) const;
  [[nodiscard]] Result growth_result(const std::string& name, const Growth& slope, std::size_t first) const;

  const AnalysisContext& context_;
  TracerLine line_;
  std::size_t incomplete_starts_ = 0;
  std::size_t jumps_ = 0;
};

}  // namespace twincell::analysis
