#pragma once
/// \file
/// The smallest s_b and s_j that a camera can tell from rest: half a pixel, and what the uncertainties of
/// positions contribute (Fortini & Huang 2015, app. B).

#include <vector>

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// Accumulates the standard uncertainties of the tracers' heights.
class DetectionLimit {
 public:
  explicit DetectionLimit(const AnalysisContext& context) : context_(context) {}

  /// Adds a frame.
  /// \param heights [tracers] in this frame, NaN where a tracer is missing
  void add(const Frame& frame, const std::vector<double>& heights);
  /// Standard uncertainty of one height, rms over tracers and frames, sigma; NaN if unknown.
  [[nodiscard]] double noise() const;
  /// Appends half_pixel, s_b_noise and s_j_noise.
  /// \param cycles number of cycles that s_b is averaged over
  void add_results(std::size_t cycles, std::vector<Result>& all) const;

 private:
  [[nodiscard]] Result half_pixel() const;
  [[nodiscard]] Result noise_result(const std::string& name, double value, const std::string& how) const;

  const AnalysisContext& context_;
  double squares_ = 0;
  std::size_t count_ = 0;
};

}  // namespace twincell::analysis
