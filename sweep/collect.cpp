#include "sweep/collect.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>
#include <vector>

#include "analysis/observable/results.hpp"
#include "analysis/runs/pooling.hpp"
#include "core/escape.hpp"
#include "core/json_text.hpp"
#include "core/json_view.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/scene.hpp"
#include "sweep/conditions.hpp"

namespace twincell::sweep {

namespace {

using nlohmann::json;

/// A TOML scalar as JSON; a literal that is not valid JSON becomes a string.
json value_of(const std::string& literal) {
  if (literal.size() >= 2 && literal.front() == '\'') return literal.substr(1, literal.size() - 2);
  const json value = json::parse(literal, nullptr, false);
  return value.is_discarded() ? json(literal) : value;
}

json axes_of(const Plan& plan, const std::vector<std::string>& values) {
  json axes = json::object();
  for (std::size_t a = 0; a < plan.axes.size(); ++a) axes[plan.axes[a].key] = value_of(values[a]);
  return axes;
}

json optional(const std::optional<double>& value) {
  return value ? json(*value) : json(nullptr);
}

/// Points of a curve in the order of the search's key, then of the replica, so that the output does not
/// depend on the order of computation.
std::vector<std::size_t> order_of(const Curve& curve) {
  std::vector<std::size_t> order(curve.points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const Point &p = curve.points[a], &q = curve.points[b];
    return std::pair(p.at.value_or(0), p.replica) < std::pair(q.at.value_or(0), q.replica);
  });
  return order;
}

/// Conditions of a point whose stored result has none, because it failed before the run began or an earlier
/// version computed it: from its scene. The number of beads of a file's start is then unknown.
json conditions_of_scene(const Plan& plan, const Point& point) {
  const sim::Scene scene = sim::read_scene_text(point.scene, "point " + point.id, {}, plan.scene_folder);
  std::optional<std::size_t> beads = scene.n_beads;
  if (beads && scene.intruder) ++*beads;
  return conditions_json(sim::conditions_of(scene, beads));
}

json point_json(const Plan& plan, const Point& point, const std::string& result) {
  json j = json::parse(result);
  if (!j.contains("conditions")) j["conditions"] = conditions_of_scene(plan, point);
  j.erase("computed");
  j.erase("sha256");
  j["axes"] = axes_of(plan, point.values);
  if (point.at) j["axes"][plan.search->key] = *point.at;
  j["replica"] = point.replica;
  j["seed"] = point.seed;
  return j;
}

/// N_l and start of an onset: those of its points. A value is null if the points differ in it, as N_l in a
/// search along the number of beads, or if there is no point.
json conditions_of_onset(const json& points) {
  if (points.empty()) return {{"n_l", nullptr}, {"start", nullptr}};
  json common = points.at(0).at("conditions");
  for (const json& point : points)
    for (const char* key : {"n_l", "start"})
      if (common[key] != point.at("conditions").at(key)) common[key] = nullptr;
  common.erase("gamma");
  return common;
}

/// \param points those of the curve that are done, as point_json
json onset_json(const Plan& plan, const Curve& curve, const json& points) {
  const Onset& o = *curve.onset;
  return {{"axes", axes_of(plan, curve.values)},
          {"conditions", conditions_of_onset(points)},
          {"key", plan.search->key},
          {"verdict", plan.criterion->name},
          {"value", optional(o.value)},
          {"low", optional(o.low)},
          {"high", optional(o.high)},
          {"level", o.level},
          {"method", "logistic regression over seeds, profile likelihood"},
          {"range", {plan.search->low, plan.search->high}},
          {"runs", o.n},
          {"yes", o.yes},
          {"complete", curve.complete},
          {"text", o.text()}};
}

/// Runs that differ only in the seed.
struct Group {
  json axes;
  std::vector<std::vector<analysis::Result>> runs;
  std::size_t repeats = 0;  ///< runs left out because they equal another run bit for bit
};

/// Groups of the points with results, in the order of the points. If the seed is an axis of the plan, it does
/// not separate groups.
std::vector<Group> groups_of(const json& points) {
  std::vector<Group> groups;
  std::map<std::string, std::size_t> number;
  for (const json& point : points) {
    if (!point.contains("results")) continue;
    json axes = point["axes"];
    axes.erase("start.seed");
    const auto [place, is_new] = number.emplace(json_text(axes), groups.size());
    if (is_new) groups.push_back({axes, {}});
    std::vector<analysis::Result> run =
        analysis::results_from_json(JsonView::parse(json_text(point["results"]), "the collected results"));
    std::erase_if(run, [](const analysis::Result& r) { return !r.shape.empty(); });
    groups[place->second].runs.push_back(std::move(run));
  }
  for (Group& group : groups) {
    const std::vector<std::size_t> first = analysis::repeated_runs(group.runs);
    std::vector<std::vector<analysis::Result>> different;
    for (std::size_t i = 0; i < first.size(); ++i)
      if (first[i] == i) different.push_back(std::move(group.runs[i]));
    group.repeats = first.size() - different.size();
    group.runs = std::move(different);
  }
  return groups;
}

/// Pooled scalars and words of every group with two or more runs.
json pooled_json(const json& points) {
  json pooled = json::array();
  for (const Group& group : groups_of(points)) {
    if (group.runs.size() < 2 && group.repeats == 0) continue;
    pooled.push_back({{"axes", group.axes},
                      {"runs", group.runs.size()},
                      {"results", json::parse(analysis::results_json(analysis::pool(group.runs)))}});
    if (group.repeats > 0) pooled.back()["repeats_left_out"] = group.repeats;
  }
  return pooled;
}

json document_of(const Schedule& schedule) {
  const Plan& plan = schedule.plan();
  json document = {
      {"format", "twincell sweep 1"}, {"plan", plan.text}, {"seed", plan.seed}, {"points", json::array()}};
  std::size_t open = 0;
  for (const Curve& curve : schedule.curves()) {
    json points = json::array();
    for (const std::size_t i : order_of(curve)) {
      if (curve.results[i])
        points.push_back(point_json(plan, curve.points[i], *curve.results[i]));
      else
        ++open;
    }
    if (curve.onset) document["onsets"].push_back(onset_json(plan, curve, points));
    document["points"].insert(document["points"].end(), points.begin(), points.end());
  }
  document["pooled"] = pooled_json(document["points"]);
  document["open"] = open;
  return document;
}

/// Columns between the axes and the results.
const std::vector<std::string> kOfPoint = {"replica", "seed", "answer", "n_cycles", "failed"},
                               kOfPool = {"runs"};

/// Columns of a result.
std::vector<std::string> columns_of(const std::string& name) {
  return {name, name + "_low", name + "_high"};
}

std::string cell(const json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return json_text(value);
  return csv_field(value.get<std::string>());
}

/// CSV with one line per row: the columns `lead`, the axes, the columns `keys_of_row`, then value, low and
/// high of every scalar result.
std::string table_of(const json& rows, const std::vector<std::string>& lead,
                     const std::vector<std::string>& keys_of_row) {
  std::set<std::string> keys, names;
  for (const json& row : rows) {
    for (const auto& [key, value] : row["axes"].items()) keys.insert(key);
    if (!row.contains("results")) continue;
    for (const auto& [name, result] : row["results"].items())
      if (result.contains("value") && !result["value"].is_array()) names.insert(name);
  }
  std::vector<std::string> head = lead;
  head.insert(head.end(), keys.begin(), keys.end());
  head.insert(head.end(), keys_of_row.begin(), keys_of_row.end());
  for (const auto& name : names)
    for (std::string& column : columns_of(name)) head.push_back(std::move(column));
  std::string text = fmt::format("{}\n", fmt::join(head, ","));
  for (const json& row : rows) {
    std::vector<std::string> cells;
    for (const auto& key : lead) cells.push_back(cell(row[key]));
    for (const auto& key : keys) cells.push_back(cell(row["axes"].value(key, json())));
    for (const auto& key : keys_of_row) cells.push_back(cell(row.value(key, json())));
    const json results = row.value("results", json::object());
    for (const auto& name : names) {
      const json result = results.value(name, json::object());
      const json value = result.value("value", json()), interval = result.value("interval", json::object());
      cells.push_back(value.is_array() ? std::string() : cell(value));
      for (const char* end : {"low", "high"}) cells.push_back(cell(interval.value(end, json())));
    }
    text += fmt::format("{}\n", fmt::join(cells, ","));
  }
  return text;
}

}  // namespace

std::string shown_value(const std::string& literal) {
  const json value = value_of(literal);
  return value.is_string() ? value.get<std::string>() : json_text(value);
}

std::string collected_json(const Schedule& schedule) {
  return json_text(document_of(schedule), 1) + "\n";
}

std::string collected_csv(const Schedule& schedule) {
  return table_of(document_of(schedule)["points"], {"id"}, kOfPoint);
}

Product collected_csv_file() {
  return {.name = "a table of a sweep",
          .sign = Product::Sign::head,
          .mark = fmt::format("{}", fmt::join(kOfPoint, ","))};
}

std::vector<std::string> results_outside_csv(const json& collected) {
  std::set<std::string> names;
  for (const json& point : collected["points"]) {
    if (!point.contains("results")) continue;
    for (const auto& [name, result] : point["results"].items())
      if (result.contains("value") && result["value"].is_array()) names.insert(name);
  }
  return {names.begin(), names.end()};
}

std::string pooled_csv(const Schedule& schedule) {
  const json pooled = document_of(schedule)["pooled"];
  const bool numbers =
      std::any_of(pooled.begin(), pooled.end(), [](const json& row) { return !row["results"].empty(); });
  return numbers ? table_of(pooled, {}, kOfPool) : std::string();
}

Product pooled_csv_file() {
  std::vector<std::string> marks;  // the last column of a pool and those of its first result
  for (const std::string& name : analysis::result_names())
    marks.push_back(fmt::format("{},{}", kOfPool.back(), fmt::join(columns_of(name), ",")));
  return {.name = "a pooled table of a sweep",
          .sign = Product::Sign::head,
          .mark = fmt::format("{}", fmt::join(marks, "\n"))};
}

namespace {

/// "0.41", or "0.41 ... 0.48" for several runs; "-" for none.
std::string extremes(const std::vector<double>& values) {
  if (values.empty()) return "-";
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const std::string first = fmt::format("{:.4g}", *low), last = fmt::format("{:.4g}", *high);
  return first == last ? first : first + " ... " + last;
}

/// The cells of one row of grid_table: values of the axes, runs, phases, and the extremes of each number.
std::vector<std::string> grid_row(const Curve& curve, const std::vector<std::string>& numbers) {
  std::map<std::string, std::size_t> phases;
  std::vector<std::vector<double>> values(numbers.size());
  std::size_t failed = 0, done = 0;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    if (!curve.results[i]) continue;
    ++done;
    if (curve.failed[i] != 0) {
      ++failed;
      continue;
    }
    const json results = json::parse(*curve.results[i]).value("results", json::object());
    const auto value = [&](const std::string& name) {
      const json result = results.value(name, json::object());
      return result.value("value", json());
    };
    if (const json phase = value("phase"); phase.is_string()) ++phases[phase.get<std::string>()];
    for (std::size_t k = 0; k < numbers.size(); ++k)
      if (const json number = value(numbers[k]); number.is_number())
        values[k].push_back(number.get<double>());
  }
  std::vector<std::string> words;
  for (const auto& [name, n] : phases)
    words.push_back(phases.size() > 1 ? fmt::format("{} {}", n, name) : name);
  if (failed > 0) words.push_back(fmt::format("{} failed", failed));
  std::vector<std::string> row;
  for (const std::string& literal : curve.values) row.push_back(shown_value(literal));
  row.push_back(fmt::format("{}", done));
  row.push_back(words.empty() ? "-" : fmt::format("{}", fmt::join(words, ", ")));
  for (const auto& v : values) row.push_back(extremes(v));
  return row;
}

/// Table of a grid for a terminal: phase and the first numbers at each set of axes.
std::string grid_table(const Schedule& schedule) {
  constexpr std::size_t kMaxRows = 24, kMaxNumbers = 2;
  const Plan& plan = schedule.plan();
  if (plan.search || plan.axes.empty()) return {};
  std::vector<std::string> numbers = {"s_b", "s_c"};
  if (!plan.results.empty()) numbers.assign(plan.results.begin(), plan.results.end());
  std::erase(numbers, "phase");
  numbers.resize(std::min(numbers.size(), kMaxNumbers));
  std::vector<std::vector<std::string>> table(1);
  for (const Axis& axis : plan.axes) table[0].push_back(axis.key);
  table[0].insert(table[0].end(), {"runs", "phase"});
  table[0].insert(table[0].end(), numbers.begin(), numbers.end());
  for (const Curve& curve : schedule.curves())
    if (table.size() <= kMaxRows) table.push_back(grid_row(curve, numbers));
  // Columns that tell nothing: one run everywhere, or no phase because the plan does not want it.
  const auto everywhere = [&](std::size_t column, const char* cell) {
    return std::all_of(table.begin() + 1, table.end(), [&](const auto& row) { return row[column] == cell; });
  };
  const auto drop = [&](std::size_t column, const char* cell) {
    if (everywhere(column, cell))
      for (auto& row : table) row.erase(row.begin() + static_cast<std::ptrdiff_t>(column));
  };
  drop(plan.axes.size() + 1, "-");
  drop(plan.axes.size(), "1");
  std::string text;
  for (const auto& row : table) {
    std::string line;
    for (std::size_t k = 0; k < row.size(); ++k) {
      std::size_t width = 0;
      for (const auto& other : table) width = std::max(width, other[k].size());
      line += k + 1 < row.size() ? fmt::format("{:<{}}  ", row[k], width) : row[k];
    }
    text += line + "\n";
  }
  if (const std::size_t all = schedule.curves().size(); all > kMaxRows)
    text += fmt::format("{} more rows: sweep collect writes all results to a table\n", all - kMaxRows);
  return text;
}

/// What a search lacks: runs that are still to come, or an interval as narrow as the plan asks.
std::string shortfall(const Curve& curve, const Search& search) {
  if (!curve.complete) return " (unfinished)";
  if (settled(*curve.onset, search.low, search.high, search.width)) return {};
  return fmt::format("; not within search.width = {:g} after search.runs = {}", search.width, search.runs);
}

/// Why runs failed: one line for each of the three most frequent reasons, with the number of its runs.
std::string failures_text(const Schedule& schedule) {
  constexpr std::size_t kMaxReasons = 3;
  std::map<std::string, std::size_t> runs_of;
  for (const Curve& curve : schedule.curves())
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
      if (!curve.results[i] || curve.failed[i] == 0) continue;
      std::string reason = json::parse(*curve.results[i])["failed"].get<std::string>();
      // The name and the place of the scene's text are those of one point.
      if (const std::string own = "point " + curve.points[i].id; reason.starts_with(own))
        if (const std::size_t colon = reason.find(": ", own.size()); colon != std::string::npos)
          reason.erase(0, colon + 2);
      ++runs_of[reason];
    }
  std::vector<std::pair<std::string, std::size_t>> reasons(runs_of.begin(), runs_of.end());
  std::stable_sort(reasons.begin(), reasons.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string text;
  for (std::size_t k = 0; k < std::min(reasons.size(), kMaxReasons); ++k)
    text += fmt::format("failed ({}): {}\n", reasons[k].second, reasons[k].first);
  if (reasons.size() > kMaxReasons)
    text +=
        fmt::format("failed: {} other reasons, which sweep collect writes\n", reasons.size() - kMaxReasons);
  return text;
}

}  // namespace

std::string collected_text(const Schedule& schedule) {
  const Plan& plan = schedule.plan();
  const Counts counts = schedule.counts();
  std::string text = fmt::format("{} of {} points done{}\n", counts.done, counts.known,
                                 counts.failed > 0 ? fmt::format(", {} of them failed", counts.failed) : "");
  for (const Curve& curve : schedule.curves()) {
    if (!curve.onset) continue;
    std::string place;
    for (std::size_t a = 0; a < plan.axes.size(); ++a)
      if (plan.axes[a].values.size() > 1)
        place += fmt::format("{} = {}, ", plan.axes[a].key, shown_value(curve.values[a]));
    text += fmt::format("{}{} from {} {}{}\n", place, plan.criterion->name, plan.search->key,
                        curve.onset->text(), shortfall(curve, *plan.search));
  }
  return text + failures_text(schedule) + grid_table(schedule);
}

}  // namespace twincell::sweep
