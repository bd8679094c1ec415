#include "sweep/point_warnings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "core/plural.hpp"
#include "sweep/collect.hpp"

namespace twincell::sweep {

namespace {

std::string without_numbers(const std::string& text) {
  static const std::regex number(R"([-+]?\d+(\.\d+)?(e[-+]?\d+)?)");
  return std::regex_replace(text, number, "#");
}

/// "drive.gamma = 1.2, beads.layers = 10"; empty in a plan without axes.
std::string place_of(const Plan& plan, const Point& point) {
  std::vector<std::string> parts;
  for (std::size_t a = 0; a < plan.axes.size(); ++a)
    if (plan.axes[a].key != "start.seed")
      parts.push_back(fmt::format("{} = {}", plan.axes[a].key, shown_value(point.values[a])));
  if (point.at) parts.push_back(fmt::format("{} = {:g}", plan.search->key, *point.at));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::vector<std::string> texts_of(const Point& point, const std::optional<std::string>& result) {
  std::vector<std::string> texts = point.warnings;
  if (!result) return texts;
  const nlohmann::json document = nlohmann::json::parse(*result);
  for (const auto& text : document.value("warnings", nlohmann::json::array()))
    texts.push_back(text.get<std::string>());
  return texts;
}

/// Warnings by kind, while they are gathered.
struct Gathered {
  PointWarning warning;
  std::set<std::string> places;
};

void add(Gathered& kind, const std::string& text, const std::string& place) {
  if (!kind.places.insert(place).second) return;
  if (text == kind.warning.text)
    kind.warning.places.push_back(place);
  else
    ++kind.warning.others;
}

}  // namespace

std::string PointWarning::sentence() const {
  constexpr std::size_t kNamed = 3;
  if (all < 2) return text;
  if (places.size() == all) return text + fmt::format(" It concerns all {} points of the plan.", all);
  const std::size_t named = std::min(places.size(), kNamed);
  std::string s =
      text + fmt::format(" It concerns {}", fmt::join(places.begin(), places.begin() + named, "; "));
  if (places.size() > named) s += fmt::format("; and {}", plural(places.size() - named, "other point"));
  if (others > 0) s += fmt::format("; and, with other numbers, {}", plural(others, "other point"));
  return s + ".";
}

std::vector<PointWarning> warnings_of(const Schedule& schedule) {
  std::vector<Gathered> kinds;
  std::map<std::string, std::size_t> number;
  std::set<std::string> all;
  for (const Curve& curve : schedule.curves())
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
      const std::string place = place_of(schedule.plan(), curve.points[i]);
      all.insert(place);
      for (const std::string& text : texts_of(curve.points[i], curve.results[i])) {
        const std::string kind = without_numbers(text);
        const auto [at, is_new] = number.emplace(kind, kinds.size());
        if (is_new) kinds.push_back({{.text = text, .kind = kind, .places = {}}, {}});
        add(kinds[at->second], text, place);
      }
    }
  std::vector<PointWarning> warnings;
  for (Gathered& kind : kinds) {
    kind.warning.all = all.size();
    warnings.push_back(std::move(kind.warning));
  }
  return warnings;
}

}  // namespace twincell::sweep
