#include "analysis/gnuplot_text.hpp"

#include <algorithm>
#include <cstddef>

namespace twincell {
namespace {

/// Length of the UTF-8 character at the beginning of `s`; 0 if there is none (RFC 3629).
std::size_t utf8_length(std::string_view s) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(s[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t n = first >= 0xC2 && first <= 0xDF   ? 2
                        : first >= 0xE0 && first <= 0xEF ? 3
                        : first >= 0xF0 && first <= 0xF4 ? 4
                                                         : 0;
  if (n == 0 || s.size() < n) return 0;
  for (std::size_t i = 1; i < n; ++i)
    if ((byte(i) & 0xC0U) != 0x80) return 0;
  const unsigned second = byte(1);
  if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
      (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F))
    return 0;
  return n;
}

std::string safe(std::string_view text, std::string_view marks) {
  std::string out;
  while (!text.empty()) {
    const std::size_t n = utf8_length(text);
    const char c = text.front();
    if (n == 0)
      out += "\xEF\xBF\xBD";
    else if (n > 1)
      out += text.substr(0, n);
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
      out += ' ';
    else if (c == '\'')
      out += "’";
    else if (c == '`')
      out += "‘";
    else {
      if (marks.find(c) != std::string_view::npos) out += '\\';
      out += c;
    }
    text.remove_prefix(std::max<std::size_t>(1, n));
  }
  return out;
}

}  // namespace

std::string gnuplot_text(std::string_view text) {
  return safe(text, "{}^_@&~\\");
}

std::string gnuplot_plain_text(std::string_view text) {
  return safe(text, "");
}

std::string gnuplot_symbol(std::string_view name) {
  const std::size_t at = name.find('_');
  if (at == std::string_view::npos) return gnuplot_text(name);
  return gnuplot_text(name.substr(0, at)) + "_{" + gnuplot_text(name.substr(at + 1)) + "}";
}

bool is_figure_name(std::string_view name) {
  return !name.empty() && name.front() != '-' && name.front() != '.' &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
                  c == '-' || c == '.';
         });
}

}  // namespace twincell
