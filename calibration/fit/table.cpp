#include "calibration/fit/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/error.hpp"
#include "core/table_text.hpp"

namespace twincell {
namespace {

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::string field;
  std::istringstream in(line);
  while (std::getline(in, field, ',')) fields.push_back(trimmed(field));
  if (line.ends_with(',')) fields.emplace_back();
  return fields;
}

double number_of(const std::string& field, const Where& where) {
  if (field.empty() || field == "nan" || field == "NaN") return std::numeric_limits<double>::quiet_NaN();
  double value = 0;
  const char* first = field.data() + (field.front() == '+' ? 1 : 0);
  const auto [end, error] = std::from_chars(first, field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size())
    throw InputError(where, fmt::format("\"{}\" is not a number", field));
  if (std::isinf(value)) throw InputError(where, fmt::format("\"{}\" is not a finite number", field));
  return value;
}

}  // namespace

const std::vector<double>& Table::column(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw ConfigError(
        {.file = file, .key = "column"},
        fmt::format("there is no column \"{}\"; the columns are {}", name, fmt::join(names, ", ")));
  return columns[static_cast<std::size_t>(found - names.begin())];
}

Table read_table(const std::filesystem::path& path) {
  Table table;
  table.file = path.string();
  std::istringstream in(read_table_text(path));
  long line_number = 0;
  for (std::string line; std::getline(in, line);) {
    ++line_number;
    const std::string content = trimmed(line);
    if (content.empty() || content.front() == '#') continue;
    const std::vector<std::string> fields = fields_of(content);
    if (table.names.empty()) {
      table.names = fields;
      check_column_names(fields, {.file = table.file, .line = line_number, .key = {}});
      table.columns.resize(fields.size());
      continue;
    }
    const Where where{.file = table.file, .line = line_number, .key = {}};
    if (fields.size() != table.names.size())
      throw InputError(
          where, fmt::format("has {} fields; the header line has {}", fields.size(), table.names.size()));
    for (std::size_t c = 0; c < fields.size(); ++c)
      table.columns[c].push_back(
          number_of(fields[c], {.file = table.file, .line = line_number, .key = table.names[c]}));
  }
  if (table.n_rows() == 0)
    throw InputError({.file = table.file, .key = {}}, "there is no row of numbers below the header line");
  return table;
}

}  // namespace twincell
