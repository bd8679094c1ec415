#include "analysis/observable/no_such_result.hpp"

#include <fmt/format.h>

#include "analysis/observable/observable.hpp"
#include "core/nearest_word.hpp"

namespace twincell::analysis {

std::string no_such_result(const std::string& name) {
  const std::string near = nearest_word(name, result_names());
  return fmt::format("there is no result called \"{}\"; {}docs/observables.md lists the results", name,
                     near.empty() ? "" : fmt::format("did you mean \"{}\"? ", near));
}

}  // namespace twincell::analysis
