#pragma once
/// \file
/// Records the keys that the reader of a configuration queries, with the values that it accepts. The
/// reference of keys is made from these records, so that it states what the readers check.

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace twincell {

/// Bounds of a number; an absent bound does not limit it.
struct Bounds {
  std::optional<double> lower, upper;
  bool open_lower = false;  ///< the lower bound itself is refused

  /// Keeps the tighter of both bounds on each side.
  void narrow(const Bounds& other);
  /// "0 … 10⁶", "above 0", "0 or above"; empty without bounds.
  [[nodiscard]] std::string text() const;
};

/// The values that a reader accepts for one key. A key may accept several types.
struct KeyRule {
  bool number = false, whole = false, boolean = false, text = false, list = false, pairs = false;
  Bounds value;                   ///< of a number or whole number
  std::set<std::size_t> lengths;  ///< of a list of numbers
  Bounds item;                    ///< of each number of a list
  std::vector<std::string> words = {};

  /// Adds the types that `other` accepts, and narrows the bounds by those of `other`.
  void merge(const KeyRule& other);
  /// "whole number, 1 … 24", "\"walls\", \"periodic\"", "true, false".
  [[nodiscard]] std::string range() const;
};

/// While it lives, records the queries of this thread. A record inside another one takes its place.
class KeyRecord {
 public:
  KeyRecord();
  ~KeyRecord();
  KeyRecord(const KeyRecord&) = delete;
  KeyRecord& operator=(const KeyRecord&) = delete;
  /// Rules by key with its tables, "cell.width".
  [[nodiscard]] const std::map<std::string, KeyRule>& rules() const { return rules_; }

 private:
  friend void record_key(const std::string& key, const KeyRule& rule);
  std::map<std::string, KeyRule> rules_;
  KeyRecord* outer_;
};

/// Adds a rule to the current record; does nothing if there is none. The getters of ConfigSection call it.
void record_key(const std::string& key, const KeyRule& rule);

}  // namespace twincell
