#include "twin/sweep_results.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "sweep/conditions.hpp"

namespace twincell {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Conditions that are stored with a point or an onset. \param what "point ID" or "an onset", for messages
const json& conditions_of(const json& row, const std::string& what, const std::string& file) {
  if (!row.contains("conditions"))
    throw InputError({.file = file, .key = "conditions"},
                     fmt::format("{} does not state its N_l, Gamma and start: an earlier version collected "
                                 "the sweep; collect it again with `twincell sweep collect`.",
                                 what));
  return row.at("conditions");
}

std::optional<double> number(const json& object, const char* key) {
  return object.contains(key) && object[key].is_number() ? std::optional(object[key].get<double>())
                                                         : std::nullopt;
}

/// Phase from the analysis, or from s_b and s_c if the plan's `results` omit the phase.
BedPhase phase_of(const json& results) {
  const auto value = [&](const char* name) {
    return results.value(name, json::object()).value("value", json());
  };
  if (const json phase = value("phase"); phase.is_string()) return phase_named(phase.get<std::string>());
  const auto scalar = [&](const char* name) {
    const json v = value(name);
    return v.is_number() ? v.get<double>() : std::nan("");
  };
  return bed_phase(scalar("s_b"), scalar("s_c"));
}

void add_points(const json& document, const std::string& file, Comparison& comparison) {
  for (const json& point : document.at("points")) {
    const BedPhase phase = phase_of(point.value("results", json::object()));
    if (phase == BedPhase::undetermined) continue;
    const RunConditions at =
        sweep::conditions_from_json(conditions_of(point, "point " + point.at("id").get<std::string>(), file));
    if (!at.n_l || !at.gamma) continue;  // no place in the diagram: without gravity, for example
    comparison.sweep.push_back({.n_l = *at.n_l, .gamma = *at.gamma, .start = at.start, .phase = phase});
  }
}

/// Whether the key is one of the two names of Gamma.
bool is_gamma(const std::string& key) {
  return key == "drive.gamma" || key == "drive.peak_acceleration_g";
}

void add_onsets(const json& document, const std::string& file, Comparison& comparison) {
  for (const json& onset : document.value("onsets", json::array())) {
    const BedPhase phase = phase_named(onset.value("verdict", ""));
    if (phase == BedPhase::undetermined || !is_gamma(onset.value("key", ""))) continue;
    const json& at = conditions_of(onset, "an onset", file);
    const std::optional<double> n_l = number(at, "n_l");
    if (!n_l) continue;
    comparison.boundaries.push_back({.side = Side::simulation,
                                     .start = at.at("start").get<std::string>(),
                                     .onset = phase,
                                     .n_l = *n_l,
                                     .n_runs = onset.at("runs").get<std::size_t>(),
                                     .below = number(onset, "low"),
                                     .above = number(onset, "high"),
                                     .sweep = true,
                                     .fitted = number(onset, "value")});
  }
}

}  // namespace

void add_sweep(const fs::path& file, Comparison& comparison) {
  const json document = json::parse(read_text_file(file), nullptr, false);
  if (!document.is_object() || document.value("format", "") != "twincell sweep 1")
    throw InputError({.file = file.string()},
                     "is not a sweep's collected results (\"format\": \"twincell sweep 1\").");
  try {
    add_points(document, file.string(), comparison);
    add_onsets(document, file.string(), comparison);
  } catch (const json::exception& e) {
    throw InputError({.file = file.string()}, fmt::format("is damaged: {}.", e.what()));
  }
}

}  // namespace twincell
