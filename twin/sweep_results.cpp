#include "twin/sweep_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/atomic_file.hpp"
#include "core/config.hpp"
#include "core/json_text.hpp"
#include "core/json_view.hpp"
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
  const Config config = Config::from_text(plan, "plan");
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

/// Runs `work` on the sweep's scene, which is part of the input here. \throws InputError for a scene error
template <class Work>
auto of_scene(const JsonView& at, Work work) {
  try {
    return work();
  } catch (const ConfigError& e) {
    std::string why = e.what();
    while (why.ends_with('.')) why.pop_back();
    at.refuse(fmt::format("does not describe a scene ({})", why));
  }
}

/// Axis `key` of a point or onset; its value must be a number, a text or a boolean.
std::string assignment(const std::string& key, const JsonView& value) {
  const json& v = value.value();
  if (!v.is_number() && !v.is_string() && !v.is_boolean())
    value.refuse("is not one value of a key of the scene");
  return key + "=" + (v.is_string() ? toml_quoted(v.get<std::string>()) : json_text(v));
}

/// Position of the base scene with the values of a point's axes.
/// \param more further assignments
Place place_of(const BaseScene& base, const JsonView& axes, std::vector<std::string> assignments = {}) {
  // Contacts do not affect the position, but a valid scene needs some.
  std::string text = base.preset.empty() ? "contact.k_n = 1e6\ncontact.restitution = 0.9\n"
                                         : fmt::format("preset = {}\n", toml_quoted(base.preset));
  for (const TomlLeaf& leaf : base.leaves) text += leaf.path + " = " + leaf.literal + "\n";
  for (const auto& [key, value] : axes.members())
    if (places(key)) assignments.push_back(assignment(key, value));
  const sim::Scene scene = of_scene(axes, [&] { return sim::read_scene_text(text, "scene", assignments); });
  Place place;
  place.n_l = static_cast<double>(scene.n_beads.value_or(0)) / scene.width;
  place.gamma = scene.drive.gamma(scene.g());
  const auto start = axes.find("start.kind");
  place.start = start ? start->text() : base.start;
  return place;
}

/// A member that may be absent or null.
std::optional<double> number(const JsonView& object, const char* key) {
  const auto member = object.find(key);
  return member && !member->value().is_null() ? std::optional(member->number()) : std::nullopt;
}

/// Value of a result; nullopt if the point does not have it.
std::optional<JsonView> value_of(const std::optional<JsonView>& results, const char* name) {
  const auto result = results ? results->find(name) : std::nullopt;
  auto value = result ? result->find("value") : std::nullopt;
  return value && !value->value().is_null() ? value : std::nullopt;
}

/// Phase from the analysis, or from s_b and s_c if the plan's `results` omit the phase.
BedPhase phase_of(const std::optional<JsonView>& results) {
  if (const auto phase = value_of(results, "phase")) return phase_named(phase->text());
  const auto scalar = [&](const char* name) {
    const auto value = value_of(results, name);
    return value ? value->number() : std::nan("");
  };
  return bed_phase(scalar("s_b"), scalar("s_c"));
}

void add_points(const JsonView& document, const BaseScene& base, Comparison& comparison) {
  for (const JsonView& point : document.at("points").elements()) {
    const JsonView axes = point.at("axes");
    const BedPhase phase = phase_of(point.find("results"));
    if (phase == BedPhase::undetermined) continue;
    const Place place = place_of(base, axes);
    comparison.sweep.push_back(
        {.n_l = place.n_l, .gamma = place.gamma, .start = place.start, .phase = phase});
  }
}

/// Whether the key is one of the two names of Gamma.
bool is_gamma(const std::string& key) {
  return key == "drive.gamma" || key == "drive.peak_acceleration_g";
}

void add_onsets(const JsonView& document, const BaseScene& base, Comparison& comparison) {
  const auto onsets = document.find("onsets");
  if (!onsets) return;
  for (const JsonView& onset : onsets->elements()) {
    const BedPhase phase = phase_named(onset.at("verdict").text());
    const std::string key = onset.at("key").text();
    if (phase == BedPhase::undetermined || !is_gamma(key)) continue;
    // Any Gamma, so that the scene is complete.
    const Place place =
        place_of(base, onset.at("axes"), {assignment(key, onset.at("range").elements(2).front())});
    comparison.boundaries.push_back({.side = Side::simulation,
                                     .start = place.start,
                                     .onset = phase,
                                     .n_l = place.n_l,
                                     .n_runs = static_cast<std::size_t>(onset.at("runs").integer(0)),
                                     .below = number(onset, "low"),
                                     .above = number(onset, "high"),
                                     .sweep = true,
                                     .fitted = number(onset, "value")});
  }
}

}  // namespace

void add_sweep(const fs::path& file, Comparison& comparison) {
  const JsonView document = JsonView::parse(read_text_file(file), file.string());
  if (!document.value().is_object() || document.value().value("format", json()) != "twincell sweep 1")
    throw InputError({.file = file.string()},
                     "is not a sweep's collected results (\"format\": \"twincell sweep 1\").");
  const JsonView plan = document.at("plan");
  const BaseScene base = of_scene(plan, [&] { return base_scene(plan.text(), file); });
  add_points(document, base, comparison);
  add_onsets(document, base, comparison);
}

}  // namespace twincell
