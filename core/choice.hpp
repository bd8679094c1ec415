#pragma once
/// \file
/// A choice made at run time by a word: a table whose rows have a member `word`, the first being the default.

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace twincell {

/// A row that holds a value and no more.
template <class Value>
struct Choice {
  Value value;
  std::string_view word;
};

/// The words of a table, in its order.
template <class Table>
std::vector<std::string> words_of(const Table& table) {
  std::vector<std::string> words;
  for (const auto& row : table) words.emplace_back(row.word);
  return words;
}

/// Throws ConfigError at `key`: "there is no NOUN 'WORD'; there are: ...".
[[noreturn]] void refuse_word(const std::string& key, const std::string& noun, const std::string& word,
                              const std::vector<std::string>& words);

/// The row that a word names. \throws ConfigError as refuse_word
template <class Table>
const auto& row_named(const Table& table, const std::string& word, const std::string& key,
                      const std::string& noun) {
  const auto row =
      std::find_if(std::begin(table), std::end(table), [&](const auto& r) { return r.word == word; });
  if (row == std::end(table)) refuse_word(key, noun, word, words_of(table));
  return *row;
}

}  // namespace twincell
