#include "cli/number_checks.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>

namespace twincell::cli {
namespace {

/// The complete text as a number; false if it is none.
template <class Number>
bool reads_as(const std::string& text, Number& value) {
  const char* begin = text.data() + (text.size() > 1 && text.front() == '+' && text[1] != '-' ? 1 : 0);
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(begin, end, value);
  return error == std::errc() && last == end;
}

std::string complaint_of_real(const std::string& text) {
  double value = 0;
  if (reads_as(text, value) && std::isfinite(value)) return {};
  const std::size_t comma = text.find(',');
  if (std::string point = text; comma != std::string::npos) {
    point.replace(comma, 1, ".");
    if (reads_as(point, value))
      return fmt::format("'{}' is not a number; write one with a decimal point, {}, or several as {} {}",
                         text, point, text.substr(0, comma), text.substr(comma + 1));
  }
  return fmt::format("'{}' is not a finite number", text);
}

template <class Whole>
std::string complaint_of_whole(const std::string& text) {
  Whole value = 0;
  if (reads_as(text, value)) return {};
  return fmt::format("'{}' is not a whole number{}, or too large", text,
                     std::is_unsigned_v<Whole> ? " of 0 or above" : "");
}

CLI::Validator bounded(const char* bound, bool (*fits)(double)) {
  return CLI::Validator(
      [bound, fits](std::string& text) {
        double value = 0;
        return reads_as(text, value) && fits(value)
                   ? std::string()
                   : fmt::format("'{}' is out of range; the value must be {}", text, bound);
      },
      bound);
}

}  // namespace

CLI::Validator above_zero() {
  return bounded("above 0", [](double x) { return x > 0; });
}

CLI::Validator zero_or_above() {
  return bounded("0 or above", [](double x) { return x >= 0; });
}

void check_numbers(CLI::App& program) {
  const auto first = [](CLI::Option& option, std::string (*complaint)(const std::string&)) {
    // transform() puts a check before the others; this one leaves the text as it is.
    option.transform(CLI::Validator([complaint](std::string& text) { return complaint(text); }, ""));
  };
  for (CLI::Option* option : program.get_options()) {
    const std::string type = option->get_type_name();
    if (type.starts_with("FLOAT") || type.starts_with("[FLOAT") || type.starts_with("LOW,HIGH"))
      first(*option, complaint_of_real);
    else if (type.starts_with("UINT"))
      first(*option, complaint_of_whole<std::uint64_t>);
    else if (type.starts_with("INT"))
      first(*option, complaint_of_whole<std::int64_t>);
  }
  for (CLI::App* verb : program.get_subcommands([](const CLI::App*) { return true; })) check_numbers(*verb);
}

}  // namespace twincell::cli
