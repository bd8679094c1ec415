#include "calibration/sweep_results.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "analysis/trajectory/atomic_file.hpp"
#include "analysis/trajectory/config.hpp"
#include "analysis/trajectory/json_text.hpp"
#include "sim/scene.hpp"

namespace twincell {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The base scene of a sweep: a table of its plan, or a file beside the plan, where the sweep's folder is
/// too.
ConfigSection base_scene(const std::string& plan, const fs::path& file) {
  const ConfigSection root = Config::from_text(plan, file.string() + ": plan").root();
  try {
    return root.section("scene");
  } catch (const ConfigError&) {  // no table
    const fs::path name = root.text("scene").value_or("");
    const fs::path folder = fs::absolute(file).parent_path();
    for (const fs::path& place : {folder / name, folder.parent_path() / name, name})
      if (fs::is_regular_file(place)) return Config::from_file(place).root();
    throw InputError(
        {.file = file.string(), .key = "plan.scene"},
        fmt::format("the sweep's scene {} is not there, so N_l and Gamma are not known.", name.string()));
  }
}

/// What places a point in the phase diagram.
struct Place {
  double n_l = 0, gamma = 0;
  std::string start;
};

/// The base scene with the values of a point's axes, as far as N_l, Gamma and start hang on it.
Place place_of(const ConfigSection& base, const json& axes, const std::string& file) {
  // Contacts place nothing, but a scene must have some.
  const auto preset = base.text("preset");
  const std::string text =
      preset ? fmt::format("preset = \"{}\"\n", *preset) : "[contact]\nk_n = 1e6\nrestitution = 0.9\n";
  std::vector<std::string> assignments;
  for (const auto& [table, keys] :
       {std::pair<std::string, std::vector<std::string>>{"cell", {"width"}},
        {"beads", {"count", "layers"}},
        {"drive", {"gamma", "k_m", "amplitude", "omega", "frequency", "peak_velocity"}}})
    for (const std::string& key : keys) {
      const std::string name = table + "." + key;
      const ConfigSection section = base.section(table);
      if (axes.contains(name))
        assignments.push_back(name + "=" + json_text(axes[name]));
      else if (table == "beads" ? section.integer(key).has_value() : section.number(key).has_value())
        assignments.push_back(fmt::format(
            "{}={}", name,
            table == "beads" ? static_cast<double>(*section.integer(key)) : *section.number(key)));
    }
  const sim::Scene scene = sim::read_scene_text(text, file + ": scene", assignments);
  Place place;
  place.n_l = static_cast<double>(scene.n_beads.value_or(0)) / scene.width;
  place.gamma = scene.drive.gamma(scene.g());
  place.start = axes.contains("start.kind") ? axes["start.kind"].get<std::string>()
                                            : base.section("start").text("kind").value_or("crystal_a");
  return place;
}

std::optional<double> number(const json& object, const char* key) {
  return object.contains(key) && object[key].is_number() ? std::optional(object[key].get<double>())
                                                         : std::nullopt;
}

/// As the analysis says; from s_b and s_c where a plan's `results` leave the phase out.
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

void add_points(const json& document, const ConfigSection& base, const std::string& file,
                Comparison& comparison) {
  for (const json& point : document["points"]) {
    const BedPhase phase = phase_of(point.value("results", json::object()));
    if (phase == BedPhase::undetermined) continue;
    const Place place = place_of(base, point["axes"], file);
    comparison.sweep.push_back(
        {.n_l = place.n_l, .gamma = place.gamma, .start = place.start, .phase = phase});
  }
}

void add_onsets(const json& document, const ConfigSection& base, const std::string& file,
                Comparison& comparison) {
  for (const json& onset : document.value("onsets", json::array())) {
    const BedPhase phase = phase_named(onset.value("verdict", ""));
    if (phase == BedPhase::undetermined || onset.value("key", "") != "drive.gamma") continue;
    json axes = onset["axes"];
    axes["drive.gamma"] = onset["range"][0];  // some Gamma, so that the scene is whole
    const Place place = place_of(base, axes, file);
    comparison.boundaries.push_back({.side = Side::simulation,
                                     .start = place.start,
                                     .onset = phase,
                                     .n_l = place.n_l,
                                     .n_runs = onset["runs"].get<std::size_t>(),
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
    const ConfigSection base = base_scene(document["plan"].get<std::string>(), file);
    add_points(document, base, file.string(), comparison);
    add_onsets(document, base, file.string(), comparison);
  } catch (const json::exception& e) {
    throw InputError({.file = file.string()}, fmt::format("is damaged: {}.", e.what()));
  }
}

}  // namespace twincell
