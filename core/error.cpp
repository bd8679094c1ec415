#include "core/error.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

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

/// Whether a text ends as a sentence does, also with the stop within closing brackets. "…" marks a text that
/// was cut.
bool is_ended(std::string_view text) {
  while (text.ends_with(')') || text.ends_with(']')) text.remove_suffix(1);
  return text.empty() || std::string_view(".!?").find(text.back()) != std::string_view::npos ||
         text.ends_with("…");
}
}  // namespace

Error::Error(ExitCode code, const std::string& sentence)
    : std::runtime_error(is_ended(sentence) ? sentence : sentence + '.'), code_(code) {}

ConfigError::ConfigError(const Where& where, const std::string& complaint)
    : Error(ExitCode::usage, sentence(where, complaint)) {}

InputError::InputError(const Where& where, const std::string& complaint)
    : Error(ExitCode::input, sentence(where, complaint)) {}

std::string without_full_stop(std::string sentence) {
  while (sentence.ends_with('.')) sentence.pop_back();
  return sentence;
}

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
