#pragma once
/// \file
/// A choice made at run time by a word: one table {value, word, help} that readers, messages and docs share.

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace twincell {

/// One of the values that a key or an option may take.
template <class Value>
struct Choice {
  Value value;
  std::string_view word;
  std::string_view help;
};

/// The words of a table, the first of which is the default.
template <class Value, std::size_t kCount>
std::vector<std::string> words_of(const std::array<Choice<Value>, kCount>& table) {
  std::vector<std::string> words;
  for (const auto& choice : table) words.emplace_back(choice.word);
  return words;
}

/// The value that a word names. Needs a word of the table.
template <class Value, std::size_t kCount>
Value value_of_word(const std::array<Choice<Value>, kCount>& table, std::string_view word) {
  for (const auto& choice : table)
    if (choice.word == word) return choice.value;
  return table.front().value;
}

}  // namespace twincell
