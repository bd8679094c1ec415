#include "analysis/report/gnuplot_text.hpp"

#include <algorithm>
#include <cstddef>

#include "core/escape.hpp"

namespace twincell {
namespace {

/// `text` without characters that could end a quoted string; the characters in `marks` get a backslash.
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
