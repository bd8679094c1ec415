#include "reproduce/own_points.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"

namespace twincell::reproduce {

const std::vector<double>& positive_column(const Table& table, const std::string& name, bool may_lack) {
  const std::vector<double>& column = table.column(name);
  for (std::size_t i = 0; i < column.size(); ++i) {
    if (column[i] > 0 || (may_lack && std::isnan(column[i]))) continue;
    throw InputError({.file = table.file, .key = name},
                     std::isnan(column[i])
                         ? fmt::format("row {} has no number.", i + 1)
                         : fmt::format("row {} is {:g}; the value must be above 0.", i + 1, column[i]));
  }
  return column;
}

}  // namespace twincell::reproduce
