#include "analysis/motion/convection_measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "analysis/motion/bed_phase.hpp"
#include "core/plural.hpp"

namespace twincell::analysis {
namespace {

constexpr double kJump = 0.5;  ///< sigma; larger changes of a height within one cycle are reported as jumps

const char* const kLineSource = "Fortini & Huang 2015, eq. B1";
const char* const kRmsSource = "Fortini & Huang 2015, eq. B2";

}  // namespace

void TracerSpread::add(const Frame& frame, const std::vector<double>& heights) {
  std::size_t seen = 0;
  for (std::size_t t = 0; t < heights.size(); ++t) {
    const double now = heights[t];
    seen += std::isfinite(now) ? 1 : 0;
    if (line_.n() > 0 && std::abs(now - line_.at(line_.n() - 1, t)) > kJump) ++jumps_;
    line_.height.push_back(now);
  }
  if (seen < heights.size()) ++incomplete_starts_;
  line_.cycle.push_back(frame.cycle);
}

std::string TracerSpread::why_no_spread(const std::string& no_cycles, const SeriesAverage& squares) const {
  if (!no_cycles.empty()) return no_cycles;
  if (line_.n_tracers < 2) return "a spread of heights needs at least 2 tracers";
  if (line_.n() == 0) return "no frame is at the beginning of a cycle";
  if (squares.n() == 0) return "fewer than 80 % of the tracers are present at the beginning of every cycle";
  return "";
}

Result TracerSpread::s_j(const std::vector<double>& spread, std::size_t n) const {
  Result r{
      .name = "s_j", .values = spread, .shape = {spread.size()}, .unit = "sigma", .n = n, .n_of = "cycles"};
  r.convention =
      fmt::format("spread of {} tracers about their mean at the beginning of each cycle, from cycle {}; {}",
                  line_.n_tracers, line_.cycle.front(), context_.tracer_choice);
  if (incomplete_starts_ > 0)
    r.convention += "; some tracers missing in " + plural(incomplete_starts_, "cycle");
  if (jumps_ > 0)
    r.convention += fmt::format("; {} jumps of a tracer by more than sigma/2 within one cycle", jumps_);
  r.no_interval = "single cycles; s_c has the interval of their mean square";
  r.source = kLineSource;
  return r;
}

Result TracerSpread::s_c(const SeriesAverage& squares) const {
  Result r{.name = "s_c",
           .values = {std::sqrt(squares.mean())},
           .unit = "sigma",
           .n = squares.n(),
           .n_of = "cycles"};
  r.interval = interval_of_s_c(squares);
  if (!r.interval) r.no_interval = squares.why_no_interval("cycles");
  r.convention = fmt::format("root mean square of s_j over N_f = {} cycles; threshold sigma", squares.n());
  r.source = kRmsSource;
  return r;
}

/// Interval of s_c as a correlated series over cycles if s_j is stationary. The motion of a line that drifts
/// or comes to rest is a single event, not a stationary series; the interval is then from the scatter between
/// tracers.
std::optional<Interval> TracerSpread::interval_of_s_c(const SeriesAverage& squares) const {
  auto interval = squares.interval("cycles");
  if (!interval) {
    if (squares.n() < 2) return interval;
    interval = mean_interval(mean_squares(line_), "tracers");
    if (!interval) return interval;
    interval->method += " (" + squares.why_no_interval("cycles") + ")";
  }
  interval->low = std::sqrt(std::max(0.0, interval->low));
  interval->high = std::sqrt(interval->high);
  return interval;
}

/// The first cycle that exceeds the threshold of convection.
Result TracerSpread::cycle_of_convection(const std::vector<double>& spread, std::size_t n) const {
  const auto first =
      std::find_if(spread.begin(), spread.end(), [](double s) { return s > kConvectionThreshold; });
  if (first == spread.end())
    return absent_result("cycle_of_convection",
                         "s_j does not exceed sigma in " + plural(spread.size(), "cycle"), kLineSource);
  Result r{.name = "cycle_of_convection", .unit = "cycles", .n = n, .n_of = "cycles"};
  r.values = {static_cast<double>(line_.cycle[static_cast<std::size_t>(first - spread.begin())])};
  r.convention = "first cycle at whose beginning s_j > sigma";
  r.no_interval = "a single event in one run; runs with other seeds give its scatter";
  r.source = kLineSource;
  return r;
}

void TracerSpread::add_spread(const std::string& no_cycles, std::vector<Result>& all) const {
  std::vector<std::size_t> everyone(line_.n_tracers);
  std::iota(everyone.begin(), everyone.end(), std::size_t{0});
  std::vector<double> spread;
  SeriesAverage squares;
  for (std::size_t j = 0; j < line_.n(); ++j) {
    const double squared = spread_squared(line_, j, everyone);
    spread.push_back(std::sqrt(squared));
    if (std::isfinite(squared)) squares.add(squared);
  }
  if (const std::string reason = why_no_spread(no_cycles, squares); !reason.empty()) {
    all.push_back(absent_result("s_j", reason, kLineSource));
    all.push_back(absent_result("s_c", reason, kRmsSource));
    all.push_back(absent_result("cycle_of_convection", reason, kLineSource));
    return;
  }
  all.push_back(s_j(spread, squares.n()));
  all.push_back(s_c(squares));
  all.push_back(cycle_of_convection(spread, squares.n()));
}

Result TracerSpread::growth_result(const std::string& name, const Growth& slope, std::size_t first) const {
  if (!std::isfinite(slope.rate)) return absent_result(name, "a slope needs at least 2 cycles", kLineSource);
  Result r{.name = name, .values = {slope.rate}, .unit = "sigma^2", .n = line_.n() - first, .n_of = "cycles"};
  r.interval = slope.interval;
  if (!r.interval) r.no_interval = "fewer than 3 tracers, or the same slope for all tracers";
  r.convention = fmt::format("d s_j^2/dj by least squares, cycles {} to {}; per cycle", line_.cycle[first],
                             line_.cycle.back());
  r.source = kLineSource;
  return r;
}

void TracerSpread::add_drift(double noise, std::vector<Result>& all) const {
  const Result& spread = find_result(all, "s_j");
  if (!spread.present()) {
    const std::string reason = spread.absent;  // copied: additions to `all` invalidate the reference
    for (const char* name : {"s_j_growth", "s_j_growth_late", "drift"})
      all.push_back(absent_result(name, reason, kLineSource));
    return;
  }
  const double last = spread.values.back();  // copied for the same reason
  const DriftVerdict verdict = judge_drift(line_, std::isfinite(noise) ? noise : 0);
  all.push_back(growth_result("s_j_growth", growth(line_, 0, line_.n()), 0));
  if (verdict.drift == Drift::undetermined) {
    all.push_back(absent_result("s_j_growth_late", verdict.reason, kLineSource));
    all.push_back(absent_result("drift", verdict.reason, kLineSource));
    return;
  }
  all.push_back(growth_result("s_j_growth_late", verdict.late, line_.n() / 2));
  Result word{.name = "drift", .text = drift_name(verdict.drift), .n = line_.n(), .n_of = "cycles"};
  word.convention = verdict.reason + fmt::format("; s_j ends at {:.3g} sigma", last);
  word.source = kLineSource;
  all.push_back(std::move(word));
}

void TracerSpread::add_line(const std::string& no_cycles, std::vector<Result>& all) const {
  if (line_.n_tracers == 0) {
    all.push_back(absent_result("tracers", context_.no_tracers, kLineSource));
    all.push_back(absent_result("tracer_heights", context_.no_tracers, kLineSource));
    return;
  }
  Result tracers{.name = "tracers",
                 .values = {context_.tracers.begin(), context_.tracers.end()},
                 .shape = {line_.n_tracers},
                 .unit = "id",
                 .n = line_.n_tracers,
                 .n_of = "tracers"};
  tracers.convention = context_.tracer_choice;
  tracers.source = kLineSource;
  all.push_back(std::move(tracers));
  if (line_.n() == 0) {
    all.push_back(absent_result("tracer_heights",
                                no_cycles.empty() ? "no frame is at the beginning of a cycle" : no_cycles,
                                kLineSource));
    return;
  }
  Result heights{.name = "tracer_heights",
                 .values = line_.height,
                 .shape = {line_.n(), line_.n_tracers},
                 .unit = "sigma",
                 .n = line_.n(),
                 .n_of = "cycles"};
  heights.convention =
      fmt::format("height of each tracer at the beginning of each cycle, from cycle {}", line_.cycle.front());
  heights.source = kLineSource;
  all.push_back(std::move(heights));
}

}  // namespace twincell::analysis
