#include "core/toml_leaves.hpp"

#include <toml++/toml.h>

#include <cstdint>
#include <sstream>
#include <string>

namespace twincell {

namespace {

/// A whole number is written in decimal digits, also if the file has it as 0x1 or 0b1.
std::string literal_of(const toml::node& node) {
  if (const toml::value<std::int64_t>* whole = node.as_integer()) return std::to_string(whole->get());
  std::ostringstream out;
  node.visit([&](const auto& value) { out << value; });
  return out.str();
}

void gather(const toml::table& table, const std::string& path, std::vector<TomlLeaf>& leaves) {
  for (auto&& [key, node] : table) {
    const std::string full = path.empty() ? std::string(key.str()) : path + "." + std::string(key.str());
    if (const toml::table* below = node.as_table()) {
      gather(*below, full, leaves);
      continue;
    }
    TomlLeaf leaf{full, literal_of(node), node.is_array(), {}};
    if (const toml::array* list = node.as_array())
      for (const toml::node& item : *list) leaf.items.push_back(literal_of(item));
    else
      leaf.items.push_back(leaf.literal);
    leaves.push_back(std::move(leaf));
  }
}

}  // namespace

std::vector<TomlLeaf> toml_leaves(const std::string& text, const std::string& table) {
  std::vector<TomlLeaf> leaves;
  const toml::table document = toml::parse(text);
  if (table.empty())
    gather(document, "", leaves);
  else if (const toml::table* below = document[table].as_table())
    gather(*below, "", leaves);
  return leaves;
}

std::string toml_quoted(const std::string& text) {
  std::ostringstream out;
  out << toml::value<std::string>(text);
  return out.str();
}

}  // namespace twincell
