#include "cli/wrapped_help.hpp"

#include <CLI/CLI.hpp>
#include <string>

namespace twincell::cli {
namespace {

constexpr std::size_t kColumns = 100;

/// Number of characters of UTF-8 text, which is its width here: no option's help has wide or combining ones.
std::size_t width_of(const std::string& text) {
  std::size_t n = 0;
  for (const char c : text) n += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U ? 1 : 0;
  return n;
}

/// The text with line breaks between words, so that no line is wider than `columns`. Its own line breaks
/// stay.
std::string wrapped(const std::string& text, std::size_t columns) {
  std::string out, word;
  std::size_t used = 0;
  const auto put = [&] {
    if (word.empty()) return;
    const std::size_t width = width_of(word);
    if (used > 0 && used + 1 + width > columns) {
      out += '\n';
      used = 0;
    }
    if (used > 0) {
      out += ' ';
      ++used;
    }
    out += word;
    used += width;
    word.clear();
  };
  for (const char c : text) {
    if (c != ' ' && c != '\n') {
      word += c;
      continue;
    }
    put();
    if (c == '\n') {
      out += c;
      used = 0;
    }
  }
  put();
  return out;
}

class WrappedHelp final : public CLI::Formatter {
 public:
  [[nodiscard]] std::string make_description(const CLI::App* app) const override {
    return wrapped(CLI::Formatter::make_description(app), kColumns);
  }
  [[nodiscard]] std::string make_option_desc(const CLI::Option* option) const override {
    return wrapped(CLI::Formatter::make_option_desc(option), kColumns - get_column_width());
  }
  [[nodiscard]] std::string make_subcommand(const CLI::App* verb) const override {
    std::stringstream out;
    CLI::detail::format_help(out, verb->get_name(),
                             wrapped(verb->get_description(), kColumns - get_column_width()),
                             get_column_width());
    return out.str();
  }
};

}  // namespace

std::shared_ptr<CLI::FormatterBase> wrapped_help() {
  return std::make_shared<WrappedHelp>();
}

}  // namespace twincell::cli
