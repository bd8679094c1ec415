#pragma once
/// \file
/// A plan as JSON, for results and provenance. The words are the plan's own.

#include <nlohmann/json.hpp>

#include "sim/plan.hpp"

namespace twincell::cli {

/// Kernel, steps, and every effect with its state and reason.
nlohmann::json as_json(const sim::Plan& plan);

}  // namespace twincell::cli
