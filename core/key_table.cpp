#include "core/key_table.hpp"

#include <fmt/format.h>

#include <regex>

#include "core/config.hpp"
#include "core/error.hpp"
#include "core/terminal_text.hpp"

namespace twincell {

namespace {

std::string table_of(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string::npos ? "" : key.substr(0, dot);
}

std::string note_of(const KeyTable& table, const std::string& name) {
  for (const auto& [of, note] : table.notes)
    if (of == name) return note;
  return {};
}

std::string meaning_of(const KeyRow& row) {
  return row.meaning.empty() ? "the same" : row.meaning;
}

/// A default that is a value, not words, is set as code.
std::string default_markdown(const std::string& absent) {
  if (absent.empty()) return "–";
  try {
    (void)Config::from_text("x = " + absent, "default");
    return "`" + absent + "`";
  } catch (const ConfigError&) {
    return absent;
  }
}

/// Pages of the manual as links from another one: "docs/scene.md" becomes "[scene.md](scene.md)".
std::string linked(const std::string& text) {
  return std::regex_replace(text, std::regex(R"(docs/(\w+\.md))"), "[$1]($1)");
}

constexpr std::size_t kWidth = 100;

/// A paragraph with this indentation.
std::string wrapped(const std::string& text, const std::string& indent) {
  return fold_line(indent + text, kWidth, indent);
}

}  // namespace

std::string range_of(const std::map<std::string, KeyRule>& rules, const std::string& key) {
  const auto rule = rules.find(key);
  return rule == rules.end() ? "" : rule->second.range();
}

std::map<std::string, KeyRule> rules_of(const KeyTable& table) {
  const KeyRecord record;
  for (const KeyRow& row : table.rows) {
    std::vector<std::string> assignments = row.with;
    assignments.push_back(row.key + "=" + row.example);
    try {
      table.read(assignments);
    } catch (const Error&) {  // of the file that the example names: its key was queried before
    }
  }
  return record.rules();
}

std::string key_markdown(const KeyTable& table) {
  const auto rules = rules_of(table);
  std::string text = fmt::format("## {}\n\n{}\n", table.title, linked(table.intro));
  std::string name = "none yet";
  for (const KeyRow& row : table.rows) {
    if (const std::string of = table_of(row.key); of != name) {
      name = of;
      if (!name.empty()) text += fmt::format("\n### `[{}]`\n", name);
      if (const std::string note = note_of(table, name); !note.empty()) text += "\n" + note + "\n";
      text += "\n| key | unit | range | default | example | meaning |\n|---|---|---|---|---|---|\n";
    }
    text += fmt::format("| `{}` | {} | {} | {} | `{}` | {} |\n", row.key, row.unit, range_of(rules, row.key),
                        default_markdown(row.absent), row.example, linked(meaning_of(row)));
  }
  return text;
}

std::string key_text(const KeyTable& table) {
  const auto rules = rules_of(table);
  std::string text = table.title + "\n\n" + wrapped(table.intro, "");
  std::string name = "none yet";
  for (const KeyRow& row : table.rows) {
    if (const std::string of = table_of(row.key); of != name) {
      name = of;
      text += name.empty() ? "\n" : fmt::format("\n[{}]\n", name);
      if (const std::string note = note_of(table, name); !note.empty()) text += wrapped(note, "  ");
    }
    std::string facts = row.unit;
    for (const std::string& fact :
         {range_of(rules, row.key), row.absent.empty() ? std::string() : "default: " + row.absent})
      facts += (facts.empty() || fact.empty() ? "" : "; ") + fact;
    text += fold_line(fmt::format("  {} = {}  # {}", row.key, row.example, facts), kWidth, "      # ");
    text += wrapped(meaning_of(row), "      ");
  }
  return text;
}

}  // namespace twincell
