#pragma once
/// \file
/// Curves as a few numbers: the directions in which the curves of many runs differ (principal components).

#include <cstddef>
#include <vector>

namespace twincell {

/// curve ~ mean + sum_i number_i form_i, the forms orthogonal and of unit length, in the order of how much of
/// the spread they make up.
struct CurveComponents {
  std::vector<double> mean;
  std::vector<std::vector<double>> forms;
  double left_out = 0;  ///< rms, over elements and runs, of what the forms leave of the curves they are from

  /// The numbers of a curve; NaN for one that is not finite everywhere. \pre as long as the mean
  [[nodiscard]] std::vector<double> numbers(const std::vector<double>& curve) const;
  /// The curve of these numbers.
  [[nodiscard]] std::vector<double> curve(const std::vector<double>& numbers) const;
  /// rms over elements of what the forms leave of a curve.
  [[nodiscard]] double misfit(const std::vector<double>& curve) const;
};

/// As many forms as make up 99 % of the spread of the curves, one at least and at most `most`. Curves that
/// are not finite everywhere are passed over. \pre all are of one length \throws InputError for fewer than
/// three curves
CurveComponents components_of(const std::vector<std::vector<double>>& curves, std::size_t most = 4);

}  // namespace twincell
