#include "trajectory/foreign/foreign_frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/error.hpp"

namespace twincell {

namespace {

constexpr std::size_t kExcerpt = 60;  // bytes of a word that a message shows

/// Whether the whole word is a number, which is stored in `value`.
template <class Number>
bool parses(std::string_view word, Number& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

}  // namespace

void enclose(ForeignFrame& s, int dimension) {
  for (const ForeignBead& bead : s.beads)
    for (int k = 0; k < dimension; ++k) {
      s.lower[k] = std::min(s.lower[k], bead.position[k] - bead.radius);
      s.upper[k] = std::max(s.upper[k], bead.position[k] + bead.radius);
    }
}

void ForeignReader::fail_at(long line, const std::string& complaint) const {
  throw InputError({file_.string(), line, 0, ""}, complaint);
}

std::optional<std::int64_t> ForeignReader::integer_of(double value) {
  if (value != std::floor(value) || std::abs(value) > kExact) return {};
  return static_cast<std::int64_t>(value);
}

std::int64_t ForeignReader::whole_at(long line, std::string_view word) const {
  std::int64_t value = 0;
  if (!parses(word, value))
    fail_at(line, fmt::format("'{}' is not a whole number.", word.substr(0, kExcerpt)));
  return value;
}

double ForeignReader::number_at(long line, std::string_view word, bool may_be_nan) const {
  double value = 0;
  if (!parses(word, value) || std::isinf(value) || (std::isnan(value) && !may_be_nan))
    fail_at(line, fmt::format("'{}' is not a finite number.", word.substr(0, kExcerpt)));
  return value;
}

}  // namespace twincell
