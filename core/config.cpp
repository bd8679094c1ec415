#include "core/config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <utility>

#include "core/atomic_file.hpp"
#include "core/key_record.hpp"
#include "core/nearest_word.hpp"
#include "core/placeholder.hpp"

namespace twincell {

struct ConfigSection::Shared {
  std::string name;  ///< name of the file, for messages about absent keys
  toml::table table;
  std::set<std::string> asked;         ///< full keys that were queried
  std::map<std::string, Where> stood;  ///< restated keys: as written, with position

  Where where_of(const toml::node& node, const std::string& key) const {
    const toml::source_region& at = node.source();
    return {at.path ? *at.path : name, static_cast<long>(at.begin.line), static_cast<long>(at.begin.column),
            key};
  }
};

namespace {

/// Name of a TOML type for error messages, with its article.
std::string kind_of(const toml::node& node) {
  if (node.is_integer()) return "an integer";
  if (node.is_floating_point()) return "a number with a decimal point";
  if (node.is_array()) return "a list";
  std::ostringstream text;
  text << node.type();
  return "a " + text.str();
}

}  // namespace

namespace {
const toml::node* find(const toml::table& root, const std::string& path) {
  const toml::node* node = &root;
  for (std::size_t begin = 0; node != nullptr && begin <= path.size() && !path.empty();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const toml::table* table = node->as_table();
    node = table == nullptr ? nullptr : table->get(std::string_view(path).substr(begin, end - begin));
    begin = end + 1;
  }
  return node;
}
}  // namespace

Where ConfigSection::where(const std::string& key) const {
  const std::string path = full(key);
  if (const toml::node* node = find(shared_->table, path)) {
    const auto written = shared_->stood.find(path);
    return written != shared_->stood.end() ? written->second : shared_->where_of(*node, path);
  }
  if (const std::size_t dot = path.rfind('.'); dot != std::string::npos)
    if (const toml::node* table = find(shared_->table, path.substr(0, dot)))
      return shared_->where_of(*table, path);
  return {shared_->name, 0, 0, path};
}

namespace {
/// Keys of all placeholders in a table, in the order of the file.
void collect_placeholders(const toml::table& table, const std::string& prefix,
                          std::vector<std::string>& keys) {
  for (const auto& [key, node] : table) {
    const std::string path = prefix + std::string(key.str());
    if (const toml::table* inner = node.as_table()) collect_placeholders(*inner, path + ".", keys);
    if (const auto text = node.value_exact<std::string>(); text && text->starts_with(kPlaceholder))
      keys.push_back(path);
  }
}
}  // namespace

bool ConfigSection::has(const std::string& key) const {
  const std::string path = full(key);
  shared_->asked.insert(path);
  const toml::node* node = find(shared_->table, path);
  if (node == nullptr) return false;
  if (const auto text = node->value_exact<std::string>(); text && text->starts_with(kPlaceholder)) {
    std::vector<std::string> keys;
    collect_placeholders(shared_->table, "", keys);
    std::erase(keys, path);
    throw ConfigError(
        where(key), fmt::format("is not filled in yet: {}{}.", text->substr(std::string(kPlaceholder).size()),
                                keys.empty() ? "" : fmt::format(" (as are {})", fmt::join(keys, ", "))));
  }
  return true;
}

namespace {
/// "; a decimal number is written with a point: 1.5" for the text "1,5" and the list [1,5], which a decimal
/// comma makes of a number; otherwise empty.
std::string without_decimal_comma(const toml::node& node) {
  std::string text = node.value_exact<std::string>().value_or("");
  if (const toml::array* list = node.as_array(); list != nullptr && list->size() == 2) {
    const auto whole = list->get(0)->value_exact<std::int64_t>(),
               decimals = list->get(1)->value_exact<std::int64_t>();
    if (whole && decimals && *decimals >= 0) text = fmt::format("{},{}", *whole, *decimals);
  }
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos || text.find_first_not_of("0123456789,+-eE") != std::string::npos ||
      text.find(',', comma + 1) != std::string::npos)
    return {};
  text[comma] = '.';
  return fmt::format("; a decimal number is written with a point: {}", text);
}

template <class T>
std::optional<T> value_of(const toml::node* node, const Where& where, const char* wanted) {
  if (node == nullptr) return std::nullopt;
  std::optional<T> value = node->value_exact<T>();
  if (!value)
    throw ConfigError(
        where, fmt::format("{} is needed, not {}{}.", wanted, kind_of(*node), without_decimal_comma(*node)));
  return value;
}
}  // namespace

std::optional<double> ConfigSection::number(const std::string& key) const {
  record_key(full(key), {.number = true});
  if (!has(key)) return std::nullopt;
  const toml::node* node = find(shared_->table, full(key));
  if (const auto whole = node->value_exact<std::int64_t>()) return static_cast<double>(*whole);
  const auto value = value_of<double>(node, where(key), "a number");
  if (value && !std::isfinite(*value)) throw ConfigError(where(key), "a finite number is needed.");
  return value;
}

std::optional<std::int64_t> ConfigSection::integer(const std::string& key) const {
  record_key(full(key), {.whole = true});
  return has(key) ? value_of<std::int64_t>(find(shared_->table, full(key)), where(key), "a whole number")
                  : std::nullopt;
}

std::optional<double> ConfigSection::number_in(const std::string& key, std::optional<double> lower,
                                               std::optional<double> upper, bool open_lower) const {
  record_key(full(key), {.value = {lower, upper, open_lower}});
  auto value = number(key);
  if (value) require_range(where(key), *value, lower, upper, open_lower);
  return value;
}

std::optional<std::int64_t> ConfigSection::integer_in(const std::string& key, std::int64_t lower,
                                                      std::int64_t upper) const {
  record_key(full(key), {.value = {static_cast<double>(lower), static_cast<double>(upper)}});
  auto value = integer(key);
  // Compared as integers: above 2^53 a double cannot represent every integer.
  if (value && (*value < lower || *value > upper))
    throw ConfigError(where(key),
                      fmt::format("{} is out of range; the value must be at least {} and at most {}.", *value,
                                  lower, upper));
  return value;
}

std::optional<bool> ConfigSection::boolean(const std::string& key) const {
  record_key(full(key), {.boolean = true});
  return has(key) ? value_of<bool>(find(shared_->table, full(key)), where(key), "true or false")
                  : std::nullopt;
}

std::optional<std::string> ConfigSection::text(const std::string& key) const {
  record_key(full(key), {.text = true});
  return has(key) ? value_of<std::string>(find(shared_->table, full(key)), where(key), "a text in quotes")
                  : std::nullopt;
}

namespace {
/// The numbers of a list; nullopt if the node is not a list or if an element is not a finite number.
std::optional<std::vector<double>> finite_numbers(const toml::node& node) {
  const toml::array* list = node.as_array();
  if (list == nullptr) return std::nullopt;
  std::vector<double> values;
  for (const toml::node& item : *list)
    if (const auto value = item.value<double>(); value && std::isfinite(*value)) values.push_back(*value);
  return values.size() == list->size() ? std::optional(values) : std::nullopt;
}
}  // namespace

std::optional<std::vector<double>> ConfigSection::numbers(const std::string& key, std::size_t count) const {
  record_key(full(key), {.lengths = {count}});
  if (!has(key)) return std::nullopt;
  auto values = finite_numbers(*find(shared_->table, full(key)));
  if (!values || values->size() != count)
    throw ConfigError(where(key), fmt::format("a list of {} numbers is needed.", count));
  return values;
}

std::optional<std::vector<std::pair<double, double>>> ConfigSection::pairs(const std::string& key) const {
  record_key(full(key), {.pairs = true});
  if (!has(key)) return std::nullopt;
  const toml::array* list = find(shared_->table, full(key))->as_array();
  std::vector<std::pair<double, double>> values;
  if (list != nullptr)
    for (const toml::node& item : *list)
      if (const auto pair = finite_numbers(item); pair && pair->size() == 2)
        values.emplace_back(pair->front(), pair->back());
  if (list == nullptr || list->empty() || values.size() != list->size())
    throw ConfigError(where(key), "a list of pairs of numbers is needed, [[a, b], [c, d]].");
  return values;
}

bool ConfigSection::is_list(const std::string& key) const {
  record_key(full(key), {.list = true});
  return has(key) && find(shared_->table, full(key))->is_array();
}

std::optional<std::string> ConfigSection::word(const std::string& key,
                                               const std::vector<std::string>& words) const {
  record_key(full(key), {.words = words});
  auto value = text(key);
  if (value && std::find(words.begin(), words.end(), *value) == words.end())
    throw ConfigError(where(key), fmt::format("'{}' is not one of {}.", *value, fmt::join(words, ", ")));
  return value;
}

ConfigSection ConfigSection::section(const std::string& key) const {
  const toml::node* node = has(key) ? find(shared_->table, full(key)) : nullptr;
  if (node != nullptr && !node->is_table())
    throw ConfigError(where(key), fmt::format("a table is needed, not {}.", kind_of(*node)));
  return {shared_, full(key)};
}

namespace {

/// Rejects text whose tables and lists would be nested more than kDeepest levels deep. The parser and every
/// visitor of its tables are recursive, so that a key of ten thousand dots would overflow the stack. The
/// depth is counted from the text: the dots of the table's header and of the key, plus those of each open
/// list and inline table. (A decimal point counts as a dot, which does no harm.) Up to the first error in the
/// text, this scan reads strings and comments as the parser does; the parser does not read beyond that error.
void refuse_deep(const std::string& text, const std::string& name) {
  constexpr std::size_t kDeepest = 100;
  std::size_t header = 0, line = 1;
  std::vector<std::size_t> dots = {0};  // of the current key: outermost, then one per open bracket
  std::size_t outer = 0;                // sum of all but the last
  bool in_header = false, line_is_empty = true;
  const auto look = [&] {
    if (header + outer + dots.size() - 1 + dots.back() <= kDeepest) return;
    throw ConfigError({name, static_cast<long>(line), 0, ""},
                      fmt::format("tables and lists are nested more than {} levels deep.", kDeepest));
  };
  const auto at = [&](std::size_t k) { return k < text.size() ? text[k] : '\0'; };
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (c == '#') {
      k = std::min(text.find('\n', k), text.size()) - 1;
    } else if (c == '"' || c == '\'') {
      const bool several = at(k + 1) == c && at(k + 2) == c;
      for (k += several ? 3 : 1; k < text.size(); ++k) {
        if (text[k] == '\n') {
          ++line;
          if (!several) break;
        }
        if (text[k] == '\\' && c == '"') {
          ++k;
          line += at(k) == '\n' ? 1 : 0;
        } else if (text[k] == c && (!several || (at(k + 1) == c && at(k + 2) == c))) {
          if (several)
            for (k += 2; at(k + 1) == c;) ++k;  // quotes just before the delimiter belong to the text
          break;
        }
      }
      line_is_empty = false;
    } else if (c == '\n') {
      ++line;
      if (in_header) header = dots.front() + 1;
      if (dots.size() == 1) dots.front() = 0;
      in_header = false;
      line_is_empty = true;
    } else if (c == '.') {
      ++dots.back();
      look();
    } else if (c == ',') {
      if (!in_header) dots.back() = 0;
    } else if (c == '[' && dots.size() == 1 && (line_is_empty || in_header)) {
      in_header = true, line_is_empty = false, header = 0;
    } else if (c == '[' || c == '{') {
      outer += dots.back();
      dots.push_back(0);
      look();
    } else if ((c == ']' || c == '}') && dots.size() > 1) {
      dots.pop_back();
      outer -= dots.back();
    } else if (c != ' ' && c != '\t' && c != '\r') {
      line_is_empty = false;
    }
  }
}

/// "; a decimal number is written with a point: 1.5" if the value of the line is such a number with a comma.
std::string of_decimal_comma(const std::string& text, std::size_t line) {
  std::size_t begin = 0;
  for (std::size_t n = 1; n < line && begin != std::string::npos; ++n) {
    begin = text.find('\n', begin);
    if (begin != std::string::npos) ++begin;
  }
  if (begin == std::string::npos) return {};
  constexpr std::size_t kLongest = 200;  // the matching recurses with each character
  const std::string written = text.substr(begin, text.find('\n', begin) - begin);
  static const std::regex number(R"(^[^=#]*=[ \t]*([+-]?[0-9]+),([0-9]+([eE][+-]?[0-9]+)?)[ \t\r]*(#.*)?$)");
  std::smatch found;
  if (written.size() > kLongest || !std::regex_match(written, found, number)) return {};
  return fmt::format("; a decimal number is written with a point: {}.{}", found.str(1), found.str(2));
}

}  // namespace

Config Config::from_text(const std::string& text, const std::string& name) {
  if (text.size() > kLargestConfig)
    throw ConfigError({name, 0, 0, ""},
                      fmt::format("{} bytes are more than the {} that a configuration may have.", text.size(),
                                  kLargestConfig));
  refuse_deep(text, name);
  auto shared = std::make_shared<ConfigSection::Shared>();
  shared->name = name;
  try {
    shared->table = toml::parse(text, name);
  } catch (const toml::parse_error& e) {
    const auto& at = e.source().begin;
    throw ConfigError({name, static_cast<long>(at.line), static_cast<long>(at.column), ""},
                      std::string(e.description()) + of_decimal_comma(text, at.line) + ".");
  }
  return Config(std::move(shared));
}

Config Config::from_file(const std::filesystem::path& path) {
  const std::string text = read_text_file(path, kLargestConfig);
  if (text.find('\0') != std::string::npos)
    throw InputError({.file = path.string()}, "is not a TOML file, because it holds zero bytes.");
  return from_text(text, path.string());
}

namespace {

/// Moves the keys that `upper` lacks from `lower` to `upper`, whose tables keep their own source positions.
/// Nodes are moved because a copied node loses its source position.
void fill_in(toml::table& upper, toml::table&& lower) {
  for (auto&& [key, node] : lower) {
    toml::node* above = upper.get(key);
    if (above == nullptr)
      node.visit(
          [&upper, k = std::string(key.str())](auto& value) { upper.insert_or_assign(k, std::move(value)); });
    else if (above->is_table() && node.is_table())
      fill_in(*above->as_table(), std::move(*node.as_table()));
  }
}

}  // namespace

void Config::overlay(Config&& upper) {
  for (auto& [key, written] : shared_->stood)
    if (find(upper.shared_->table, key) == nullptr) upper.shared_->stood[key] = written;
  shared_->stood = std::move(upper.shared_->stood);
  fill_in(upper.shared_->table, std::move(shared_->table));
  shared_->table = std::move(upper.shared_->table);
  shared_->name = upper.shared_->name;
}

void Config::yield_to(const Config& upper, const std::string& section,
                      const std::vector<std::string>& alternatives) {
  const auto named = [&](const std::string& key) {
    return find(upper.shared_->table, section + "." + key) != nullptr;
  };
  if (std::none_of(alternatives.begin(), alternatives.end(), named)) return;
  const toml::node_view<toml::node> table = shared_->table.at_path(section);
  if (!table.is_table()) return;
  for (const auto& key : alternatives) {
    table.as_table()->erase(key);
    shared_->stood.erase(section + "." + key);
  }
}

namespace {

/// The table that contains the last word of `path`; nullptr if there is none.
/// \param make create missing tables
toml::table* table_above(toml::table& root, const std::string& path, bool make) {
  toml::table* table = &root;
  std::size_t begin = 0;
  for (std::size_t end = 0; table != nullptr && (end = path.find('.', begin)) != std::string::npos;
       begin = end + 1) {
    const std::string_view word = std::string_view(path).substr(begin, end - begin);
    toml::node* below = table->get(word);
    if (below == nullptr && make) below = &table->insert_or_assign(word, toml::table{}).first->second;
    table = below == nullptr ? nullptr : below->as_table();
  }
  return table;
}

std::string_view last_word(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  return std::string_view(path).substr(dot == std::string::npos ? 0 : dot + 1);
}

}  // namespace

void Config::adopt(Config& lower, const std::string& from, const std::string& to) {
  toml::table* source = table_above(lower.shared_->table, from, false);
  toml::table* target = table_above(shared_->table, to, true);
  if (source == nullptr || target == nullptr) return;
  // Moved, because a copied node loses its source position.
  if (toml::node* node = source->get(last_word(from)))
    node->visit([&](auto& value) { target->insert_or_assign(last_word(to), std::move(value)); });
}

void Config::restate(const std::string& from, const std::string& to, double value) {
  const Where written = root().where(from);
  erase(from);
  if (toml::table* table = table_above(shared_->table, to, true))
    table->insert_or_assign(last_word(to), value);
  shared_->stood[to] = written;
}

void Config::erase(const std::string& path) {
  shared_->stood.erase(path);
  if (toml::table* table = table_above(shared_->table, path, false)) table->erase(last_word(path));
}

void Config::assign(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  const Where where{"--set", 0, 0, assignment};
  if (equals == std::string::npos || equals == 0)
    throw ConfigError(where, "must have the form section.key=value.");
  const std::string key = assignment.substr(0, equals), value = assignment.substr(equals + 1);
  const std::string name = shared_->name;
  auto parsed = [&](const std::string& text) { return from_text(key + " = " + text + "\n", "--set " + key); };
  try {
    overlay(parsed(value));
  } catch (const ConfigError&) {
    std::string quoted = "\"";
    for (char c : value) quoted += (c == '"' || c == '\\' ? std::string("\\") : std::string()) + c;
    overlay(parsed(quoted + "\""));
  }
  shared_->name = name;
}

ConfigSection Config::root() const {
  return {shared_, ""};
}

namespace {

void walk(const toml::table& table, const std::string& path, const std::set<std::string>& asked,
          const std::function<void(const std::string&, const toml::node&)>& complain) {
  for (auto&& [key, node] : table) {
    const std::string full = path.empty() ? std::string(key.str()) : path + "." + std::string(key.str());
    // A dot in a quoted key is part of its name: "cell.width" in quotes is not the width of the cell.
    const bool quoted = key.str().empty() || key.str().find('.') != std::string_view::npos;
    if (quoted || !asked.contains(full)) complain(full, node);
    if (const toml::table* below = node.as_table()) walk(*below, full, asked, complain);
  }
}

/// The known key that is nearest to a wrong one; if none is near, the first of the same name in another
/// table.
std::string nearest_key(const std::string& key, const std::vector<std::string>& known) {
  const auto name = [](const std::string& k) { return k.substr(k.rfind('.') + 1); };
  const std::string near = nearest_word(key, known);
  if (!near.empty()) return near;
  const auto same = std::find_if(known.begin(), known.end(),
                                 [&](const std::string& k) { return k != key && name(k) == name(key); });
  return same == known.end() ? "" : *same;
}

/// "; [time] has cycles, discard, ...": the keys that are known in the table of a wrong one, if a reader can
/// look through them.
std::string keys_of_table(const std::string& key, const std::set<std::string>& known) {
  constexpr std::size_t kMost = 16;
  const std::size_t point = key.rfind('.');
  if (point == std::string::npos) return {};
  const std::string table = key.substr(0, point);
  std::vector<std::string> names;
  for (auto at = known.lower_bound(table + "."); at != known.end() && at->starts_with(table + "."); ++at)
    if (at->find('.', point + 1) == std::string::npos) names.push_back(at->substr(point + 1));
  if (names.empty() || names.size() > kMost) return {};
  return fmt::format("; [{}] has {}", table, fmt::join(names, ", "));
}

}  // namespace

void Config::refuse_unknown_keys() const {
  walk(shared_->table, "", shared_->asked, [&](const std::string& key, const toml::node& node) {
    const std::string nearest = nearest_key(key, {shared_->asked.begin(), shared_->asked.end()});
    if (nearest == key)
      throw ConfigError(
          shared_->where_of(node, key),
          "is a name in quotes, in which a point does not separate table and key; write it without quotes.");
    throw ConfigError(shared_->where_of(node, key),
                      nearest.empty() ? "there is no such key" + keys_of_table(key, shared_->asked) + "."
                                      : fmt::format("there is no such key; did you mean '{}'?", nearest));
  });
}

std::string Config::text() const {
  std::ostringstream out;
  out << shared_->table << "\n";
  return out.str();
}

}  // namespace twincell
