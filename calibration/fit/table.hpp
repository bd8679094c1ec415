#pragma once
/// \file
/// Reader for CSV tables of numbers.

#include <filesystem>
#include <string>
#include <vector>

namespace twincell {

/// Named columns of numbers.
struct Table {
  std::string file;
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;  ///< [names][rows]; NaN for an empty field or "nan"

  [[nodiscard]] std::size_t n_rows() const { return columns.empty() ? 0 : columns.front().size(); }
  /// The column called `name`. \throws ConfigError listing the existing columns
  [[nodiscard]] const std::vector<double>& column(const std::string& name) const;
};

/// Reads comma-separated values: a header line of names, then rows with as many numbers. Blank lines, lines
/// that begin with #, and spaces around fields are skipped. \throws InputError "FILE:LINE: …" for a missing
/// file, a row of another length, a field that is not a finite number, or a table without rows; also as
/// check_column_names
Table read_table(const std::filesystem::path& path);

}  // namespace twincell
