#pragma once
// A table of keys against the reader and the reader's source.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "core/config.hpp"
#include "core/error.hpp"
#include "core/key_table.hpp"

namespace twincell {

using Assignments = std::vector<std::string>;

inline Assignments with_key(const KeyRow& row, const std::string& value) {
  Assignments all = row.with;
  all.push_back(row.key + "=" + value);
  return all;
}

/// TOML values that break the rule: beside its bounds, of another type, of another length.
inline std::vector<std::string> refused_by(const KeyRule& rule) {
  std::vector<std::string> values;
  const auto number = [&](double x) { return rule.whole ? fmt::format("{:.0f}", x) : fmt::format("{}", x); };
  const auto beside = [](const Bounds& bounds) {
    std::vector<double> out;
    if (bounds.lower) out.push_back(bounds.open_lower ? *bounds.lower : *bounds.lower - 1);
    constexpr double kLargestWritten = 1e18;  // a larger whole number is not valid TOML
    if (bounds.upper && *bounds.upper < kLargestWritten) out.push_back(2 * *bounds.upper + 1);
    return out;
  };
  if (rule.number || rule.whole)
    for (const double x : beside(rule.value)) values.push_back(number(x));
  for (const std::size_t length : rule.lengths)
    for (const double x : beside(rule.item)) {
      std::string list = number(x);
      for (std::size_t k = 1; k < length; ++k) list += ", 0.0";
      values.push_back("[" + list + "]");
    }
  if (!rule.words.empty()) values.emplace_back("\"no such word\"");
  if (rule.boolean || rule.text) values.emplace_back("3");
  if (!rule.text) values.emplace_back("\"a text\"");
  if (!rule.lengths.empty() || rule.pairs) values.emplace_back("[1.0]");
  return values;
}

/// Every example is read; every value beside the printed range is refused with the name of the key.
inline void expect_examples_and_ranges(const KeyTable& table) {
  const auto rules = rules_of(table);
  for (const KeyRow& row : table.rows) {
    const auto rule = rules.find(row.key);
    ASSERT_NE(rule, rules.end()) << row.key << " is not read";
    EXPECT_FALSE(rule->second.range().empty()) << row.key;
    try {
      table.read(with_key(row, row.example));
    } catch (const InputError&) {  // a file that the example names
    } catch (const Error& e) {
      ADD_FAILURE() << row.key << " = " << row.example << ": " << e.what();
    }
    if (rule->second.list && rule->second.lengths.empty()) continue;  // of items of any kind
    for (const std::string& value : refused_by(rule->second)) {
      try {
        table.read(with_key(row, value));
        ADD_FAILURE() << row.key << " = " << value << " is read";
      } catch (const ConfigError& e) {
        EXPECT_NE(std::string(e.what()).find(row.key), std::string::npos) << e.what();
      }
    }
  }
}

/// The assignments with which a default that is a value can be stated, without the key itself; absent for a
/// default in words.
inline std::optional<Assignments> context_of_default(const KeyTable& table, const KeyRow& row) {
  try {
    (void)Config::from_text("x = " + row.absent, "default");
  } catch (const ConfigError&) {
    return std::nullopt;
  }
  for (const Assignments& with : {row.with, Assignments{}}) {
    try {
      KeyRow stated = row;
      stated.with = with;
      table.read(with_key(stated, row.absent));
      return with;
    } catch (const InputError&) {
      return with;
    } catch (const ConfigError&) {  // the example needs keys that the default has no use for
    }
  }
  ADD_FAILURE() << row.key << " = " << row.absent << ", the default, is refused";
  return std::nullopt;
}

/// A stated default changes nothing and an example does. \param told everything that the reader makes of
/// assignments, as text \returns the number of defaults that are values
template <class Told>
int expect_defaults_change_nothing(const KeyTable& table, Told told) {
  int checked = 0;
  for (const KeyRow& row : table.rows) {
    const auto with = context_of_default(table, row);
    if (!with) continue;
    Assignments stated = *with;
    stated.push_back(row.key + "=" + row.absent);
    EXPECT_EQ(told(stated), told(*with)) << row.key;
    EXPECT_NE(told(with_key(row, row.example)), told(row.with)) << row.key << ": the example is the default";
    ++checked;
  }
  return checked;
}

/// Every key that the reader queried for any example has a row, once. \param name_of the key for which the
/// row stands
template <class Name>
void expect_a_row_for_every_query(const KeyTable& table, Name name_of) {
  std::set<std::string> rows;
  for (const KeyRow& row : table.rows) EXPECT_TRUE(rows.insert(row.key).second) << row.key << " stands twice";
  for (const auto& [key, rule] : rules_of(table))
    EXPECT_TRUE(rows.contains(name_of(key))) << key << " is read, but has no row";
}

/// Every key that is named in a query of these source files or folders is the last word of a row, so that a
/// key that no example reaches is not forgotten. \param paths relative to the source folder
inline void expect_a_row_for_every_query_in(const std::vector<std::string>& paths, const KeyTable& table,
                                            const std::set<std::string>& not_keys = {}) {
  std::set<std::string> last_words;
  for (const KeyRow& row : table.rows) last_words.insert(row.key.substr(row.key.rfind('.') + 1));
  const std::regex query(
      R"((?:number_in|integer_in|numbers_in|number|integer|numbers|pairs|boolean|text|word|read_word|read_motion|required)\((?:\w+, )?\s*"(\w+)\")");
  std::size_t found = 0;
  const auto look = [&](const std::filesystem::path& file) {
    std::ostringstream all;
    all << std::ifstream(file).rdbuf();
    const std::string text = all.str();
    for (std::sregex_iterator it(text.begin(), text.end(), query), end; it != end; ++it, ++found)
      EXPECT_TRUE(last_words.contains((*it)[1]) || not_keys.contains((*it)[1]))
          << (*it)[1] << " in " << file << " has no row";
  };
  for (const std::string& path : paths) {
    const std::filesystem::path whole = std::filesystem::path(TWINCELL_SOURCE_DIR) / path;
    if (!std::filesystem::is_directory(whole)) {
      look(whole);
      continue;
    }
    for (const auto& entry : std::filesystem::recursive_directory_iterator(whole))
      if (entry.is_regular_file()) look(entry.path());
  }
  EXPECT_GE(found, table.rows.size() / 4);
}

}  // namespace twincell
