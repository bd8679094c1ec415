#include "core/nearest_word.hpp"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <utility>

namespace twincell {

namespace {

/// Levenshtein distance.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({substituted, row[j] + 1, row[j - 1] + 1}));
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_word(const std::string& word, const std::vector<std::string>& known) {
  const auto lower = [](unsigned char c) { return std::tolower(c); };
  for (const std::string& candidate : known)
    if (std::ranges::equal(candidate, word, {}, lower, lower)) return candidate;
  std::string nearest;
  // Half of a short word could be anything.
  const auto letters = static_cast<std::size_t>(
      std::ranges::count_if(word, [](unsigned char c) { return std::isalnum(c) != 0; }));
  std::size_t smallest = std::min<std::size_t>(3, (letters + 1) / 2) + 1;
  for (const std::string& candidate : known)
    if (const std::size_t d = edit_distance(candidate, word);
        d < smallest && d < std::max(candidate.size(), word.size())) {
      smallest = d;
      nearest = candidate;
    }
  return nearest;
}

}  // namespace twincell
