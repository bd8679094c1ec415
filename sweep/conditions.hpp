#pragma once
/// \file
/// N_l, Gamma and start of a run, as a sweep stores them with its results.

#include <nlohmann/json_fwd.hpp>

#include "core/json_view.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sweep {

/// {"n_l": N_l sigma, "gamma": A omega^2/g, "start": start.kind}; n_l and gamma are null if unknown.
nlohmann::json conditions_json(const RunConditions& conditions);
/// Inverse of conditions_json.
/// \throws InputError if a key is missing or has another type
RunConditions conditions_from_json(const JsonView& conditions);

}  // namespace twincell::sweep
