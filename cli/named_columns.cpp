#include "cli/named_columns.hpp"

#include <fmt/format.h>

#include "core/error.hpp"

namespace twincell::cli {

std::map<std::string, std::string> named_columns(const std::vector<std::string>& words) {
  std::map<std::string, std::string> columns;
  for (const std::string& pair : words) {
    const std::size_t equals = pair.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == pair.size())
      throw ConfigError({"", 0, 0, "--columns"}, fmt::format("'{}' is not QUANTITY=NAME.", pair));
    if (!columns.emplace(pair.substr(0, equals), pair.substr(equals + 1)).second)
      throw ConfigError({"", 0, 0, "--columns"}, fmt::format("'{}' is named twice.", pair.substr(0, equals)));
  }
  return columns;
}

}  // namespace twincell::cli
