#include "sweep/schedule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

namespace twincell::sweep {

namespace {

bool failed(const std::string& result) {
  return nlohmann::json::parse(result).contains("failed");
}

std::vector<Trial> trials_of(const Curve& curve) {
  std::vector<Trial> trials;
  for (std::size_t i = 0; i < curve.points.size(); ++i)
    if (const auto answer = curve.results[i] ? answer_of(*curve.results[i]) : std::nullopt)
      trials.push_back({*curve.points[i].at, *answer});
  return trials;
}

/// Axis values with the seed cleared.
std::vector<std::string> besides_seed(const Plan& plan, std::vector<std::string> values) {
  for (std::size_t a = 0; a < plan.axes.size(); ++a)
    if (plan.axes[a].key == "start.seed") values[a].clear();
  return values;
}

/// Position closest to x, in steps of width/16, at which the curve has no run; x if the range has none.
double place_without_run(const Curve& curve, const Search& search, double x) {
  const auto taken = [&](double place) {
    return std::any_of(curve.points.begin(), curve.points.end(),
                       [&](const Point& p) { return p.at == place; });
  };
  const double step = search.width / 16;
  for (int k = 0; k * step <= search.high - search.low; ++k)
    for (const int sign : {1, -1}) {
      const double place = std::stod(fmt::format("{:.6g}", x + sign * k * step));
      if (place >= search.low && place <= search.high && !taken(place)) return place;
    }
  return x;
}

}  // namespace

std::optional<bool> answer_of(const std::string& result) {
  const auto document = nlohmann::json::parse(result);
  if (!document.contains("answer") || !document["answer"].is_boolean()) return std::nullopt;
  return document["answer"].get<bool>();
}

Schedule::Schedule(const Plan& plan, const Store& store, Shard shard) : plan_(plan), store_(store) {
  int number = 0;
  std::set<std::vector<std::string>> without_chance;
  const auto ours = [&] { return number++ % shard.of == shard.index - 1; };
  for (const auto& values : combinations(plan.axes)) {
    Curve curve;
    curve.values = values;
    if (plan.search) {
      if (ours()) curves_.push_back(std::move(curve));
      continue;
    }
    Point first = make_point(plan, values, std::nullopt, 0);
    const bool chance = first.chance;
    if (!chance && !without_chance.insert(besides_seed(plan, values)).second) {
      ++repeats_;  // the seed is an axis, and this value is not the first
      continue;
    }
    if (ours()) curve.points.push_back(std::move(first));
    if (!chance) repeats_ += static_cast<std::size_t>(plan.seeds - 1);
    for (int replica = 1; chance && replica < plan.seeds; ++replica)
      if (ours()) curve.points.push_back(make_point(plan, values, std::nullopt, replica));
    if (!curve.points.empty()) curves_.push_back(std::move(curve));
  }
  here_.resize(curves_.size());
  for (std::size_t c = 0; c < curves_.size(); ++c) advance(c, 0);
}

/// Reads the stored results of the points from `unseen` on. When a round of a search is complete, adds the
/// points of the next round.
void Schedule::advance(std::size_t index, std::size_t unseen) {
  Curve& curve = curves_[index];
  for (;;) {
    const std::size_t n = curve.points.size();
    here_[index].resize(n, 0);
    curve.results.resize(n);
    curve.failed.resize(n, 0);
    for (; unseen < n; ++unseen)
      if (auto result = store_.result(curve.points[unseen])) {
        curve.failed[unseen] = failed(*result) ? 1 : 0;
        curve.results[unseen] = std::move(result);
      }
    if (!std::all_of(curve.results.begin(), curve.results.end(), [](const auto& r) { return r.has_value(); }))
      return;
    if (!plan_.search) {
      curve.complete = true;
      return;
    }
    const Search& search = *plan_.search;
    curve.onset = estimate_onset(trials_of(curve), search.low, search.high, search.width);
    const int left = search.runs - static_cast<int>(curve.points.size());
    if (left <= 0 || settled(*curve.onset, search.low, search.high, search.width)) {
      curve.complete = true;
      return;
    }
    for (const double x :
         next_places(*curve.onset, search.low, search.high, search.width, std::min(left, search.batch))) {
      const auto before =
          std::count_if(curve.points.begin(), curve.points.end(), [&](const Point& p) { return p.at == x; });
      Point point = make_point(plan_, curve.values, x, static_cast<int>(before));
      // Without randomness the same position would count one answer twice; use a free position next to it.
      if (!point.chance && before > 0)
        point = make_point(plan_, curve.values, place_without_run(curve, search, x), 0);
      curve.points.push_back(std::move(point));
    }
  }
}

std::optional<Task> Schedule::take(std::optional<double> most) {
  struct Open {
    double work;
    std::size_t curve, number;
  };
  std::vector<Open> open;
  for (std::size_t c = 0; c < curves_.size(); ++c)
    for (std::size_t i = 0; i < curves_[c].points.size(); ++i)
      if (!curves_[c].results[i] && here_[c][i] == 0 && (!most || curves_[c].points[i].work <= *most))
        open.push_back({curves_[c].points[i].work, c, i});
  std::stable_sort(open.begin(), open.end(), [](const Open& a, const Open& b) { return a.work > b.work; });
  for (const Open& o : open) {
    const Point& point = curves_[o.curve].points[o.number];
    auto claim = store_.claim(point);
    if (!claim) continue;
    store_.announce(plan_, point);
    // The previous owner of the claim may have finished after the results were read.
    if (const auto result = store_.result(point)) {
      enter_result(o.curve, o.number, *result);
      return take(most);
    }
    here_[o.curve][o.number] = 1;
    return Task{point, std::move(*claim), o.curve, o.number};
  }
  return std::nullopt;
}

void Schedule::enter_result(std::size_t curve, std::size_t number, const std::string& result) {
  Curve& c = curves_[curve];
  c.results[number] = result;
  c.failed[number] = failed(result) ? 1 : 0;
  advance(curve, c.points.size());
}

void Schedule::done(const Task& task, const std::string& result) {
  here_[task.curve][task.number] = 0;
  enter_result(task.curve, task.number, result);
}

std::string Schedule::repeats_text() const {
  if (repeats_ == 0) return "";
  return fmt::format(
      "{} of the plan's runs would repeat another bit for bit and {} left out: without a random start, "
      "perturbation or size spread the seed has no effect.",
      repeats_, repeats_ == 1 ? "is" : "are");
}

bool Schedule::all() const {
  return std::all_of(curves_.begin(), curves_.end(), [](const Curve& c) { return c.complete; });
}

Counts Schedule::counts() const {
  Counts counts;
  double further = 0;
  for (std::size_t c = 0; c < curves_.size(); ++c) {
    const Curve& curve = curves_[c];
    double work = 0;
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
      ++counts.known;
      counts.here += here_[c][i] != 0 ? 1 : 0;
      work += curve.points[i].work;
      if (curve.results[i]) {
        ++counts.done;
        counts.failed += curve.failed[i] != 0 ? 1 : 0;
      } else {
        counts.work_left += curve.points[i].work;
      }
    }
    if (!plan_.search || curve.complete || curve.points.empty()) continue;
    const auto known = static_cast<double>(curve.points.size());
    const double more = std::max(0.0, plan_.search->runs - known);
    counts.most += static_cast<std::size_t>(more);
    further += more * work / known;
  }
  counts.most += counts.known;
  counts.most_work = counts.work_left + further;
  return counts;
}

const Point* Schedule::longest_open() const {
  const Point* longest = nullptr;
  for (const Curve& curve : curves_)
    for (std::size_t i = 0; i < curve.points.size(); ++i)
      if (!curve.results[i] && (longest == nullptr || curve.points[i].work > longest->work))
        longest = &curve.points[i];
  return longest;
}

}  // namespace twincell::sweep
