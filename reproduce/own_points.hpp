#pragma once
/// \file
/// The user's own points, which stand beside those of a figure.

#include <string>
#include <vector>

#include "core/table.hpp"

namespace twincell::reproduce {

/// The numbers of a column, which are above 0 like all quantities that the figures compare.
/// \param may_lack whether a field may be empty: NaN, no point
/// \throws ConfigError as Table::column; InputError naming the file, the column and the row of a number that
/// is not above 0, or is missing
const std::vector<double>& positive_column(const Table& table, const std::string& name,
                                           bool may_lack = false);

}  // namespace twincell::reproduce
