#include "analysis/report/page_parts.hpp"

#include <cstdint>
#include <nlohmann/json.hpp>
#include <regex>

#include "core/escape.hpp"
#include "core/json_text.hpp"

namespace twincell::analysis {

namespace embedded {  // embedded into the program by cmake/embed.cmake
extern const std::string_view page_css;
}

namespace {

/// RFC 4648, section 4.
std::string base64(std::string_view bytes) {
  static constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? kLetters[word >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

}  // namespace

std::string_view page_style() {
  return embedded::page_css;
}

std::string typeset(const std::string& text) {
  return std::regex_replace(
      std::regex_replace(html_text(text), std::regex("\\b([sTNK])_([a-z])\\b"), "$1<sub>$2</sub>"),
      std::regex("\\bq6\\b"), "q<sub>6</sub>");
}

std::string script_text(std::string_view script) {
  std::string safe(script);
  for (std::size_t at = safe.find("</script"); at != std::string::npos; at = safe.find("</script", at))
    safe.insert(at + 1, 1, '\\');
  return safe;
}

std::string json_script_text(const nlohmann::json& document) {
  const std::string text = json_text(document);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) safe += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return safe;
}

std::string data_uri(const std::string& type, std::string_view bytes) {
  return "data:" + type + ";base64," + base64(bytes);
}

}  // namespace twincell::analysis
