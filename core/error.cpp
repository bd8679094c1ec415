#include "core/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace twincell {

std::string Where::text() const {
  std::string out = file;
  if (line > 0) out += fmt::format(":{}", line);
  if (line > 0 && column > 0) out += fmt::format(":{}", column);
  if (!key.empty()) out += (out.empty() ? "" : ": ") + key;
  return out;
}

namespace {
std::string sentence(const Where& where, const std::string& complaint) {
  const std::string place = where.text();
  return place.empty() ? complaint : place + ": " + complaint;
}
}  // namespace

ConfigError::ConfigError(const Where& where, const std::string& complaint)
    : Error(ExitCode::usage, sentence(where, complaint)) {}

InputError::InputError(const Where& where, const std::string& complaint)
    : Error(ExitCode::input, sentence(where, complaint)) {}

void require_range(const Where& where, double value, std::optional<double> lower, std::optional<double> upper,
                   bool open_lower) {
  const bool above = !lower || (open_lower ? value > *lower : value >= *lower);
  const bool below = !upper || value <= *upper;
  if (std::isfinite(value) && above && below) return;
  std::string bound;
  // Twelve digits: a bound that is computed is not shown as 0.20000000000000007.
  if (lower) bound += fmt::format("{} {:.12g}", open_lower ? "greater than" : "at least", *lower);
  if (upper) bound += fmt::format("{}at most {:.12g}", lower ? " and " : "", *upper);
  if (bound.empty()) bound = "finite";
  throw ConfigError(where, fmt::format("{:.12g} is out of range; the value must be {}.", value, bound));
}

}  // namespace twincell
