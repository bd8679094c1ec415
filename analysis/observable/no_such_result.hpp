#pragma once
/// \file
/// The complaint about a result that does not exist.

#include <string>

namespace twincell::analysis {

/// "there is no result called "x"; did you mean "y"? docs/observables.md lists the results": the nearest name
/// is left out if none is near (nearest_word.hpp).
std::string no_such_result(const std::string& name);

}  // namespace twincell::analysis
