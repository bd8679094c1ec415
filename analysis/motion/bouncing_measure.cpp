#include "analysis/motion/bouncing_measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/motion/tracer_line.hpp"
#include "core/constants.hpp"
#include "trajectory/plate.hpp"

namespace twincell::analysis {
namespace {

const char* const kCurveSource = "Fortini & Huang 2015, eq. B3";
const char* const kSpreadSource = "Fortini & Huang 2015, eq. B4";

}  // namespace

double s_b_of(const std::vector<double>& s_k, SbForm form, double rest_height) {
  const double n = static_cast<double>(s_k.size());
  double reference = 0;
  if (form == SbForm::variance) reference = std::accumulate(s_k.begin(), s_k.end(), 0.0) / n;
  if (form == SbForm::about_rest) reference = rest_height;
  double sum = 0;
  for (const double s : s_k) sum += (s - reference) * (s - reference);
  return std::sqrt(sum / n);
}

void HeightSums::add(const HeightSums& other) {
  for (std::size_t e = 0; e < sum.size(); ++e) {
    sum[e] += other.sum[e];
    count[e] += other.count[e];
  }
}

Bouncing::Bouncing(const AnalysisContext& context)
    : context_(context),
      n_tracers_(context.tracers.size()),
      n_phases_(static_cast<std::size_t>(std::max(0, context.info.phases_per_cycle))),
      total_(n_tracers_ * n_phases_),
      pair_(n_tracers_ * n_phases_),
      cycle_(n_tracers_ * n_phases_),
      phase_seen_(n_phases_, 0) {}

void Bouncing::add(const Frame& frame, const std::vector<double>& heights) {
  if (frame.cycle != current_cycle_) {
    close_cycle();
    current_cycle_ = frame.cycle;
  }
  const auto plate = plate_height(context_.info, frame);
  if (!plate) {
    no_plate_ = true;
    return;
  }
  const auto present =
      std::count_if(heights.begin(), heights.end(), [](double z) { return std::isfinite(z); });
  if (static_cast<double>(present) < kEnoughTracers * static_cast<double>(n_tracers_)) return;
  const auto k = static_cast<std::size_t>(frame.phase);
  phase_seen_[k] = 1;
  for (std::size_t t = 0; t < n_tracers_; ++t)
    if (std::isfinite(heights[t])) {
      cycle_.sum[t * n_phases_ + k] += heights[t] - *plate;
      ++cycle_.count[t * n_phases_ + k];
    }
}

/// Adds a whole cycle to the current pair, and a complete pair to the total, so that the total contains an
/// even number of cycles.
void Bouncing::close_cycle() {
  const bool whole = !phase_seen_.empty() &&
                     std::all_of(phase_seen_.begin(), phase_seen_.end(), [](char seen) { return seen != 0; });
  if (whole) {
    ++whole_cycles_;
    pair_.add(cycle_);
    if (whole_cycles_ % 2 == 0) {
      total_.add(pair_);
      pair_ = HeightSums(total_.sum.size());
    }
  } else if (current_cycle_ >= 0) {
    ++broken_cycles_;
  }
  cycle_ = HeightSums(total_.sum.size());
  std::fill(phase_seen_.begin(), phase_seen_.end(), 0);
}

std::size_t Bouncing::cycles_used() const {
  return whole_cycles_ < 2 ? whole_cycles_ : whole_cycles_ - whole_cycles_ % 2;
}

std::string Bouncing::why_absent(const std::string& no_cycles) const {
  if (!no_cycles.empty()) return no_cycles;
  if (no_plate_) return "the plate's height is not known: neither recorded nor given by a drive";
  if (cycles_used() == 0)
    return fmt::format("no cycle has all {} phases with at least 80 % of the tracers", n_phases_);
  return "";
}

/// s(k) of a resample of the tracers. Each tracer is averaged at each phase first, so that a tracer that is
/// missing in some cycles does not shift the curve.
std::vector<double> Bouncing::curve(const std::vector<std::size_t>& tracers) const {
  std::vector<double> s(n_phases_, kNaN);
  for (std::size_t k = 0; k < n_phases_; ++k) {
    double sum = 0;
    std::size_t n = 0;
    for (const std::size_t t : tracers) {
      const std::size_t e = t * n_phases_ + k;
      if (sums().count[e] == 0) continue;
      sum += sums().sum[e] / static_cast<double>(sums().count[e]);
      ++n;
    }
    if (n > 0) s[k] = sum / static_cast<double>(n);
  }
  return s;
}

/// Mean rest height of a resample of the tracers. A different set of tracers rests at a different height, so
/// that the rest height is resampled with the curve. NaN if no tracer has a rest height.
double Bouncing::rest_of(const std::vector<std::size_t>& tracers) const {
  double sum = 0;
  std::size_t n = 0;
  for (const std::size_t t : tracers) {
    const double rest = context_.tracer_rest_heights[t];
    if (!std::isfinite(rest)) continue;
    sum += rest;
    ++n;
  }
  return n > 0 ? sum / static_cast<double>(n) : kNaN;
}

Result Bouncing::s_k() const {
  std::vector<std::size_t> everyone(n_tracers_);
  std::iota(everyone.begin(), everyone.end(), std::size_t{0});
  Result r{.name = "s_k",
           .values = curve(everyone),
           .shape = {n_phases_},
           .unit = "sigma",
           .n = cycles_used(),
           .n_of = "cycles"};
  r.convention = fmt::format("height above the plate, mean over {} tracers and whole cycles; {}", n_tracers_,
                             context_.tracer_choice);
  if (broken_cycles_ > 0) r.convention += fmt::format("; {} incomplete cycles left out", broken_cycles_);
  if (cycles_used() < whole_cycles_) r.convention += "; last cycle left out to keep their number even";
  r.source = kCurveSource;
  r.no_interval = "s_b has the interval of the curve as a whole";
  return r;
}

/// s_b in one of the readings of eq. B4.
Result Bouncing::s_b(const std::string& name, SbForm form, const std::vector<double>& s_k) const {
  const double rest = context_.tracer_rest_height;
  if (n_phases_ < 2)
    return absent_result(name, "a curve s(k) needs at least 2 phases per cycle", kSpreadSource);
  if (form == SbForm::about_rest) {
    // Without velocities nothing else shows that the first frame is one of a flight. Positions scatter by
    // less.
    constexpr double kMaxDrop_sigma = 0.1;
    const double lowest = *std::min_element(s_k.begin(), s_k.end());
    if (context_.info.columns.velocity ? !std::isfinite(rest) : lowest < rest - kMaxDrop_sigma)
      return absent_result(
          name,
          std::isfinite(rest)
              ? fmt::format(
                    "the tracers are {:.4g} sigma above the plate in the first frame and {:.4g} sigma in the "
                    "mean of another phase, so that they do not lie at rest in the first",
                    rest, lowest)
              : "the height of the tracers at rest is not known, because the bed does not lie at rest in the "
                "first "
                "frame",
          kSpreadSource);
  }
  Result r{.name = name,
           .values = {s_b_of(s_k, form, rest)},
           .unit = "sigma",
           .n = cycles_used(),
           .n_of = "cycles"};
  if (!std::isfinite(r.value()))
    return absent_result(name, "the rest height of the tracers is not known", kSpreadSource);
  if (!context_.options.wants(name)) return r;
  r.interval = bootstrap_interval(
      n_tracers_,
      [&](const std::vector<std::size_t>& pick) { return s_b_of(curve(pick), form, rest_of(pick)); },
      "tracers");
  // A spread cannot be negative.
  if (r.interval) r.interval->low = std::max(0.0, r.interval->low);
  if (!r.interval)
    r.no_interval = n_tracers_ < 2 ? "one tracer only" : "the same for every choice of the tracers";
  r.convention = form == SbForm::variance ? "standard deviation of s(k) over the phases"
                 : form == SbForm::about_rest
                     ? fmt::format("rms of s(k) about the rest height {:.4f} sigma", rest)
                     : "rms of s(k), as printed";
  r.convention += fmt::format("; {} phases, {} tracers; threshold sigma/30", n_phases_, n_tracers_);
  r.source = kSpreadSource;
  return r;
}

void Bouncing::add_results(const std::string& no_cycles, std::vector<Result>& all) const {
  if (const std::string reason = why_absent(no_cycles); !reason.empty()) {
    all.push_back(absent_result("s_k", reason, kCurveSource));
    for (const char* name : {"s_b", "s_b_variance", "s_b_about_rest", "s_b_as_printed"})
      all.push_back(absent_result(name, reason, kSpreadSource));
    return;
  }
  const Result curve_of_all = s_k();
  all.push_back(curve_of_all);
  all.push_back(s_b("s_b", context_.options.s_b, curve_of_all.values));
  all.push_back(s_b("s_b_variance", SbForm::variance, curve_of_all.values));
  all.push_back(s_b("s_b_about_rest", SbForm::about_rest, curve_of_all.values));
  all.push_back(s_b("s_b_as_printed", SbForm::as_printed, curve_of_all.values));
}

}  // namespace twincell::analysis
