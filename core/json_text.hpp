#pragma once
/// \file
/// JSON as text. Use this for all JSON output: `dump` with its default settings throws on a file name that is
/// not valid UTF-8.

#include <nlohmann/json.hpp>
#include <string>

namespace twincell {

/// The document as text, indented by `indent` spaces (-1: on one line). Bytes that are not UTF-8 become
/// U+FFFD; numbers that are not finite become null.
inline std::string json_text(const nlohmann::json& document, int indent = -1) {
  return document.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace twincell
