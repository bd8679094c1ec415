#include "core/table_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <set>

#include "core/atomic_file.hpp"

namespace twincell {

namespace {

bool is_number(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error != std::errc::invalid_argument && end == text.data() + text.size();
}

}  // namespace

std::string read_table_text(const std::filesystem::path& file) {
  std::string text = read_text_file(file);
  // The two bytes of the mark alone may also start a name in another encoding. A UTF-16 table also contains
  // zero bytes.
  const bool marked = text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF");
  if (marked && text.find('\0') != std::string::npos)
    throw InputError({.file = file.string(), .key = {}}, "is UTF-16 text; save it as UTF-8.");
  if (text.find('\0') != std::string::npos)
    throw InputError({.file = file.string(), .key = {}}, "is not a text file, because it holds zero bytes.");
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n') continue;
    text[kept++] = text[i] == '\r' ? '\n' : text[i];
  }
  text.resize(kept);
  return text;
}

void check_column_names(const std::vector<std::string>& names, const Where& where) {
  if (names.size() == 1 && names.front().find_first_of(";\t") != std::string::npos)
    throw InputError(where,
                     fmt::format("the fields are separated by {}; use commas, and decimal points in numbers.",
                                 names.front().find(';') != std::string::npos ? "semicolons" : "tabs"));
  if (std::all_of(names.begin(), names.end(), is_number))
    throw InputError(where, "the first line holds numbers; it must name the columns.");
  std::set<std::string> seen;
  for (const std::string& name : names)
    if (!name.empty() && !seen.insert(name).second)
      throw InputError({.file = where.file, .line = where.line, .column = where.column, .key = name},
                       "the column occurs twice.");
}

}  // namespace twincell
