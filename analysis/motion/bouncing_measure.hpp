#pragma once
/// \file
/// Bouncing of the bed: the mean height of the tracers above the plate over the phases of a cycle, and its
/// spread s_b (Fortini & Huang 2015, eqs. B3 and B4).

#include <cstdint>
#include <string>
#include <vector>

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// s_b of a curve s(k), k = 0 .. N_k - 1, N_k >= 2, in sigma:
///
/// - variance: s_b^2 = mean over k of (s(k) - mean s)^2 (default)
/// - about_rest: s_b^2 = mean over k of (s(k) - s_rest)^2
/// - as_printed: s_b^2 = mean over k of s(k)^2 (eq. B4 as printed: a squared height)
///
/// The text of the paper calls s_b^2 "the variance over all phases"; the printed form would always exceed
/// sigma/30.
double s_b_of(const std::vector<double>& s_k, SbForm form, double rest_height);

/// Sums of the tracers' heights above the plate for each (tracer, phase).
struct HeightSums {
  std::vector<double> sum;
  std::vector<std::size_t> count;

  explicit HeightSums(std::size_t size = 0) : sum(size, 0.0), count(size, 0) {}
  /// Adds the sums of further frames.
  void add(const HeightSums& other);
};

/// Averages the tracers' heights above the plate over whole cycles, and gives s(k) and s_b. If there are two
/// or more whole cycles, an even number of them is used, because a bed of period 2 would bias an odd number.
class Bouncing {
 public:
  explicit Bouncing(const AnalysisContext& context);

  /// Adds a frame.
  /// \param heights [tracers] in this frame, NaN where a tracer is missing
  void add(const Frame& frame, const std::vector<double>& heights);
  /// Ends the current cycle. It counts if enough tracers were seen at each of its phases.
  void close_cycle();
  /// Number of whole cycles that s(k) is averaged over.
  [[nodiscard]] std::size_t cycles_used() const;
  /// Appends s_k, s_b and the three forms of s_b. Requires a closed cycle.
  /// \param no_cycles why the frames have no cycles of tracers; empty if they have
  void add_results(const std::string& no_cycles, std::vector<Result>& all) const;

 private:
  [[nodiscard]] std::string why_absent(const std::string& no_cycles) const;
  [[nodiscard]] const HeightSums& sums() const { return whole_cycles_ < 2 ? pair_ : total_; }
  [[nodiscard]] std::vector<double> curve(const std::vector<std::size_t>& tracers) const;
  [[nodiscard]] double rest_of(const std::vector<std::size_t>& tracers) const;
  [[nodiscard]] Result s_k() const;
  [[nodiscard]] Result s_b(const std::string& name, SbForm form, const std::vector<double>& s_k) const;

  const AnalysisContext& context_;
  std::size_t n_tracers_, n_phases_;
  HeightSums total_;  ///< an even number of whole cycles
  HeightSums pair_;   ///< the whole cycles after those
  HeightSums cycle_;  ///< the current cycle
  std::vector<char> phase_seen_;
  std::int64_t current_cycle_ = -1;
  std::size_t whole_cycles_ = 0;
  std::size_t broken_cycles_ = 0;
  bool no_plate_ = false;
};

}  // namespace twincell::analysis
