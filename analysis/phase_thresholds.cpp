#include "analysis/phase_thresholds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "analysis/tracers.hpp"

namespace twincell {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kEnoughTracers = 0.8;
constexpr double kJump = 0.5;

/// Sums of tracer heights over the plate for each (tracer, phase).
struct HeightSums {
  std::vector<double> sum;
  std::vector<std::size_t> count;

  explicit HeightSums(std::size_t size = 0) : sum(size, 0.0), count(size, 0) {}
  void add(const HeightSums& other) {
    for (std::size_t e = 0; e < sum.size(); ++e) {
      sum[e] += other.sum[e];
      count[e] += other.count[e];
    }
  }
};

class PhaseThresholds : public Observable {
 public:
  explicit PhaseThresholds(const AnalysisContext& context)
      : context_(context),
        n_tracers_(context.tracers.size()),
        n_phases_(static_cast<std::size_t>(std::max(0, context.info.phases_per_cycle))),
        total_(n_tracers_ * n_phases_),
        pair_(n_tracers_ * n_phases_),
        cycle_(n_tracers_ * n_phases_),
        phase_seen_(n_phases_, 0),
        previous_start_(n_tracers_, kNaN) {}

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    if (frame.phase < 0 || frame.cycle < 0 || static_cast<std::size_t>(frame.phase) >= n_phases_ ||
        n_tracers_ == 0)
      return;
    if (frame.cycle != current_cycle_) {
      close_cycle();
      current_cycle_ = frame.cycle;
    }
    add_heights(frame);
    if (frame.phase == 0) add_cycle_start(frame);
  }

  [[nodiscard]] std::vector<Result> results() const override {
    PhaseThresholds closed =
        *this;  // the last cycle may be whole: closing it must not disturb the accumulation
    closed.close_cycle();
    return closed.closed_results();
  }

 private:
  void add_heights(const Frame& frame) {
    const auto plate = plate_height(context_.info, frame);
    if (!plate) {
      no_plate_ = true;
      return;
    }
    if (!enough(frame)) return;
    const auto k = static_cast<std::size_t>(frame.phase);
    phase_seen_[k] = 1;
    for (std::size_t t = 0; t < n_tracers_; ++t)
      if (has(frame, t)) {
        cycle_.sum[t * n_phases_ + k] += height(frame, t) - *plate;
        ++cycle_.count[t * n_phases_ + k];
      }
  }

  void add_cycle_start(const Frame& frame) {
    std::vector<double> z;
    for (std::size_t t = 0; t < n_tracers_; ++t) {
      const double now = has(frame, t) ? height(frame, t) : kNaN;
      if (std::isfinite(now)) z.push_back(now);
      if (std::abs(now - previous_start_[t]) > kJump) ++jumps_;
      previous_start_[t] = now;
    }
    if (z.size() < n_tracers_) ++incomplete_starts_;
    const bool counts = z.size() >= 2 && enough(frame);
    double variance = kNaN;
    if (counts) {
      const double mean = std::accumulate(z.begin(), z.end(), 0.0) / static_cast<double>(z.size());
      variance = 0;
      for (const double height : z) variance += (height - mean) * (height - mean);
      variance /= static_cast<double>(z.size());
      s_j2_.add(variance);
    }
    s_j_.push_back(std::sqrt(variance));
    s_j_cycle_.push_back(frame.cycle);
  }

  /// A whole cycle joins its partner; a pair joins the total.
  void close_cycle() {
    const bool whole = !phase_seen_.empty() && std::all_of(phase_seen_.begin(), phase_seen_.end(),
                                                           [](char seen) { return seen != 0; });
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

  [[nodiscard]] bool has(const Frame& frame, std::size_t tracer) const {
    const std::size_t slot = context_.tracers[tracer];
    return frame.present(slot) && std::isfinite(frame.position[slot].z());
  }
  [[nodiscard]] double height(const Frame& frame, std::size_t tracer) const {
    return frame.position[context_.tracers[tracer]].z();
  }
  [[nodiscard]] bool enough(const Frame& frame) const {
    std::size_t present = 0;
    for (std::size_t t = 0; t < n_tracers_; ++t) present += has(frame, t) ? 1 : 0;
    return static_cast<double>(present) >= kEnoughTracers * static_cast<double>(n_tracers_);
  }

  [[nodiscard]] std::string why_no_cycles() const {
    if (n_phases_ == 0) return "the frames are not locked to the drive's phase";
    if (n_tracers_ == 0) return context_.no_tracers;
    return "";
  }

  /// s(k) of a resample of the tracers: each tracer's own mean at that phase first, so that a tracer that is
  /// missing now and then does not shift the curve.
  [[nodiscard]] std::vector<double> curve(const HeightSums& sums,
                                          const std::vector<std::size_t>& tracers) const {
    std::vector<double> s(n_phases_, kNaN);
    for (std::size_t k = 0; k < n_phases_; ++k) {
      double sum = 0;
      std::size_t n = 0;
      for (const std::size_t t : tracers) {
        const std::size_t e = t * n_phases_ + k;
        if (sums.count[e] == 0) continue;
        sum += sums.sum[e] / static_cast<double>(sums.count[e]);
        ++n;
      }
      if (n > 0) s[k] = sum / static_cast<double>(n);
    }
    return s;
  }

  [[nodiscard]] std::vector<Result> closed_results() const {
    std::vector<Result> all;
    add_bounce(all);
    add_convection(all);
    add_phase(all);
    return all;
  }

  void add_bounce(std::vector<Result>& all) const {
    const std::string b3 = "Fortini & Huang 2015, eq. B3", b4 = "Fortini & Huang 2015, eq. B4";
    std::string reason = why_no_cycles();
    const std::size_t used = whole_cycles_ < 2 ? whole_cycles_ : whole_cycles_ - whole_cycles_ % 2;
    if (reason.empty() && no_plate_)
      reason = "the plate's height is not known: neither recorded nor given by a drive";
    if (reason.empty() && used == 0)
      reason = fmt::format("no cycle has all {} phases with at least 80 % of the tracers", n_phases_);
    if (!reason.empty()) {
      all.push_back(absent_result("s_k", reason, b3));
      all.push_back(absent_result("s_b", reason, b4));
      return;
    }
    const HeightSums& sums = whole_cycles_ < 2 ? pair_ : total_;
    std::vector<std::size_t> everyone(n_tracers_);
    std::iota(everyone.begin(), everyone.end(), std::size_t{0});

    Result s_k{.name = "s_k",
               .values = curve(sums, everyone),
               .shape = {n_phases_},
               .unit = "sigma",
               .n = used,
               .n_of = "cycles"};
    s_k.convention = fmt::format("height above the plate, mean over {} tracers and whole cycles; {}",
                                 n_tracers_, context_.tracer_choice);
    if (broken_cycles_ > 0) s_k.convention += fmt::format("; {} incomplete cycles left out", broken_cycles_);
    if (used < whole_cycles_) s_k.convention += "; last cycle left out to keep their number even";
    s_k.source = b3;

    const SbForm form = context_.options.s_b;
    const double rest = context_.tracer_rest_height;
    const double value = n_phases_ < 2 ? kNaN : s_b_of(s_k.values, form, rest);
    if (n_phases_ < 2)
      reason = "a curve s(k) needs at least 2 phases per cycle";
    else if (!std::isfinite(value))
      reason = "the rest height of the tracers is not known";
    if (reason.empty()) {
      Result s_b{.name = "s_b", .values = {value}, .unit = "sigma", .n = used, .n_of = "cycles"};
      s_b.interval = bootstrap_interval(
          n_tracers_,
          [&](const std::vector<std::size_t>& pick) { return s_b_of(curve(sums, pick), form, rest); },
          "tracers");
      s_b.convention = form == SbForm::variance ? "variance of s(k) over the phases"
                       : form == SbForm::about_rest
                           ? fmt::format("mean square of s(k) about the rest height {:.4f} sigma", rest)
                           : "mean square of s(k), as printed";
      s_b.convention += fmt::format("; {} phases, {} tracers; threshold sigma/30", n_phases_, n_tracers_);
      s_b.source = b4;
      all.push_back(std::move(s_k));
      all.push_back(std::move(s_b));
    } else {
      all.push_back(std::move(s_k));
      all.push_back(absent_result("s_b", reason, b4));
    }
  }

  void add_convection(std::vector<Result>& all) const {
    const std::string b1 = "Fortini & Huang 2015, eq. B1", b2 = "Fortini & Huang 2015, eq. B2";
    std::string reason = why_no_cycles();
    if (reason.empty() && n_tracers_ < 2) reason = "a spread of heights needs at least 2 tracers";
    if (reason.empty() && s_j_.empty()) reason = "no frame lies at the beginning of a cycle";
    if (reason.empty() && s_j2_.n() == 0)
      reason = "fewer than 80 % of the tracers are present at the beginning of every cycle";
    if (!reason.empty()) {
      all.push_back(absent_result("s_j", reason, b1));
      all.push_back(absent_result("s_c", reason, b2));
      all.push_back(absent_result("cycle_of_convection", reason, b1));
      return;
    }
    Result s_j{.name = "s_j",
               .values = s_j_,
               .shape = {s_j_.size()},
               .unit = "sigma",
               .n = s_j2_.n(),
               .n_of = "cycles"};
    s_j.convention =
        fmt::format("spread of {} tracers about their mean at the beginning of each cycle, from cycle {}; {}",
                    n_tracers_, s_j_cycle_.front(), context_.tracer_choice);
    if (incomplete_starts_ > 0)
      s_j.convention += fmt::format("; some tracers missing in {} cycles", incomplete_starts_);
    if (jumps_ > 0)
      s_j.convention += fmt::format("; {} jumps of a tracer by more than sigma/2 within one cycle", jumps_);
    s_j.source = b1;

    Result s_c{.name = "s_c",
               .values = {std::sqrt(s_j2_.mean())},
               .unit = "sigma",
               .n = s_j2_.n(),
               .n_of = "cycles"};
    if (auto squared = s_j2_.interval("cycles")) {
      squared->low = std::sqrt(std::max(0.0, squared->low));
      squared->high = std::sqrt(squared->high);
      s_c.interval = squared;
    }
    s_c.convention = fmt::format("root mean square of s_j over N_f = {} cycles; threshold sigma", s_j2_.n());
    s_c.source = b2;

    const auto first =
        std::find_if(s_j_.begin(), s_j_.end(), [](double s) { return s > kConvectionThreshold; });
    all.push_back(std::move(s_j));
    all.push_back(std::move(s_c));
    if (first == s_j_.end()) {
      all.push_back(absent_result("cycle_of_convection",
                                  fmt::format("s_j does not exceed sigma in {} cycles", s_j_.size()), b1));
      return;
    }
    Result onset{.name = "cycle_of_convection", .unit = "cycles", .n = s_j2_.n(), .n_of = "cycles"};
    onset.values = {static_cast<double>(s_j_cycle_[static_cast<std::size_t>(first - s_j_.begin())])};
    onset.convention = "first cycle at whose beginning s_j > sigma";
    onset.source = b1;
    all.push_back(std::move(onset));
  }

  static void add_phase(std::vector<Result>& all) {
    const Result& s_b = find_result(all, "s_b");
    const Result& s_c = find_result(all, "s_c");
    const BedPhase phase = bed_phase(s_b.value(), s_c.value());
    const std::string source = "Fortini & Huang 2015, app. B";
    if (phase == BedPhase::undetermined) {
      all.push_back(
          absent_result("phase", s_b.present() ? "s_c: " + s_c.absent : "s_b: " + s_b.absent, source));
      return;
    }
    Result r{.name = "phase", .text = phase_name(phase), .n = s_b.n, .n_of = s_b.n_of};
    r.convention = "s_b > sigma/30: leaves the plate; and s_c > sigma: convects";
    r.source = source;
    all.push_back(std::move(r));
  }

  const AnalysisContext& context_;
  std::size_t n_tracers_;
  std::size_t n_phases_;
  HeightSums total_;  ///< whole cycles, an even number
  HeightSums pair_;   ///< whole cycles since then
  HeightSums cycle_;  ///< the cycle being read
  std::vector<char> phase_seen_;
  std::int64_t current_cycle_ = -1;
  std::size_t whole_cycles_ = 0;
  std::size_t broken_cycles_ = 0;
  bool no_plate_ = false;
  std::vector<double> previous_start_;
  std::vector<double> s_j_;
  std::vector<std::int64_t> s_j_cycle_;
  BlockAverage s_j2_;
  std::size_t incomplete_starts_ = 0;
  std::size_t jumps_ = 0;
};

}  // namespace

std::string phase_name(BedPhase phase) {
  switch (phase) {
    case BedPhase::co_moving:
      return "co-moving";
    case BedPhase::bouncing:
      return "bouncing";
    case BedPhase::convecting:
      return "convecting";
    case BedPhase::undetermined:
      break;
  }
  return "undetermined";
}

BedPhase phase_named(const std::string& name) {
  for (const BedPhase phase : {BedPhase::co_moving, BedPhase::bouncing, BedPhase::convecting})
    if (name == phase_name(phase)) return phase;
  return BedPhase::undetermined;
}

BedPhase bed_phase(double s_b, double s_c) {
  if (std::isnan(s_b)) return BedPhase::undetermined;
  if (s_b <= kBouncingThreshold) return BedPhase::co_moving;
  if (std::isnan(s_c)) return BedPhase::undetermined;
  return s_c <= kConvectionThreshold ? BedPhase::bouncing : BedPhase::convecting;
}

double s_b_of(const std::vector<double>& s_k, SbForm form, double rest_height) {
  const double n = static_cast<double>(s_k.size());
  double reference = 0;
  if (form == SbForm::variance) reference = std::accumulate(s_k.begin(), s_k.end(), 0.0) / n;
  if (form == SbForm::about_rest) reference = rest_height;
  double sum = 0;
  for (const double s : s_k) sum += (s - reference) * (s - reference);
  return std::sqrt(sum / n);
}

std::unique_ptr<Observable> make_phase_thresholds(const AnalysisContext& context) {
  return std::make_unique<PhaseThresholds>(context);
}

}  // namespace twincell
