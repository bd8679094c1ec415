#pragma once
/// \file
/// JSON as text, and numbers that may be missing. Use json_text for all JSON output: `dump` with its default
/// settings throws on a file name that is not valid UTF-8.

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace twincell {

/// The document as text, indented by `indent` spaces (-1: on one line). Bytes that are not UTF-8 become
/// U+FFFD; numbers that are not finite become null.
inline std::string json_text(const nlohmann::json& document, int indent = -1) {
  return document.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// The number, or null if it is not finite or absent.
inline nlohmann::json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}
/// The same for a number that may be absent.
inline nlohmann::json number_or_null(const std::optional<double>& value) {
  return value ? number_or_null(*value) : nlohmann::json(nullptr);
}

}  // namespace twincell
