#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.hpp"
#include "imaging/refine/edge_fit.hpp"
#include "imaging/refine/picture_fit.hpp"
#include "imaging/refine/profile_fit.hpp"
#include "imaging/refine/refiner.hpp"

namespace twincell {

namespace {

// The list of refiners; the first is the default.
constexpr std::array kRefiners = {kExactRefiner, kFastRefiner, kEdgeRefiner, kProfileRefiner};

}  // namespace

std::vector<std::string> refiner_names() {
  std::vector<std::string> names;
  for (const Refiner& r : kRefiners) names.emplace_back(r.word);
  return names;
}

std::string refiners_help() {
  std::string text;
  for (const Refiner& r : kRefiners)
    text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", r.word, r.help);
  return text;
}

const Refiner& refiner_named(const std::string& word) {
  for (const Refiner& r : kRefiners)
    if (r.word == word) return r;
  throw ConfigError(
      Where{.file = {}, .key = "refine"},
      fmt::format("there is no refiner '{}'; there are: {}.", word, fmt::join(refiner_names(), ", ")));
}

}  // namespace twincell
