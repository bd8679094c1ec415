#include "core/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>

#include "core/error.hpp"
#include "core/plural.hpp"
#include "core/table_text.hpp"

namespace twincell {
namespace {

/// The number of a field, NaN for an empty one; nothing if it is not a finite number.
std::optional<double> number_of(std::string_view field) {
  if (field.empty() || field == "nan" || field == "NaN") return std::numeric_limits<double>::quiet_NaN();
  double value = 0;
  const char* first = field.data() + (field.front() == '+' ? 1 : 0);
  const auto [end, error] = std::from_chars(first, field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(value)) return {};
  return value;
}

/// 1 or 0 for a mark, as pandas writes them; nothing for other fields.
std::optional<double> mark_of(std::string_view field) {
  if (field == "True" || field == "true") return 1;
  if (field == "False" || field == "false") return 0;
  return {};
}

}  // namespace

std::size_t Table::index_of(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw ConfigError(
        {.file = file, .key = "column"},
        fmt::format("there is no column \"{}\"; the columns are {}", name, fmt::join(names, ", ")));
  return static_cast<std::size_t>(found - names.begin());
}

const std::vector<double>& Table::column_of_marks(const std::string& name) const {
  const std::size_t c = index_of(name);
  return marks.contains(c) ? columns[c] : column(name);
}

const std::vector<double>& Table::column(const std::string& name) const {
  const std::size_t c = index_of(name);
  const auto is_text = [&](std::size_t k) { return texts.contains(k); };
  if (!is_text(c)) return columns[c];
  std::vector<std::string> numeric;
  for (std::size_t k = 0; k < names.size(); ++k)
    if (!is_text(k) &&
        std::any_of(columns[k].begin(), columns[k].end(), [](double v) { return !std::isnan(v); }))
      numeric.push_back(names[k]);
  const Text& text = texts.at(c);
  throw InputError(
      {.file = file, .line = text.line, .key = name},
      fmt::format("\"{}\" is not a finite number; {}", text.word,
                  numeric.empty() ? "no column holds numbers alone"
                                  : fmt::format("columns of numbers are {}", fmt::join(numeric, ", "))));
}

Table read_table(const std::filesystem::path& path) {
  Table table;
  table.file = path.string();
  std::istringstream in(read_table_text(path));
  long line_number = 0;
  std::optional<std::size_t> twin;  // of a column that pandas wrote twice
  for (std::string line; std::getline(in, line);) {
    ++line_number;
    const std::vector<std::string_view> fields = fields_of(line);
    if ((fields.size() == 1 && fields.front().empty()) || fields.front().starts_with('#')) continue;
    const Where where{.file = table.file, .line = line_number, .key = {}};
    if (table.names.empty()) {
      table.names.assign(fields.begin(), fields.end());
      twin = twin_of_index(table.names);
      check_column_names({table.names.begin() + (twin ? 1 : 0), table.names.end()}, where);
      table.columns.resize(fields.size());
      for (std::size_t c = 0; c < fields.size(); ++c) table.marks.insert(c);
      continue;
    }
    if (fields.size() != table.names.size())
      throw InputError(where, fmt::format("has {}; the header line has {}", plural(fields.size(), "field"),
                                          table.names.size()));
    require_same_index(fields, twin, table.names.front(), where);
    for (std::size_t c = 0; c < fields.size(); ++c) {
      const auto number = number_of(fields[c]);
      if (!number) table.texts.try_emplace(c, Table::Text{line_number, std::string(fields[c].substr(0, 60))});
      const auto mark = number ? std::nullopt : mark_of(fields[c]);
      if (!mark) table.marks.erase(c);
      table.columns[c].push_back(number ? *number : mark.value_or(std::numeric_limits<double>::quiet_NaN()));
    }
  }
  if (table.n_rows() == 0)
    throw InputError({.file = table.file, .key = {}}, "there is no row of numbers below the header line");
  return table;
}

}  // namespace twincell
