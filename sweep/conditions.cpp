#include "sweep/conditions.hpp"

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "core/json_text.hpp"

namespace twincell::sweep {

namespace {

using nlohmann::json;

std::optional<double> optional_number(const JsonView& value) {
  constexpr double kMost = 1e9;  // of N_l and Gamma: far beyond any bed and any shaker
  return value.value().is_null() ? std::nullopt : std::optional(value.number_in(0, kMost));
}

}  // namespace

json conditions_json(const RunConditions& conditions) {
  return {{"n_l", number_or_null(conditions.n_l)},
          {"gamma", number_or_null(conditions.gamma)},
          {"start", conditions.start}};
}

RunConditions conditions_from_json(const JsonView& conditions) {
  return {.n_l = optional_number(conditions.at("n_l")),
          .gamma = optional_number(conditions.at("gamma")),
          .start = conditions.at("start").text()};
}

}  // namespace twincell::sweep
