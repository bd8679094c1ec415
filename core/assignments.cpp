#include "core/assignments.hpp"

#include <fmt/format.h>

#include "core/error.hpp"

namespace twincell {

void refuse_contradictory_assignments(const std::vector<std::string>& assignments) {
  const auto key_of = [](const std::string& assignment) {
    return assignment.substr(0, assignment.find('='));
  };
  for (std::size_t k = 0; k < assignments.size(); ++k)
    for (std::size_t m = 0; m < k; ++m)
      if (key_of(assignments[m]) == key_of(assignments[k]) && assignments[m] != assignments[k])
        throw ConfigError({"--set", 0, 0, key_of(assignments[k])},
                          fmt::format("is set twice, \"{}\" and \"{}\"; set it only once.", assignments[m],
                                      assignments[k]));
}

}  // namespace twincell
