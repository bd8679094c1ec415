#include "sweep/stop_rule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "analysis/observable/observable.hpp"

namespace twincell::sweep {

namespace {

constexpr std::int64_t kFirstCheck = 20, kCheckEvery = 10;

/// Upper estimate of the mean over `all` cycles of a series whose first cycles are known. The rest starts
/// from the maximum of the later half and rises with the slope of its straight line plus three standard
/// errors, at least 0.
double highest_mean(const std::vector<double>& y, std::int64_t all) {
  const std::size_t n = y.size(), from = n / 2;
  const double m = static_cast<double>(n - from);
  double mean_x = 0, mean_y = 0;
  for (std::size_t k = from; k < n; ++k) {
    mean_x += static_cast<double>(k) / m;
    mean_y += y[k] / m;
  }
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t k = from; k < n; ++k) {
    const double dx = static_cast<double>(k) - mean_x, dy = y[k] - mean_y;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  const double error = std::sqrt(std::max(0.0, yy - xy * xy / xx) / (m - 2) / xx);
  const double steepest = std::max(0.0, xy / xx + 3 * error);
  const double now = *std::max_element(y.begin() + static_cast<std::ptrdiff_t>(from), y.end());
  const double known = std::accumulate(y.begin(), y.end(), 0.0);
  const double rest = static_cast<double>(all) - static_cast<double>(n);
  return (known + rest * (now + steepest * (rest + 1) / 2)) / static_cast<double>(all);
}

}  // namespace

StopRule::StopRule(Criterion criterion, const TrajectoryInfo& info, std::int64_t cycles)
    : criterion_(std::move(criterion)), cycles_(cycles) {
  TrajectoryInfo own = info;
  own.columns = {.phase = true, .plate_height = true};
  own.radius.clear();
  own.mass.clear();
  for (std::size_t i = 0; i < info.tracer.size(); ++i)
    if (info.tracer[i] != 0) slots_.push_back(i);
  own.n_beads = slots_.size();
  own.tracer.assign(slots_.size(), 1);
  tracers_ = MemoryTrajectory(std::move(own));
}

bool StopRule::add_frame(const Frame& frame) {
  Frame own;
  own.step = frame.step;
  own.time = frame.time;
  own.phase = frame.phase;
  own.cycle = frame.cycle;
  own.plate_height = frame.plate_height;
  for (const std::size_t slot : slots_) own.position.push_back(frame.position[slot]);
  tracers_.append(own);
  const std::int64_t done = frame.cycle + 1;
  if (frame.phase + 1 < tracers_.info().phases_per_cycle || done >= cycles_ || slots_.size() < 2)
    return false;
  if (done >= kFirstCheck && done % kCheckEvery == 0) decide();
  return !reason_.empty();
}

void StopRule::decide() {
  analysis::AnalysisOptions options;
  options.only = {"s_b", "s_j"};
  const auto results = analysis::analyze(tracers_, options);
  const std::int64_t done = tracers_.frames().back().cycle + 1;
  if (criterion_.result == "s_c") {
    const analysis::Result& s_j = analysis::find_result(results, "s_j");
    if (!s_j.present()) return;
    std::vector<double> squares;
    for (const double s : s_j.values)
      if (std::isfinite(s)) squares.push_back(s * s);
    if (squares.size() < static_cast<std::size_t>(kFirstCheck)) return;
    const double bound = criterion_.above * criterion_.above;
    const double sum = std::accumulate(squares.begin(), squares.end(), 0.0);
    if (sum > static_cast<double>(cycles_) * bound)
      reason_ = fmt::format("after {} of {} cycles s_c exceeds {:g} whatever follows", done, cycles_,
                            criterion_.above);
    else if (const double most = highest_mean(squares, cycles_); 2 * done >= cycles_ && most < bound / 16)
      reason_ = fmt::format("after {} of {} cycles s_c is headed for at most {:.3g}, below a quarter of {:g}",
                            done, cycles_, std::sqrt(most), criterion_.above);
    return;
  }
  const analysis::Result& s_b = analysis::find_result(results, "s_b");
  const bool clear =
      s_b.present() && s_b.interval &&
      (s_b.interval->low > 1.1 * criterion_.above || s_b.interval->high < 0.9 * criterion_.above);
  clear_ = clear ? clear_ + 1 : 0;
  if (clear_ >= 2)
    reason_ = fmt::format("after {} of {} cycles s_b = {:.4g} [{:.4g}, {:.4g}] stays clear of {:.4g}", done,
                          cycles_, s_b.value(), s_b.interval->low, s_b.interval->high, criterion_.above);
}

}  // namespace twincell::sweep
