#include "twin/sweep_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/atomic_file.hpp"
#include "core/config.hpp"
#include "core/json_text.hpp"
#include "core/toml_leaves.hpp"
#include "sim/scene/scene.hpp"

namespace twincell {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The settings of a sweep's base scene that determine N_l, Gamma and start.
struct BaseScene {
  std::string preset, start;
  std::vector<TomlLeaf> leaves;  ///< keys of the tables that determine N_l and Gamma, in their stated units
};

const std::vector<std::string>& placing_tables() {
  static const std::vector<std::string> tables = {"scale.", "cell.", "beads.", "drive."};
  return tables;
}

/// Whether a key is in a table that determines N_l or Gamma.
bool places(const std::string& key) {
  return std::any_of(placing_tables().begin(), placing_tables().end(),
                     [&](const std::string& table) { return key.starts_with(table); });
}

/// Base scene: a table of the plan, or a file that is searched next to `file`, one folder above, and in the
/// working folder.
BaseScene base_scene(const std::string& plan, const fs::path& file) {
  const Config config = Config::from_text(plan, file.string() + ": plan");
  std::vector<TomlLeaf> leaves = toml_leaves(config.text(), "scene");
  ConfigSection scene = config.root();
  if (!leaves.empty()) {
    scene = scene.section("scene");
  } else {
    const fs::path name = scene.text("scene").value_or("");
    const fs::path folder = fs::absolute(file).parent_path();
    for (const fs::path& place : {folder / name, folder.parent_path() / name, name})
      if (leaves.empty() && fs::is_regular_file(place)) {
        const Config found = Config::from_file(place);
        leaves = toml_leaves(found.text(), "");
        scene = found.root();
      }
    if (leaves.empty())
      throw InputError(
          {.file = file.string(), .key = "plan.scene"},
          fmt::format("the sweep's scene {} does not exist, so N_l and Gamma are unknown.", name.string()));
  }
  BaseScene base{.preset = scene.text("preset").value_or(""),
                 .start = scene.section("start").text("kind").value_or("crystal_a"),
                 .leaves = {}};
  for (TomlLeaf& leaf : leaves)
    if (places(leaf.path)) base.leaves.push_back(std::move(leaf));
  return base;
}

/// Position of a point in the phase diagram, with its start.
struct Place {
  double n_l = 0, gamma = 0;
  std::string start;
};

/// Position of the base scene with the values of a point's axes.
Place place_of(const BaseScene& base, const json& axes, const std::string& file) {
  // Contacts do not affect the position, but a valid scene needs some.
  std::string text = base.preset.empty() ? "contact.k_n = 1e6\ncontact.restitution = 0.9\n"
                                         : fmt::format("preset = \"{}\"\n", base.preset);
  for (const TomlLeaf& leaf : base.leaves) text += leaf.path + " = " + leaf.literal + "\n";
  std::vector<std::string> assignments;
  for (const auto& [key, value] : axes.items())
    if (places(key)) assignments.push_back(key + "=" + json_text(value));
  const sim::Scene scene = sim::read_scene_text(text, file + ": scene", assignments);
  Place place;
  place.n_l = static_cast<double>(scene.n_beads.value_or(0)) / scene.width;
  place.gamma = scene.drive.gamma(scene.g());
  place.start = axes.contains("start.kind") ? axes["start.kind"].get<std::string>() : base.start;
  return place;
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

void add_points(const json& document, const BaseScene& base, const std::string& file,
                Comparison& comparison) {
  for (const json& point : document.at("points")) {
    const BedPhase phase = phase_of(point.value("results", json::object()));
    if (phase == BedPhase::undetermined) continue;
    const Place place = place_of(base, point.at("axes"), file);
    comparison.sweep.push_back(
        {.n_l = place.n_l, .gamma = place.gamma, .start = place.start, .phase = phase});
  }
}

/// Whether the key is one of the two names of Gamma.
bool is_gamma(const std::string& key) {
  return key == "drive.gamma" || key == "drive.peak_acceleration_g";
}

void add_onsets(const json& document, const BaseScene& base, const std::string& file,
                Comparison& comparison) {
  for (const json& onset : document.value("onsets", json::array())) {
    const BedPhase phase = phase_named(onset.value("verdict", ""));
    if (phase == BedPhase::undetermined || !is_gamma(onset.value("key", ""))) continue;
    json axes = onset.at("axes");
    axes[onset.at("key").get<std::string>()] =
        onset.at("range").at(0);  // any Gamma, so that the scene is complete
    const Place place = place_of(base, axes, file);
    comparison.boundaries.push_back({.side = Side::simulation,
                                     .start = place.start,
                                     .onset = phase,
                                     .n_l = place.n_l,
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
    const BaseScene base = base_scene(document.at("plan").get<std::string>(), file);
    add_points(document, base, file.string(), comparison);
    add_onsets(document, base, file.string(), comparison);
  } catch (const json::exception& e) {
    throw InputError({.file = file.string()}, fmt::format("is damaged: {}.", e.what()));
  }
}

}  // namespace twincell
