#pragma once
/// \file
/// Tables of the keys of a configuration file, from which the reference of keys is printed. A row states what
/// the reader does not check: unit, default, an example, the meaning. The range is that which the reader
/// applies to the example (key_record.hpp).

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/key_record.hpp"

namespace twincell {

/// One spelling of a quantity.
struct KeyRow {
  std::string key;                     ///< with its tables: "cell.width"
  std::string unit;                    ///< "px"; empty for words, switches and counts
  std::string absent;                  ///< default: a TOML value, or a few words
  std::string example;                 ///< a TOML value that the reader accepts
  std::string meaning;                 ///< a clause; empty: another spelling of the quantity above
  std::vector<std::string> with = {};  ///< further assignments "section.key=value" that the example needs
};

/// All keys of one kind of file, in the order of the page, grouped by table.
struct KeyTable {
  std::string name;                                        ///< "scene"
  std::string title;                                       ///< "Scene"
  std::string intro;                                       ///< one paragraph of Markdown below the title
  std::vector<std::pair<std::string, std::string>> notes;  ///< table of keys, sentence below its heading
  std::vector<KeyRow> rows;
  /// Reads the file that assignments "section.key=value" make.
  /// \throws Error as the reader
  std::function<void(const std::vector<std::string>&)> read;
};

/// What the reader accepts for each key that it queried while reading all examples, one at a time. Files that
/// examples name need not exist.
std::map<std::string, KeyRule> rules_of(const KeyTable& table);

/// The range of a key by its rule, as KeyRule::range() writes it; empty for a key without a rule.
std::string range_of(const std::map<std::string, KeyRule>& rules, const std::string& key);

/// A heading and one Markdown table for each TOML table.
std::string key_markdown(const KeyTable& table);

/// The same for a terminal, at most 100 columns wide:
///
///     cell.width = 30.0    # σ; above 0, at most 10⁶; default 20
///         meaning
std::string key_text(const KeyTable& table);

}  // namespace twincell
