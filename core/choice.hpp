#pragma once
/// \file
/// Choices made at run time by a word: lookup in a table whose rows have a member `word`. The first row is
/// the default.

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace twincell {

/// A table row that consists of a value, its word and one line of help.
template <class Value>
struct Choice {
  Value value;
  std::string_view word;
  std::string_view help;  ///< one clause, without a full stop
};

/// The words of a table, in table order.
template <class Table>
std::vector<std::string> words_of(const Table& table) {
  std::vector<std::string> words;
  for (const auto& row : table) words.emplace_back(row.word);
  return words;
}

/// Help text of a table whose rows have a member `help`: "exact: fit of the picture; fast: ...".
template <class Table>
std::string help_of(const Table& table) {
  std::string text;
  for (const auto& row : table) {
    if (!text.empty()) text += "; ";
    text.append(row.word).append(": ").append(row.help);
  }
  return text;
}

/// The row of a value, for tables whose rows have a member `value`.
/// \pre the table has such a row
template <class Table, class Value>
constexpr const auto& row_of(const Table& table, Value value) {
  return *std::find_if(std::begin(table), std::end(table), [&](const auto& r) { return r.value == value; });
}

/// \throws ConfigError always, at `key`: "there is no NOUN 'WORD'; there are: ...".
[[noreturn]] void refuse_word(const std::string& key, const std::string& noun, const std::string& word,
                              const std::vector<std::string>& words);

/// The row whose word is `word`.
/// \throws ConfigError as refuse_word if there is no such row
template <class Table>
const auto& row_named(const Table& table, const std::string& word, const std::string& key,
                      const std::string& noun) {
  const auto row =
      std::find_if(std::begin(table), std::end(table), [&](const auto& r) { return r.word == word; });
  if (row == std::end(table)) refuse_word(key, noun, word, words_of(table));
  return *row;
}

}  // namespace twincell
