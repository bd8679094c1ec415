#pragma once
/// \file
/// Reader for CSV tables.

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace twincell {

/// Named columns.
struct Table {
  /// First field of a column that is not a finite number.
  struct Text {
    long line = 0;
    std::string word;
  };
  std::string file;
  std::vector<std::string> names;
  /// [names][rows]; NaN for an empty field, "nan" or text; True is 1, False is 0.
  std::vector<std::vector<double>> columns;
  std::map<std::size_t, Text> texts;  ///< of the columns that hold other things than numbers
  std::set<std::size_t> marks;        ///< columns that hold True and False alone, as pandas writes them

  [[nodiscard]] std::size_t n_rows() const { return columns.empty() ? 0 : columns.front().size(); }
  /// The column called `name`.
  /// \throws ConfigError listing the existing columns if there is none
  /// \throws InputError "FILE:LINE: NAME: …" listing the columns of numbers if it holds other things
  [[nodiscard]] const std::vector<double>& column(const std::string& name) const;
  /// The same for a property that a bead has or has not: a column of numbers, or of marks.
  [[nodiscard]] const std::vector<double>& column_of_marks(const std::string& name) const;

 private:
  [[nodiscard]] std::size_t index_of(const std::string& name) const;
};

/// Reads comma-separated values: a header line of names, then rows with as many fields. Blank lines, lines
/// that begin with #, and spaces around fields are skipped. Columns of text, such as the ids of a sweep, may
/// stand beside those of numbers.
/// \throws InputError "FILE:LINE: …" for a missing file, a row of another length, or a table without rows;
/// also as check_column_names
Table read_table(const std::filesystem::path& path);

}  // namespace twincell
