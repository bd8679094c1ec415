#include "sweep/results_figure.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "analysis/motion/bed_phase.hpp"
#include "analysis/report/colours.hpp"
#include "analysis/report/figure_style.hpp"
#include "analysis/report/gnuplot_text.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "sim/scene/scene_keys.hpp"

namespace twincell::sweep {
namespace {

using nlohmann::json;

/// One result at one set of axes.
struct Value {
  json axes;
  std::optional<double> value, low, high;
};

std::optional<double> number(const json& object, const char* key) {
  const auto it = object.find(key);
  return it != object.end() && it->is_number() ? std::optional(it->get<double>()) : std::nullopt;
}

bool is_scalar(const json& result) {
  return number(result, "value").has_value();
}

/// Names of all scalar results of the points.
std::set<std::string> scalars(const json& document) {
  std::set<std::string> names;
  for (const json& point : document.at("points")) {
    const json results = point.value("results", json::object());
    for (const auto& [name, result] : results.items())
      if (is_scalar(result)) names.insert(name);
  }
  return names;
}

Value value_of(const json& point, const std::string& result) {
  const json r = point.value("results", json::object()).value(result, json::object());
  const json interval = r.value("interval", json());
  Value v{.axes = point.at("axes"), .value = number(r, "value"), .low = {}, .high = {}};
  if (interval.is_object()) {
    v.low = number(interval, "low");
    v.high = number(interval, "high");
  }
  return v;
}

/// Unit of a key of the scene; empty for a pure number and for a key that is not of a scene.
std::string unit_of_key(const std::string& key) {
  const auto& rows = sim::scene_keys().rows;
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const KeyRow& r) { return r.key == key; });
  return row == rows.end() || row->unit == "1" ? "" : row->unit;
}

/// The symbol of a key in enhanced text, as in the papers; empty for a key without one.
std::string symbol_of_key(const std::string& key) {
  static const std::map<std::string, std::string> symbols = {{"beads.layers", "N_l"},
                                                             {"beads.count", "N"},
                                                             {"contact.mu", "μ"},
                                                             {"contact.restitution", "e_n"},
                                                             {"contact.k_n", "k_n"},
                                                             {"contact.k_t", "k_t"},
                                                             {"contact.gamma_n", "γ_n"},
                                                             {"contact.gamma_t", "γ_t"},

                                                             {"drive.gamma", "Γ = A ω^2/g"},
                                                             {"drive.k_m", "K_m = A^2 ω^2/(σ g)"},
                                                             {"drive.omega", "ω"},
                                                             {"drive.amplitude", "A"},
                                                             {"drive.peak_acceleration_g", "Γ = A ω^2/g"}};
  const auto found = symbols.find(key);
  return found == symbols.end() ? std::string() : found->second;
}

/// Unit of a result, from the first point that states it; empty for a pure number.
std::string unit_of_result(const json& document, const std::string& result) {
  for (const json& point : document.at("points")) {
    const json r = point.value("results", json::object()).value(result, json::object());
    const std::string unit = r.value("unit", "");
    if (!unit.empty()) return unit == "1" ? "" : unit;
  }
  return {};
}

/// The label of an axis. `unit` is enhanced text.
std::string with_unit(const std::string& label, const std::string& unit) {
  return unit.empty() ? label : fmt::format("{}, {}", label, unit);
}

/// The result at every set of axes: pooled where several seeds ran.
std::vector<Value> values_of(const json& document, const std::string& result) {
  std::vector<Value> values;
  std::set<std::string> pooled;
  for (const json& group : document.value("pooled", json::array())) {
    values.push_back(value_of(group, result));
    pooled.insert(json_text(group.at("axes")));
  }
  for (const json& point : document.at("points")) {
    json axes = point.at("axes");
    axes.erase("start.seed");
    if (pooled.contains(json_text(axes))) continue;
    values.push_back(value_of(point, result));
    values.back().axes.erase("start.seed");
  }
  std::erase_if(values, [](const Value& v) { return !v.value; });
  return values;
}

std::vector<Value> onsets_of(const json& document) {
  std::vector<Value> values;
  for (const json& onset : document.value("onsets", json::array()))
    values.push_back({.axes = onset.at("axes"),
                      .value = number(onset, "value"),
                      .low = number(onset, "low"),
                      .high = number(onset, "high")});
  return values;
}

/// The axes of the values with the number of their different values, the most first.
std::vector<std::pair<std::size_t, std::string>> axes_of(const std::vector<Value>& values, bool numbers) {
  std::map<std::string, std::set<std::string>> seen;
  std::set<std::string> words;
  for (const Value& v : values)
    for (const auto& [key, at] : v.axes.items()) {
      seen[key].insert(json_text(at));
      if (!at.is_number()) words.insert(key);
    }
  std::vector<std::pair<std::size_t, std::string>> axes;
  for (const auto& [key, distinct] : seen)
    if (!numbers || !words.contains(key)) axes.emplace_back(distinct.size(), key);
  std::stable_sort(axes.begin(), axes.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  return axes;
}

/// The horizontal axis. \throws ConfigError if the named one is no axis with numbers
std::string horizontal(const std::vector<Value>& values, const FigureOptions& options) {
  const auto axes = axes_of(values, true);
  std::vector<std::string> names;
  for (const auto& [count, key] : axes) names.push_back(key);
  if (names.empty()) throw ConfigError({.file = {}, .key = "--over"}, "the sweep has no axis with numbers.");
  if (options.over.empty()) return names.front();
  if (std::find(names.begin(), names.end(), options.over.front()) == names.end())
    throw ConfigError({.file = {}, .key = "--over"},
                      fmt::format("'{}' is no axis with numbers; the sweep has {}.", options.over.front(),
                                  fmt::join(names, ", ")));
  return options.over.front();
}

/// The axes other than x that distinguish a value, as "key = value unit, ...", the named one first.
std::string curve_of(const Value& v, const std::string& x, const std::vector<std::string>& order) {
  std::vector<std::string> parts;
  for (const std::string& key : order)
    if (key != x && v.axes.contains(key)) {
      const std::string unit = unit_of_key(key);
      parts.push_back(key + " = " + json_text(v.axes[key]) + (unit.empty() ? "" : " ") + unit);
    }
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// Axes with more than one value, those of `over` first.
std::vector<std::string> distinguishing(const std::vector<Value>& values, const FigureOptions& options) {
  std::vector<std::string> keys;
  std::vector<std::string> all;
  for (const auto& [count, key] : axes_of(values, false)) {
    all.push_back(key);
    if (count > 1) keys.push_back(key);
  }
  for (const std::string& key : options.over) {
    if (std::find(all.begin(), all.end(), key) == all.end())
      throw ConfigError({.file = {}, .key = "--over"},
                        fmt::format("'{}' is no axis of the sweep; it has {}.", key, fmt::join(all, ", ")));
    std::erase(keys, key);
  }
  keys.insert(keys.begin(), options.over.begin(), options.over.end());
  return keys;
}

/// The result to draw, the chosen one or s_c or the first; none if the onsets are drawn.
/// \throws InputError if the sweep has no scalar result, ConfigError if the chosen one is none
std::string result_to_draw(const json& document, const std::string& chosen) {
  if (chosen.empty() && !document.value("onsets", json::array()).empty()) return {};
  const std::set<std::string> names = scalars(document);
  if (names.empty())
    throw InputError({.file = {}, .key = "the sweep"},
                     "has no scalar result yet; sweep run computes its points.");
  if (chosen.empty()) return names.contains("s_c") ? "s_c" : *names.begin();
  if (!names.contains(chosen))
    throw ConfigError(
        {.file = {}, .key = "--result"},
        fmt::format("'{}' is no scalar result of the sweep; it has {}.", chosen, fmt::join(names, ", ")));
  return chosen;
}

/// Sorts the values of every curve by x, and the curves by the second axis: by its number, not by its text.
/// \param order axes that distinguish values
void sort_values(std::vector<Value>& values, const std::string& x, const std::vector<std::string>& order) {
  std::stable_sort(values.begin(), values.end(), [&](const Value& a, const Value& b) {
    return a.axes.value(x, 0.0) < b.axes.value(x, 0.0);
  });
  if (order.size() < 2) return;
  const std::string second = order[0] == x ? order[1] : order[0];
  std::stable_sort(values.begin(), values.end(), [&](const Value& a, const Value& b) {
    const json p = a.axes.value(second, json()), q = b.axes.value(second, json());
    return p.is_number() && q.is_number() ? p.get<double>() < q.get<double>() : json_text(p) < json_text(q);
  });
}

/// Rows of data of one curve.
struct PlottedCurve {
  std::string name;
  std::string whole, lower, upper;  ///< values with intervals, lower limits, upper limits
  std::size_t points = 0;           ///< of `whole`

  void add(double at, const Value& v) {
    if (v.value) {
      whole +=
          fmt::format("{} {} {} {}\n", at, *v.value, v.low.value_or(*v.value), v.high.value_or(*v.value));
      ++points;
    } else if (v.low) {
      lower += fmt::format("{} {}\n", at, *v.low);
    } else if (v.high) {
      upper += fmt::format("{} {}\n", at, *v.high);
    }
  }
};

/// The curves in the order of their first values.
std::vector<PlottedCurve> curves_of(const std::vector<Value>& values, const std::string& x,
                                    const std::vector<std::string>& order) {
  std::vector<PlottedCurve> curves;
  std::map<std::string, std::size_t> index;
  for (const Value& v : values) {
    const std::string name = curve_of(v, x, order);
    const auto [it, added] = index.try_emplace(name, curves.size());
    if (added) curves.push_back({.name = name, .whole = {}, .lower = {}, .upper = {}});
    curves[it->second].add(v.axes.at(x).get<double>(), v);
  }
  return curves;
}

/// Writes the data of the figure block by block. \return the arguments of gnuplot's plot; empty without data
std::string plot_curves(const std::vector<PlottedCurve>& curves, analysis::Figure& f) {
  namespace style = analysis::figure_style;
  // Without triangles, which are limits.
  constexpr std::array kSymbols = {style::kCircle,
                                   style::kSquare,
                                   style::kDiamond,
                                   style::unfilled(style::kCircle),
                                   style::unfilled(style::kSquare),
                                   style::unfilled(style::kDiamond)};
  std::string clauses;
  int block = 0;
  const auto add = [&](const std::string& data, const std::string& columns, const std::string& look) {
    f.data += (block > 0 ? "\n\n" : "") + data;
    clauses +=
        fmt::format("{}'{}.dat' index {} using {} {}", block > 0 ? ", " : "", f.name, block, columns, look);
    ++block;
  };
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const PlottedCurve& curve = curves[c];
    const std::string title =
        curve.name.empty() ? "notitle"
                           : fmt::format("title '{}' noenhanced", analysis::gnuplot_plain_text(curve.name));
    const char* colour = analysis::colours::kCurves[c % analysis::colours::kCurves.size()];
    if (curve.points > 1) add(curve.whole, "1:2", fmt::format("with lines lc rgb '{}' notitle", colour));
    if (curve.points > 0)
      add(curve.whole, "1:2:3:4",
          fmt::format("with yerrorbars pt {} ps 1.1 lw {} lc rgb '{}' {}", kSymbols[c % kSymbols.size()],
                      style::kLine, colour, title));
    bool named = curve.points > 0;
    for (const auto& [data, symbol] :
         {std::pair(&curve.lower, style::kTriangle), std::pair(&curve.upper, style::kDown)})
      if (!data->empty()) {
        add(*data, "1:2",
            fmt::format("with points pt {} ps 1.4 lc rgb '{}' {}", symbol, colour,
                        named ? "notitle" : title));
        named = true;
      }
  }
  return clauses;
}

/// "drive.gamma at the onset of convection".
std::string onset_label(const json& onset) {
  const std::string verdict = onset.value("verdict", "");
  const analysis::BedPhase phase = analysis::phase_named(verdict);
  return fmt::format("{} at the onset of {}", onset.value("key", ""),
                     phase == analysis::BedPhase::undetermined ? verdict : analysis::onset_name(phase));
}

}  // namespace

std::string results_figure_name(const FigureOptions& options) {
  std::string name = "sweep";
  if (!options.result.empty()) name += "-" + options.result;
  if (!options.over.empty()) name += fmt::format("-over-{}", fmt::join(options.over, "-"));
  return name;
}

analysis::Figure results_figure(const std::string& collected, const FigureOptions& options) {
  constexpr std::size_t kMaxAxes = 2;
  if (options.over.size() > kMaxAxes)
    throw ConfigError({.file = {}, .key = "--over"},
                      fmt::format("names {} axes; at most two can be drawn.", options.over.size()));
  const json document = json::parse(collected);
  const std::string result = result_to_draw(document, options.result);
  const bool onsets = result.empty();
  std::vector<Value> values = onsets ? onsets_of(document) : values_of(document, result);
  const std::string x = horizontal(values, options);
  const std::vector<std::string> order = distinguishing(values, options);
  sort_values(values, x, order);

  const std::string y = onsets ? onset_label(document["onsets"][0]) : result;
  const auto key_label = [](const std::string& label, const std::string& key) {
    const std::string symbol = symbol_of_key(key), text = analysis::gnuplot_text(label);
    return with_unit(symbol.empty() ? text : fmt::format("{} ({})", symbol, text),
                     analysis::gnuplot_text(unit_of_key(key)));
  };
  analysis::figure_style::PlotAxis x_axis{.label = key_label(x, x)},
      y_axis{.label = onsets ? key_label(y, document["onsets"][0].value("key", ""))
                             : with_unit(analysis::gnuplot_symbol(y),
                                         analysis::gnuplot_formula(unit_of_result(document, result)))};
  for (const Value& v : values) {
    x_axis.show(v.axes.at(x).get<double>());
    for (const auto& end : {v.value, v.low, v.high})
      if (end) y_axis.show(*end);
  }
  analysis::Figure f{.name = results_figure_name(options), .width = 620, .height = 500};
  const std::string clauses = plot_curves(curves_of(values, x, order), f);
  if (clauses.empty())
    throw InputError({.file = {}, .key = "the sweep"},
                     "has no value to draw yet; sweep run computes its points.");
  f.title = y + " against " + x;
  f.plot = fmt::format("{}set key vertical maxrows 4\nplot {}\n",
                       analysis::figure_style::axes(x_axis, y_axis), clauses);
  f.caption = y + " with its 95 % intervals.";
  return f;
}

}  // namespace twincell::sweep
