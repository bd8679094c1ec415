#include "sim/scene/integrators.hpp"

namespace twincell::sim {

std::vector<std::string> integrator_words() {
  return words_of(kAllIntegrators);
}

const Integrator& integrator_named(const std::string& word) {
  return row_named(kAllIntegrators, word, "time.integrator", "integrator");
}

}  // namespace twincell::sim
