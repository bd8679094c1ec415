#pragma once
/// \file
/// Fit of a law to the columns of a table, with the report as JSON.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibration/fit/curve_fit.hpp"
#include "core/table.hpp"

namespace twincell::calibration {

/// The columns of a table that enter a fit.
struct FitColumns {
  std::string x, y;           ///< empty: the first and the second column
  std::string sigma, trials;  ///< of y: standard deviation, or number of trials; empty: none
};

/// A fit with its points and the columns from which they were taken.
struct TableFit {
  CurveFit fit;
  std::vector<DataPoint> points;
  FitColumns columns;  ///< with the names of x and y
};

/// Fits the law of that name to a table.
/// \param window [low, high] of x; absent: all points
/// \throws ConfigError for an unknown law or column, for a window without points between its ends, and for
/// both sigma and trials; InputError for a column without numbers, a negative standard deviation, and with
/// trials for a frequency outside 0 to 1; as fit_curve
TableFit fit_table(const Table& table, const std::string& law, FitColumns columns,
                   const std::optional<std::array<double, 2>>& window);

/// \throws ConfigError as fit_table for a window or a law, before there is a table
void check_fit(const std::string& law, const std::optional<std::array<double, 2>>& window);

/// The fit as one JSON object (docs/fitting.md): law, parameters with errors and intervals, covariance,
/// diagnostics, and every point with its use.
std::string fit_json(const TableFit& fit);

}  // namespace twincell::calibration
