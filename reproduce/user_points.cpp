#include "reproduce/user_points.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"

namespace twincell::reproduce {

const std::vector<double>& own_column(const Table& table, const std::string& name, Allowed allowed) {
  const std::vector<double>& column = table.column(name);
  for (std::size_t i = 0; i < column.size(); ++i) {
    if (column[i] > 0 || (allowed.empty && std::isnan(column[i])) || (allowed.zero && column[i] == 0))
      continue;
    throw InputError({.file = table.file, .key = name},
                     std::isnan(column[i]) ? fmt::format("row {} has no number.", i + 1)
                                           : fmt::format("row {} is {:g}; the value must be {}.", i + 1,
                                                         column[i], allowed.zero ? "at least 0" : "above 0"));
  }
  return column;
}

}  // namespace twincell::reproduce
