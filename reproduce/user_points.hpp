#pragma once
/// \file
/// The user's own points, which stand beside those of a figure.

#include <string>
#include <vector>

#include "core/table.hpp"

namespace twincell::reproduce {

/// What a column may hold besides numbers above 0.
struct Allowed {
  bool empty = false;  ///< an empty field: NaN, no point
  bool zero = false;   ///< 0: the temperature of a bed that moves as one
};

/// The numbers of a column. None is negative, like all quantities that the figures compare.
/// \throws ConfigError as Table::column; InputError naming the file, the column and the row of another number
const std::vector<double>& own_column(const Table& table, const std::string& name, Allowed allowed = {});

}  // namespace twincell::reproduce
