#include "core/key_record.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace twincell {

namespace {

thread_local KeyRecord* current = nullptr;

std::string superscript(int exponent) {
  static constexpr const char* kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text;
  for (const char digit : std::to_string(exponent)) text += kDigits[digit - '0'];
  return text;
}

/// "1000", "10⁶", "2⁵³", "−0.2".
std::string value_text(double value) {
  if (value < 0) return fmt::format("−{}", value_text(-value));
  constexpr double kLong = 1e5;
  if (value >= kLong) {
    const int tens = static_cast<int>(std::lround(std::log10(value)));
    if (value == std::pow(10.0, tens)) return fmt::format("10{}", superscript(tens));
    if (const double twos = std::log2(value); twos == std::floor(twos))
      return fmt::format("2{}", superscript(static_cast<int>(twos)));
  }
  return fmt::format("{:g}", value);
}

}  // namespace

void Bounds::narrow(const Bounds& other) {
  if (other.lower && (!lower || *other.lower >= *lower)) {
    open_lower = other.open_lower || (open_lower && lower == other.lower);
    lower = other.lower;
  }
  if (other.upper && (!upper || *other.upper < *upper)) upper = other.upper;
}

std::string Bounds::text() const {
  if (lower && upper)
    return open_lower ? fmt::format("above {}, at most {}", value_text(*lower), value_text(*upper))
                      : fmt::format("{} … {}", value_text(*lower), value_text(*upper));
  if (lower)
    return open_lower ? fmt::format("above {}", value_text(*lower))
                      : fmt::format("{} or above", value_text(*lower));
  return upper ? fmt::format("at most {}", value_text(*upper)) : "";
}

void KeyRule::merge(const KeyRule& other) {
  number |= other.number, whole |= other.whole, boolean |= other.boolean;
  text |= other.text, list |= other.list, pairs |= other.pairs;
  value.narrow(other.value);
  item.narrow(other.item);
  lengths.insert(other.lengths.begin(), other.lengths.end());
  if (!other.words.empty()) words = other.words;
}

std::string KeyRule::range() const {
  std::vector<std::string> kinds;
  const auto with_bounds = [](const std::string& noun, const Bounds& bounds) {
    return bounds.text().empty() ? noun : noun + ", " + bounds.text();
  };
  if (!words.empty())
    kinds.push_back(fmt::format("\"{}\"", fmt::join(words, "\", \"")));
  else if (text)
    kinds.emplace_back("text");
  if (boolean) kinds.emplace_back("true, false");
  if (whole)
    kinds.push_back(with_bounds("whole number", value));
  else if (number)
    kinds.push_back(value.text().empty() ? "number" : value.text());
  if (!lengths.empty())
    kinds.push_back(with_bounds(fmt::format("{} numbers", fmt::join(lengths, " or ")), item));
  else if (list)
    kinds.emplace_back("list");
  if (pairs) kinds.emplace_back("list of pairs of numbers");
  return fmt::format("{}", fmt::join(kinds, "; or "));
}

KeyRecord::KeyRecord() : outer_(current) {
  current = this;
}

KeyRecord::~KeyRecord() {
  current = outer_;
}

void record_key(const std::string& key, const KeyRule& rule) {
  if (current != nullptr) current->rules_[key].merge(rule);
}

}  // namespace twincell
