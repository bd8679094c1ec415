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

std::vector<std::string_view> fields_of(std::string_view line) {
  constexpr std::string_view kSpace = " \t\r";
  const auto trimmed = [&](std::string_view field) {
    field.remove_prefix(std::min(field.find_first_not_of(kSpace), field.size()));
    return field.substr(0, field.find_last_not_of(kSpace) + 1);
  };
  std::vector<std::string_view> fields;
  for (std::size_t at = 0;;) {
    const std::size_t begin = std::min(line.find_first_not_of(kSpace, at), line.size());
    std::size_t after = begin;
    if (begin < line.size() && line[begin] == '"') {
      std::size_t quote = line.find('"', begin + 1);
      while (quote != std::string_view::npos && quote + 1 < line.size() && line[quote + 1] == '"')
        quote = line.find('"', quote + 2);
      if (quote != std::string_view::npos) after = quote + 1;
    }
    const std::size_t end = std::min(line.find(',', after), line.size());
    std::string_view field = trimmed(line.substr(at, end - at));
    if (field.size() > 1 && field.front() == '"' && field.back() == '"')
      field = trimmed(field.substr(1, field.size() - 2));
    fields.push_back(field);
    if (end == line.size()) return fields;
    at = end + 1;
  }
}

std::vector<std::string> field_texts(std::string_view line) {
  const std::vector<std::string_view> fields = fields_of(line);
  return {fields.begin(), fields.end()};
}

std::optional<std::size_t> twin_of_index(const std::vector<std::string>& names) {
  if (names.empty() || names.front().empty()) return {};
  const auto twin = std::find(names.begin() + 1, names.end(), names.front());
  return twin == names.end() ? std::nullopt : std::optional(static_cast<std::size_t>(twin - names.begin()));
}

void require_same_index(const std::vector<std::string_view>& fields, std::optional<std::size_t> twin,
                        const std::string& name, const Where& where) {
  if (!twin || fields.front() == fields[*twin]) return;
  throw InputError({.file = where.file, .line = where.line, .key = name},
                   fmt::format("the column occurs twice, with the values '{}' and '{}'.",
                               fields.front().substr(0, 60), fields[*twin].substr(0, 60)));
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
