#pragma once
/// \file
/// Principal components of the curves of many runs: each curve is reduced to a few numbers.

#include <cstddef>
#include <vector>

namespace twincell::calibration {

/// curve ~ mean + sum_i number_i form_i. The forms (principal components) are orthogonal, of unit length, and
/// in falling order of the variance they explain.
struct CurveComponents {
  std::vector<double> mean;
  std::vector<std::vector<double>> forms;
  double left_out = 0;  ///< rms residual of the curves, over elements and runs

  /// Projections of a curve onto the forms; NaN if the curve is not finite everywhere.
  /// \pre same length as `mean`
  [[nodiscard]] std::vector<double> numbers(const std::vector<double>& curve) const;
  /// The curve with these numbers.
  [[nodiscard]] std::vector<double> curve(const std::vector<double>& numbers) const;
  /// rms residual of a curve over its elements, in the unit of the curve.
  [[nodiscard]] double misfit(const std::vector<double>& curve) const;
};

/// Principal components by singular value decomposition: as many as explain 99.9 % of the variance of the
/// curves, at least one and at most `most`. Curves that are not finite everywhere are skipped.
/// \pre all have equal length
/// \throws InputError for fewer than three finite curves
CurveComponents components_of(const std::vector<std::vector<double>>& curves, std::size_t most = 4);

}  // namespace twincell::calibration
