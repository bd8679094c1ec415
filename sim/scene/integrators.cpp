#include "sim/scene/integrators.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.hpp"

namespace twincell::sim {

std::vector<std::string> integrator_words() {
  std::vector<std::string> words;
  for (const Integrator& i : kAllIntegrators) words.emplace_back(i.word);
  return words;
}

const Integrator& integrator_named(const std::string& word) {
  for (const Integrator& i : kAllIntegrators)
    if (i.word == word) return i;
  throw ConfigError(
      {.file = {}, .key = "time.integrator"},
      fmt::format("there is no integrator '{}'; there are: {}.", word, fmt::join(integrator_words(), ", ")));
}

}  // namespace twincell::sim
