#include "core/key_assignments.hpp"

#include <fmt/format.h>

#include "core/error.hpp"

namespace twincell {

std::string assigned_key(const std::string& assignment) {
  const std::string key = assignment.substr(0, assignment.find('='));
  const auto first = key.find_first_not_of(" \t"), last = key.find_last_not_of(" \t");
  return first == std::string::npos ? "" : key.substr(first, last - first + 1);
}

void refuse_contradictory_assignments(const std::vector<std::string>& assignments) {
  for (std::size_t k = 0; k < assignments.size(); ++k)
    for (std::size_t m = 0; m < k; ++m)
      if (assigned_key(assignments[m]) == assigned_key(assignments[k]) && assignments[m] != assignments[k])
        throw ConfigError({"--set", 0, 0, assigned_key(assignments[k])},
                          fmt::format("is set twice, \"{}\" and \"{}\"; set it only once.", assignments[m],
                                      assignments[k]));
}

}  // namespace twincell
