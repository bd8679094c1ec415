#include "analysis/report/gnuplot_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/escape.hpp"

namespace twincell::analysis {
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

std::string gnuplot_formula(std::string_view formula) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kGreek = {{{"alpha", "α"},
                                                                                           {"beta", "β"},
                                                                                           {"gamma", "γ"},
                                                                                           {"delta", "δ"},
                                                                                           {"mu", "μ"},
                                                                                           {"phi", "φ"},
                                                                                           {"sigma", "σ"},
                                                                                           {"omega", "ω"}}};
  constexpr std::string_view kLogarithm = "ln_";
  const auto in_name = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  std::string out;
  bool raised = false;  // in an exponent, which is an optional minus and one name
  while (!formula.empty()) {
    const auto end = std::find_if_not(formula.begin(), formula.end(), in_name);
    std::string_view name = formula.substr(0, static_cast<std::size_t>(end - formula.begin()));
    if (name.empty()) {
      const std::size_t n = std::max<std::size_t>(1, utf8_length(formula));
      const std::string sign = gnuplot_text(formula.substr(0, n));
      formula.remove_prefix(n);
      if (sign == "\\^" && !raised) {
        out += "^{";
        raised = true;
      } else {
        if (raised && sign != "-") {
          out += '}';
          raised = false;
        }
        out += sign;
      }
      continue;
    }
    formula.remove_prefix(name.size());
    if (name.starts_with(kLogarithm)) {
      out += "ln ";
      name.remove_prefix(kLogarithm.size());
    }
    const auto* greek =
        std::find_if(kGreek.begin(), kGreek.end(), [&](const auto& letter) { return letter.first == name; });
    out += greek != kGreek.end() ? std::string(greek->second) : gnuplot_symbol(name);
    if (raised) out += '}';
    raised = false;
  }
  if (raised) out += '}';
  return out;
}

std::string gnuplot_number(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "?";
}

bool is_figure_name(std::string_view name) {
  return !name.empty() && name.front() != '-' && name.front() != '.' &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
                  c == '-' || c == '.';
         });
}

}  // namespace twincell::analysis
