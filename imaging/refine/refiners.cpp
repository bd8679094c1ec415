#include "core/choice.hpp"
#include "imaging/refine/edge_fit.hpp"
#include "imaging/refine/overlapping_fit.hpp"
#include "imaging/refine/picture_fit.hpp"
#include "imaging/refine/profile_fit.hpp"
#include "imaging/refine/refiner.hpp"

namespace twincell::imaging {

namespace {

// The list of refiners; the first is the default.
constexpr std::array kRefiners = {kExactRefiner, kFastRefiner, kEdgeRefiner, kProfileRefiner,
                                  kOverlappingRefiner};

}  // namespace

std::vector<std::string> refiner_names() {
  return words_of(kRefiners);
}

std::string refiners_help() {
  return help_of(kRefiners);
}

const Refiner& refiner_named(const std::string& word) {
  return row_named(kRefiners, word, "refine", "refiner");
}

}  // namespace twincell::imaging
