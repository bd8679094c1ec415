#include "analysis/observable/observable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace twincell::analysis {

double neighbour_cutoff(const TrajectoryInfo& info, const AnalysisOptions& options) {
  return options.neighbour_cutoff.value_or(info.source == Origin::experiment ? 1.3 : 1.2);
}

bool AnalysisOptions::wants(const std::string& name) const {
  return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
}

double Result::value() const {
  if (!present() || values.empty()) return std::numeric_limits<double>::quiet_NaN();
  return values.front();
}

Result absent_result(const std::string& name, const std::string& reason, const std::string& source) {
  Result r{.name = name};
  r.absent = reason;
  r.source = source;
  return r;
}

Result mean_of(const SeriesAverage& series, Result r, const std::string& why_absent) {
  if (series.n() == 0) return absent_result(r.name, why_absent, r.source);
  r.values = {series.mean()};
  r.n = series.n();
  r.interval = series.interval(r.n_of);
  if (!r.interval && r.no_interval.empty()) r.no_interval = series.why_no_interval(r.n_of);
  return r;
}

Result array_of(const std::vector<double>& values, Result r, const std::string& why_absent) {
  r.n = static_cast<std::size_t>(
      std::count_if(values.begin(), values.end(), [](double v) { return std::isfinite(v); }));
  if (r.n == 0) return absent_result(r.name, why_absent, r.source);
  r.values = values;
  r.shape = {values.size()};
  return r;
}

SbForm s_b_named(const std::string& name) {
  return row_named(kSbForms, name, "s_b", "form of s_b").value;
}

NeighbourRule neighbour_rule_named(const std::string& name) {
  return row_named(kNeighbourRules, name, "neighbours", "rule for neighbours").value;
}

std::string neighbour_rule_text(const AnalysisContext& context) {
  if (context.options.neighbours == NeighbourRule::cutoff)
    return fmt::format("neighbours: centres within {:.4g} sigma", context.cutoff);
  return fmt::format(
      "neighbours: Voronoi cells within {:.4g} sigma that share an edge{}", context.options.cell_radius,
      context.options.neighbours == NeighbourRule::voronoi ? ", bonds weighted by the length of that edge"
                                                           : "");
}

const Neighbours& FrameView::neighbours() const {
  if (context_.options.neighbours != NeighbourRule::cutoff) return cells().neighbours;
  if (!neighbours_) neighbours_ = find_neighbours(frame_, context_.info.box, context_.cutoff);
  return *neighbours_;
}

const BondOrder& FrameView::order() const {
  if (!order_)
    order_ = context_.options.neighbours == NeighbourRule::voronoi ? bond_order(neighbours(), cells().edge)
                                                                   : bond_order(neighbours());
  return *order_;
}

const VoronoiCells& FrameView::cells() const {
  if (!cells_) cells_ = voronoi_cells(frame_, context_.info.box, context_.options.cell_radius);
  return *cells_;
}

Result cut_interval(Result r) {
  const Range range = named_result(r.name).range;
  if (!r.interval || range == Range::any) return r;
  if (r.value() >= 0) r.interval->low = std::max(0.0, r.interval->low);
  if (range == Range::share && r.value() <= 1) r.interval->high = std::min(1.0, r.interval->high);
  return r;
}

Interval uncut_interval(const Result& r) {
  const Range range = named_result(r.name).range;
  Interval interval = *r.interval;
  if (range != Range::any && interval.low == 0 && r.value() > 0) interval.low = 2 * r.value() - interval.high;
  if (range == Range::share && interval.high == 1 && r.value() < 1)
    interval.high = 2 * r.value() - interval.low;
  return interval;
}

const Result* seek_result(const std::vector<Result>& results, const std::string& name) {
  const auto found =
      std::find_if(results.begin(), results.end(), [&](const Result& r) { return r.name == name; });
  return found != results.end() ? &*found : nullptr;
}

const Result& find_result(const std::vector<Result>& results, const std::string& name) {
  const Result* found = seek_result(results, name);
  if (found == nullptr) throw std::logic_error("there is no result " + name);
  return *found;
}

}  // namespace twincell::analysis
