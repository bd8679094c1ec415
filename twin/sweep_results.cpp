#include "twin/sweep_results.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "analysis/runs/phase_boundaries.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/json_view.hpp"
#include "sweep/conditions.hpp"

namespace twincell::twin {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Conditions that are stored with a point or an onset. Those of an onset have no Gamma.
JsonView conditions_of(const JsonView& row) {
  const auto conditions = row.find("conditions");
  if (!conditions)
    row.refuse(
        "does not state its N_l, Gamma and start: an earlier version collected the sweep; collect it again "
        "with `twincell sweep collect`");
  return *conditions;
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
analysis::BedPhase phase_of(const std::optional<JsonView>& results) {
  if (const auto phase = value_of(results, "phase")) return analysis::phase_named(phase->text());
  const auto scalar = [&](const char* name) {
    const auto value = value_of(results, name);
    return value ? value->number() : std::nan("");
  };
  return analysis::bed_phase(scalar("s_b"), scalar("s_c"));
}

/// Refuses results that no run has: an s_b or s_c that is negative or beyond any bed, an interval whose ends
/// are exchanged, an unknown phase, and a phase that s_b and s_c contradict.
void require_possible(const std::optional<JsonView>& results) {
  constexpr double kMost = 1e7;  // sigma, the farthest position of a bead in a trajectory
  const auto checked = [&](const char* name) {
    const auto value = value_of(results, name);
    if (!value) return std::nan("");
    const double s = value->number();
    if (!(s >= 0)) value->refuse(fmt::format("is {:g}; it cannot be negative", s));
    if (!(s <= kMost)) value->refuse(fmt::format("is {:g}; it cannot be above {:g} (sigma)", s, kMost));
    if (const auto interval = results->at(name).find("interval"); interval && !interval->value().is_null()) {
      const auto low = number(*interval, "low"), high = number(*interval, "high");
      if (low && high && *low > *high)
        interval->refuse(fmt::format("has low = {:g} above high = {:g}", *low, *high));
    }
    return s;
  };
  const double s_b = checked("s_b"), s_c = checked("s_c");
  const auto stated = value_of(results, "phase");
  if (!stated) return;
  const std::string word = stated->text();
  const analysis::BedPhase phase = analysis::phase_named(word);
  if (word != analysis::phase_name(phase)) {
    std::string known;
    for (const auto& row : analysis::kBedPhases)
      known += fmt::format("{}{}", known.empty() ? "" : ", ", row.word);
    stated->refuse(fmt::format("'{}' is no phase; phases are: {}", word, known));
  }
  const analysis::BedPhase measured = analysis::bed_phase(s_b, s_c);
  if (measured != analysis::BedPhase::undetermined && phase != measured)
    stated->refuse(fmt::format("is {}, but s_b = {:g} and s_c = {:g} are those of a bed that is {}", word,
                               s_b, s_c, analysis::phase_name(measured)));
}

/// Says how many points of the sweep have no result yet; empty if all have one.
std::string open_points(const JsonView& document, const fs::path& file) {
  const auto stated = document.find("open");
  if (!stated || stated->value().is_null()) return {};
  const std::int64_t open = stated->integer(0);
  if (open == 0) return {};
  return fmt::format(
      "{}: {} of the {} points of the sweep {} no result yet and {} not drawn; finish it with twincell sweep "
      "run and collect it again.",
      file.string(), open, open + static_cast<std::int64_t>(document.at("points").elements().size()),
      open == 1 ? "has" : "have", open == 1 ? "is" : "are");
}

void add_points(const JsonView& document, analysis::Comparison& comparison) {
  std::set<std::string> ids;
  for (const JsonView& point : document.at("points").elements()) {
    if (const auto id = point.find("id"); id && !ids.insert(id->text()).second)
      id->refuse(fmt::format("'{}' occurs twice; each point counts once", id->text()));
    require_possible(point.find("results"));
    const analysis::BedPhase phase = phase_of(point.find("results"));
    if (phase == analysis::BedPhase::undetermined) continue;
    const RunConditions at = sweep::conditions_from_json(conditions_of(point));
    if (!at.n_l || !at.gamma) continue;  // no place in the diagram: without gravity, for example
    comparison.sweep.push_back({.n_l = *at.n_l, .gamma = *at.gamma, .start = at.start, .phase = phase});
  }
}

/// Whether the key is one of the two names of Gamma.
bool is_gamma(const std::string& key) {
  return key == "drive.gamma" || key == "drive.peak_acceleration_g";
}

/// Gamma as a function of the key that a search varies. log Gamma is linear in log key between neighbouring
/// points of a search, and beyond the outer ones. That is exact where Gamma is a power of the key, as for an
/// amplitude, a peak velocity and K_m.
class GammaOfKey {
 public:
  /// \param points of the sweep
  GammaOfKey(const JsonView& points, std::string key) : key_(std::move(key)) {
    for (const JsonView& point : points.elements()) {
      const auto axes = point.find("axes");
      if (!axes || !axes->has(key_) || !axes->at(key_).value().is_number()) continue;
      const double value = axes->at(key_).number(),
                   gamma = sweep::conditions_from_json(conditions_of(point)).gamma.value_or(0);
      if (value > 0 && gamma > 0) log_gamma_[others(axes->value())][std::log(value)] = std::log(gamma);
    }
  }

  /// Whether Gamma grows with the key in the points of an onset with these axes.
  [[nodiscard]] bool grows(const json& axes) const {
    const auto found = log_gamma_.find(others(axes));
    if (found == log_gamma_.end() || found->second.size() < 2) return false;
    const auto& curve = found->second;
    for (auto p = curve.begin(), q = std::next(p); q != curve.end(); ++p, ++q)
      if (!(q->second > p->second)) return false;
    return true;
  }

  /// \pre grows(axes)
  [[nodiscard]] std::optional<double> at(const json& axes, std::optional<double> value) const {
    if (!value || !(*value >= 0)) return std::nullopt;
    if (*value == 0) return 0;
    const auto& curve = log_gamma_.at(others(axes));
    const double x = std::log(*value);
    auto above = std::next(curve.begin());
    while (std::next(above) != curve.end() && above->first < x) ++above;
    const auto below = std::prev(above);
    const double slope = (above->second - below->second) / (above->first - below->first);
    return std::exp(below->second + slope * (x - below->first));
  }

 private:
  /// The axes without the key, as text.
  [[nodiscard]] std::string others(json axes) const {
    if (axes.is_object()) axes.erase(key_);
    return axes.dump();
  }

  std::string key_;
  std::map<std::string, std::map<double, double>> log_gamma_;  ///< by the other axes and log key
};

/// Whether the key states how strongly the plate shakes, so that Gamma grows with it.
bool is_strength(const std::string& key) {
  static const std::set<std::string> keys = {"drive.gamma",
                                             "drive.peak_acceleration_g",
                                             "drive.k_m",
                                             "drive.amplitude",
                                             "drive.amplitude_mm",
                                             "drive.peak_velocity",
                                             "drive.peak_velocity_mm_s"};
  return keys.contains(key);
}

/// Axes of the sweep at an onset or a point, without those that N_l and start state, and Gamma of a point:
/// "drive.omega = 2".
std::string other_axes(const JsonView& row, bool of_point) {
  std::string text;
  const auto axes = row.find("axes");
  if (!axes || !axes->value().is_object()) return text;
  for (const auto& [key, value] : axes->value().items()) {
    if (key == "beads.layers" || key == "start.kind" || value.is_null() || (of_point && is_strength(key)))
      continue;
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", key,
                        value.is_number()   ? fmt::format("{:g}", value.get<double>())
                        : value.is_string() ? value.get<std::string>()
                                            : value.dump());
  }
  return text;
}

/// \returns the keys of the searches whose onsets have no place in the diagram, with the number of these
std::map<std::string, int> add_onsets(const JsonView& document, analysis::Comparison& comparison) {
  std::map<std::string, int> elsewhere;
  const auto onsets = document.find("onsets");
  if (!onsets) return elsewhere;
  std::map<std::string, GammaOfKey> converters;  // by the key
  for (const JsonView& onset : onsets->elements()) {
    const analysis::BedPhase phase = analysis::phase_named(onset.at("verdict").text());
    const std::string key = onset.at("key").text();
    if (phase == analysis::BedPhase::undetermined) continue;
    const JsonView at = conditions_of(onset);
    const std::optional<double> n_l = number(at, "n_l");
    const json axes = onset.has("axes") ? onset.at("axes").value() : json::object();
    const GammaOfKey* gamma = nullptr;
    if (!is_gamma(key)) gamma = &converters.try_emplace(key, document.at("points"), key).first->second;
    if (!n_l || (gamma != nullptr && !gamma->grows(axes))) {
      ++elsewhere[key];
      continue;
    }
    const auto limit = [&](const char* name) {
      return gamma != nullptr ? gamma->at(axes, number(onset, name)) : number(onset, name);
    };
    comparison.boundaries.push_back({.side = analysis::Side::simulation,
                                     .start = at.at("start").value().is_null() ? "" : at.at("start").text(),
                                     .onset = phase,
                                     .n_l = *n_l,
                                     .n_runs = static_cast<std::size_t>(onset.at("runs").integer(0)),
                                     .below = limit("low"),
                                     .above = limit("high"),
                                     .sweep = true,
                                     .fitted = limit("value"),
                                     .axes = other_axes(onset, false)});
  }
  return elsewhere;
}

/// Brackets of the onsets from the points of a grid, which has no onsets of its own: for each set of the axes
/// other than the strength, between the points without and with the phase.
void add_brackets(const JsonView& document, analysis::Comparison& comparison) {
  std::map<std::string, std::vector<analysis::Run>> groups;
  for (const JsonView& point : document.at("points").elements()) {
    const auto axes = point.find("axes");
    if (!axes || !axes->value().is_object()) continue;
    bool varies = false;
    for (const auto& [key, value] : axes->value().items()) varies = varies || is_strength(key);
    const analysis::BedPhase phase = phase_of(point.find("results"));
    const RunConditions at = sweep::conditions_from_json(conditions_of(point));
    if (!varies || phase == analysis::BedPhase::undetermined || !at.n_l || !at.gamma) continue;
    analysis::Run& run = groups[other_axes(point, true)].emplace_back();
    run.side = analysis::Side::simulation;
    run.start = at.start;
    run.gamma = *at.gamma;
    run.n_l = *at.n_l;
    run.phase = phase;
  }
  for (const auto& [axes, runs] : groups)
    for (analysis::PhaseBoundary& boundary : analysis::find_boundaries(runs)) {
      if (!boundary.below && !boundary.above) continue;
      boundary.sweep = true;
      boundary.axes = axes;
      comparison.boundaries.push_back(std::move(boundary));
    }
}

/// The collected results in a file. \throws InputError if it holds something else
JsonView read_results(const fs::path& file) {
  JsonView document = JsonView::parse(read_text_file(file), file.string());
  if (!document.value().is_object() || document.value().value("format", json()) != "twincell sweep 1")
    throw InputError({.file = file.string()},
                     "is not a sweep's collected results (\"format\": \"twincell sweep 1\").");
  return document;
}

std::vector<std::string> add_results(const JsonView& document, const fs::path& file,
                                     analysis::Comparison& comparison) {
  std::vector<std::string> notes;
  if (std::string open = open_points(document, file); !open.empty()) notes.push_back(std::move(open));
  const std::size_t before = comparison.sweep.size() + comparison.boundaries.size();
  add_points(document, comparison);
  for (const auto& [key, count] : add_onsets(document, comparison))
    notes.push_back(
        fmt::format("{}: {} of {} {} no place in the diagram over Gamma and N_l; sweep plot draws {}.",
                    file.string(), count == 1 ? "1 onset" : fmt::format("{} onsets", count), key,
                    count == 1 ? "has" : "have", count == 1 ? "it" : "them"));
  if (!document.has("onsets") || document.at("onsets").elements().empty()) add_brackets(document, comparison);
  if (comparison.sweep.size() + comparison.boundaries.size() == before)
    throw InputError(
        {.file = file.string()},
        "no point of the sweep has a place in the diagram, which needs Gamma, N_l and the phase; "
        "add \"phase\" to the results of its plan.");
  return notes;
}

}  // namespace

std::vector<std::string> add_sweep(const fs::path& file, analysis::Comparison& comparison) {
  return add_results(read_results(file), file, comparison);
}

std::vector<std::string> add_sweeps(const std::vector<fs::path>& files, analysis::Comparison& comparison) {
  std::vector<std::string> notes;
  std::map<std::string, fs::path> known;  // by the points, as text
  for (const fs::path& file : files) {
    const JsonView document = read_results(file);
    const auto [same, is_new] = known.try_emplace(document.value().value("points", json()).dump(), file);
    if (!is_new)
      throw ConfigError({.file = {}, .key = "--sweep"},
                        fmt::format("{} and {} hold the same points; name the sweep once.",
                                    same->second.string(), file.string()));
    for (std::string& note : add_results(document, file, comparison)) notes.push_back(std::move(note));
  }
  return notes;
}

}  // namespace twincell::twin
