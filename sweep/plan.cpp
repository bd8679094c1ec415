#include "sweep/plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <set>

#include "analysis/motion/bed_phase.hpp"
#include "analysis/observable/observable.hpp"
#include "core/atomic_file.hpp"
#include "core/cancellation.hpp"
#include "core/config.hpp"
#include "core/key_record.hpp"
#include "core/sha256.hpp"
#include "core/toml_leaves.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/resource_demand.hpp"
#include "sim/scene/scene.hpp"
#include "sim/scene/unit_doubts.hpp"
#include "sim/start/start.hpp"
#include "sweep/measure.hpp"

namespace twincell::sweep {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kMaxRuns = 100'000;
constexpr std::size_t kMaxPoints = 1'000'000;

/// A TOML literal without its quotes, if it has any.
std::string unquoted(const std::string& literal) {
  const bool quoted = literal.size() >= 2 && (literal.front() == '"' || literal.front() == '\'');
  return quoted ? literal.substr(1, literal.size() - 2) : literal;
}

void require_result(const Where& where, const std::string& name) {
  const auto names = analysis::result_names();
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw ConfigError(where, fmt::format("the analysis gives no result called '{}'; it gives {}.", name,
                                         fmt::join(names, ", ")));
}

/// Marks a dotted path and the tables that contain it as read, so that they do not count as unknown keys.
void know(const ConfigSection& table, const std::string& path) {
  for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', dot + 1))
    static_cast<void>(table.has(path.substr(0, dot)));
  static_cast<void>(table.has(path));
}

Criterion read_criterion(const ConfigSection& s) {
  const auto word = s.word("verdict", {"bouncing", "convecting"});
  const auto result = s.text("result");
  const auto above = s.number("above");
  if (word && (result || above))
    throw ConfigError(s.where("verdict"),
                      "is given together with 'result' or 'above'; give only one of the two.");
  if (word && *word == "bouncing") return {"bouncing", "s_b", analysis::kBouncingThreshold};
  if (word) return {"convecting", "s_c", analysis::kConvectionThreshold};
  if (!result || !above)
    throw ConfigError(
        s.where("verdict"),
        "is missing: \"bouncing\", \"convecting\", or a 'result' of the analysis and its bound 'above'.");
  require_result(s.where("result"), *result);
  return {*result, *result, *above};
}

Search read_search(const ConfigSection& s) {
  Search search;
  search.key = s.text("key").value_or("drive.gamma");
  const auto range = s.numbers("range", 2);
  if (!range) throw ConfigError(s.where("range"), "is missing: [from, to] of the search.");
  search.low = range->front();
  search.high = range->back();
  if (!(search.low < search.high))
    throw ConfigError(s.where("range"),
                      fmt::format("goes from {:g} to {:g}; it must rise.", search.low, search.high));
  const double all = search.high - search.low;
  const auto width = s.number_in("width", 0, all, true);
  if (!width) throw ConfigError(s.where("width"), "is missing: the wanted width of the onset's interval.");
  if (*width < all / 1000)
    throw ConfigError(s.where("width"),
                      fmt::format("{:g} is less than a thousandth of the range, {:g}.", *width, all / 1000));
  search.width = *width;
  search.runs = static_cast<int>(s.integer_in("runs", 2, kMaxRuns).value_or(search.runs));
  search.batch = static_cast<int>(s.integer_in("batch", 1, 1000).value_or(search.batch));
  return search;
}

void read_scene_of(Plan& plan, const ConfigSection& root, const fs::path& folder) {
  const auto leaves = toml_leaves(plan.text, "scene");
  if (!leaves.empty()) {
    const ConfigSection table = root.section("scene");
    for (const TomlLeaf& leaf : leaves) {
      know(table, leaf.path);
      plan.scene += leaf.path + " = " + leaf.literal + "\n";
    }
    plan.scene_name = plan.file + " [scene]";
    plan.scene_folder = folder;
    return;
  }
  const auto file = root.text("scene");
  if (!file)
    throw ConfigError(root.where("scene"), "is missing: the file of the base scene, or a table [scene].");
  const fs::path path = fs::path(*file).is_absolute() ? fs::path(*file) : folder / *file;
  plan.scene = read_text_file(path, kLargestConfig);
  plan.scene_name = path.string();
  plan.scene_folder = path.parent_path();
}

void check_axis(Plan& plan, const Where& where, const TomlLeaf& leaf) {
  if (leaf.items.empty()) throw ConfigError(where, "has no values.");
  if (plan.search && leaf.path == plan.search->key)
    throw ConfigError(where, "is the key that [search] varies.");
  std::set<std::string> different;  // 1 and 1.0 are one value
  std::vector<double> numbers;
  for (const std::string& item : leaf.items) {
    double value = 0;
    const auto [end, error] = std::from_chars(item.data(), item.data() + item.size(), value);
    const bool number = error == std::errc() && end == item.data() + item.size();
    different.insert(number ? fmt::format("{}", value + 0.0) : item);
    if (number) numbers.push_back(value);
  }
  // [1,5, 2,0] is meant as 1.5 and 2.0 where a comma separates decimals.
  if (numbers.size() == leaf.items.size() && !std::is_sorted(numbers.begin(), numbers.end()))
    plan.doubts.push_back(fmt::format(
        "{}: {}: the {} values {} do not ascend; a comma separates values, and a decimal fraction is written "
        "with a point.",
        plan.file, where.key, numbers.size(), fmt::join(numbers, "; ")));
  if (different.size() < leaf.items.size())
    throw ConfigError(where, "names a value twice; it would be the same run, counted twice.");
  if (leaf.path == "start.seed" && (plan.search || plan.seeds > 1))
    throw ConfigError(where,
                      "fixes the seed, so the runs that differ only in the seed would be the same run; "
                      "leave out start.seed, or axes.seeds and [search].");
}

void read_axes(Plan& plan, const ConfigSection& root) {
  const ConfigSection table = root.section("axes");
  std::vector<TomlLeaf> leaves;
  for (const TomlLeaf& leaf : toml_leaves(plan.text, "axes")) {
    know(table, leaf.path);
    if (leaf.path == "seeds") {
      plan.seeds = static_cast<int>(table.integer_in("seeds", 1, kMaxRuns).value_or(1));
      if (plan.search)
        throw ConfigError(table.where("seeds"),
                          "a search chooses its number of seeds itself; search.runs limits it.");
      continue;
    }
    record_key("axes." + leaf.path, {.list = true});
    plan.axes.push_back({leaf.path, leaf.items, table.where(leaf.path).line});
    leaves.push_back(leaf);
  }
  for (const TomlLeaf& leaf : leaves) check_axis(plan, table.where(leaf.path), leaf);
  std::size_t points = static_cast<std::size_t>(plan.seeds);
  for (const Axis& axis : plan.axes) {
    points *= axis.values.size();
    if (points > kMaxPoints)
      throw ConfigError(table.where(axis.key), fmt::format("the axes make more than {} points.", kMaxPoints));
  }
}

void read_results(Plan& plan, const ConfigSection& root) {
  if (!root.has("results")) return;
  const Where where = root.where("results");
  if (!root.is_list("results")) throw ConfigError(where, "a list of names is needed, [\"s_b\", \"s_c\"].");
  for (const TomlLeaf& leaf : toml_leaves(plan.text, ""))
    if (leaf.path == "results")
      for (const std::string& item : leaf.items) plan.results.push_back(unquoted(item));
  if (plan.results.empty())
    throw ConfigError(where, "the list is empty; without this key the sweep computes all results.");
  for (const std::string& name : plan.results) require_result(where, name);
  if (plan.criterion &&
      std::find(plan.results.begin(), plan.results.end(), plan.criterion->result) == plan.results.end())
    plan.results.push_back(plan.criterion->result);
}

Plan interpret(const Config& config, const std::string& name, const fs::path& folder) {
  Plan plan;
  plan.file = name;
  plan.text = config.text();
  const ConfigSection root = config.root();
  if (root.has("seeds"))
    throw ConfigError(
        root.where("seeds"),
        "there is no such key; axes.seeds is the number of seeds, seed the number from which they "
        "are drawn.");
  plan.seed = static_cast<std::uint64_t>(root.integer_in("seed", 0, std::int64_t{1} << 53).value_or(1));
  plan.stop_early = root.boolean("stop_early").value_or(false);
  read_scene_of(plan, root, folder);
  if (root.has("search")) {
    plan.search = read_search(root.section("search"));
    plan.criterion = read_criterion(root.section("search"));
  }
  read_axes(plan, root);
  read_results(plan, root);
  config.refuse_unknown_keys();
  if (plan.stop_early &&
      (!plan.criterion || (plan.criterion->name != "bouncing" && plan.criterion->name != "convecting")))
    throw ConfigError(
        root.where("stop_early"),
        "needs a search with the verdict \"bouncing\" or \"convecting\", which a run can decide early.");
  return plan;
}

/// Scene of a point. An error in the value of an axis is reported with the plan's file and line.
sim::Scene scene_of(const Plan& plan, const std::vector<std::string>& assignments) {
  try {
    return sim::read_scene_text(plan.scene, plan.scene_name, assignments, plan.scene_folder);
  } catch (const ConfigError& e) {
    const std::string complaint = e.what();
    for (const Axis& axis : plan.axes)
      if (const std::string from = "--set " + axis.key + ":"; complaint.starts_with(from))
        throw ConfigError({.file = plan.file, .line = axis.line, .column = 0, .key = "axes"},
                          complaint.substr(complaint.find(": ", from.size()) + 2));
    throw;
  }
}

}  // namespace

Plan read_plan_text(const std::string& text, const std::string& name, const fs::path& folder) {
  return interpret(Config::from_text(text, name), name, folder);
}

Plan read_plan(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  return interpret(Config::from_file(path), path.string(), folder);
}

namespace {

/// Results of the plan whose definition has changed since the first, with its number, for the identity of the
/// points; empty if there is none.
std::string definitions_of(const Plan& plan) {
  std::vector<std::string> wanted = plan.results.empty() ? analysis::result_names() : plan.results;
  if (plan.criterion) wanted.push_back(plan.criterion->result);
  std::set<std::string> changed;
  for (const std::string& name : wanted)
    if (const int definition = analysis::named_result(name).definition; definition > 1)
      changed.insert(fmt::format("{} {}", name, definition));
  return fmt::format("{}", fmt::join(changed, ","));
}

}  // namespace

Point make_point(const Plan& plan, const std::vector<std::string>& values, std::optional<double> at,
                 int replica) {
  throw_if_cancelled();  // a plan may have a million points
  std::vector<std::string> assignments;
  bool seeded = false;
  for (std::size_t a = 0; a < plan.axes.size(); ++a) {
    assignments.push_back(plan.axes[a].key + "=" + values[a]);
    seeded = seeded || plan.axes[a].key == "start.seed";
  }
  if (at) assignments.push_back(fmt::format("{}={}", plan.search->key, *at));
  sim::Scene scene = scene_of(plan, assignments);
  require_one_drive(scene);

  Point point;
  point.values = values;
  point.at = at;
  point.replica = replica;
  point.seed = scene.seed;
  if (!seeded) {
    // 53 bits, which TOML and JSON numbers represent exactly.
    const std::string drawn = sha256_of_text(fmt::format("{}\n{}\n{}", plan.seed, replica, scene.resolved));
    point.seed = std::stoull(drawn.substr(0, 14), nullptr, 16) >> 3U;
    assignments.push_back(fmt::format("start.seed={}", point.seed));
    scene = scene_of(plan, assignments);
  }
  point.chance = sim::has_chance(scene);
  point.scene = scene.resolved;
  std::string content = point.scene;
  if (!scene.from.empty()) content += "\n# from " + sha256_of(scene.from);
  if (!plan.results.empty()) content += fmt::format("\n# results {}", fmt::join(plan.results, ","));
  if (plan.criterion)
    content += fmt::format("\n# verdict {} {}{}", plan.criterion->result, plan.criterion->above,
                           plan.stop_early ? ", stop early" : "");
  if (const std::string definitions = definitions_of(plan); !definitions.empty())
    content += "\n# definitions " + definitions;
  point.id = sha256_of_text(content).substr(0, 16);
  const sim::Plan cost = sim::make_plan(scene);
  point.work = static_cast<double>(cost.steps) *
               static_cast<double>(std::max<std::size_t>(1, scene.n_beads.value_or(1)));
  point.memory = sim::resource_demand(scene, cost, scene.n_beads.value_or(0)).memory;
  point.warnings = cost.warnings;
  for (std::string& doubt : sim::doubtful_units(scene)) point.warnings.push_back(std::move(doubt));
  return point;
}

std::vector<std::vector<std::string>> combinations(const std::vector<Axis>& axes) {
  std::vector<std::vector<std::string>> all = {{}};
  for (const Axis& axis : axes) {
    std::vector<std::vector<std::string>> longer;
    for (const auto& head : all)
      for (const std::string& value : axis.values) {
        longer.push_back(head);
        longer.back().push_back(value);
      }
    all = std::move(longer);
  }
  return all;
}

}  // namespace twincell::sweep
