#pragma once
/// \file
/// A table of numbers as text.

#include <filesystem>
#include <string>
#include <vector>

namespace twincell {

/// Columns of numbers with names.
struct Table {
  std::string file;
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;  ///< [names][rows]; NaN for an empty field or "nan"

  [[nodiscard]] std::size_t n_rows() const { return columns.empty() ? 0 : columns.front().size(); }
  /// The column called `name`. \throws ConfigError naming the columns there are
  [[nodiscard]] const std::vector<double>& column(const std::string& name) const;
};

/// Reads comma-separated values: a line of names, then rows of as many numbers. Lines that are blank or begin
/// with # are skipped; spaces around fields too. \throws InputError "FILE:LINE: …" for a missing file, a row
/// of another length, a field that is no finite number, a table without rows; as check_column_names
Table read_table(const std::filesystem::path& path);

}  // namespace twincell
