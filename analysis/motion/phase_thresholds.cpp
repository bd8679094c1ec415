#include "analysis/motion/phase_thresholds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/motion/tracer_line.hpp"
#include "core/constants.hpp"
#include "core/counted.hpp"
#include "trajectory/plate.hpp"

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{"s_k"},
                                    {.name = "s_b", .pooling = Pooling::root_mean_square, .main = true},
                                    {"s_b_variance", Pooling::root_mean_square},
                                    {"s_b_about_rest", Pooling::root_mean_square},
                                    {"s_b_as_printed", Pooling::root_mean_square},
                                    {"half_pixel", Pooling::mean, true},
                                    {"s_b_noise"},
                                    {"s_j_noise"},
                                    {"s_j", Pooling::root_mean_square},
                                    {.name = "s_c", .pooling = Pooling::root_mean_square, .main = true},
                                    {"cycle_of_convection"},
                                    {"s_j_growth"},
                                    {"s_j_growth_late"},
                                    {"drift"},
                                    {"phase"},
                                    {"tracers", Pooling::per_bead},
                                    {"tracer_heights", Pooling::per_bead}};

constexpr double kJump = 0.5;  ///< sigma; larger changes of a height within one cycle are reported as jumps

/// Sums of the tracers' heights above the plate for each (tracer, phase).
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
        line_{.n_tracers = n_tracers_} {}

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
    add_noise(frame);
    if (frame.phase == 0) add_cycle_start(frame);
  }

  [[nodiscard]] std::vector<Result> results() const override {
    PhaseThresholds closed =
        *this;  // a copy: the last cycle may be whole, and closing it must not disturb the accumulation
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
    std::size_t seen = 0;
    for (std::size_t t = 0; t < n_tracers_; ++t) {
      const double now = has(frame, t) ? height(frame, t) : kNaN;
      seen += std::isfinite(now) ? 1 : 0;
      if (line_.n() > 0 && std::abs(now - line_.at(line_.n() - 1, t)) > kJump) ++jumps_;
      line_.height.push_back(now);
    }
    if (seen < n_tracers_) ++incomplete_starts_;
    line_.cycle.push_back(frame.cycle);
  }

  void add_noise(const Frame& frame) {
    if (frame.position_sigma.empty()) return;
    for (std::size_t t = 0; t < n_tracers_; ++t) {
      const double u = frame.position_sigma[context_.tracers[t]].z();
      if (!has(frame, t) || !std::isfinite(u)) continue;
      noise_squares_ += u * u;
      ++noise_count_;
    }
  }
  /// Standard uncertainty of one height, rms over tracers and frames; NaN if unknown.
  [[nodiscard]] double noise() const {
    return noise_count_ > 0 ? std::sqrt(noise_squares_ / static_cast<double>(noise_count_)) : kNaN;
  }

  /// Adds a whole cycle to the current pair, and a complete pair to the total, so that the total contains an
  /// even number of cycles.
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

  /// s(k) of a resample of the tracers. Each tracer is averaged at each phase first, so that a tracer that is
  /// missing in some cycles does not shift the curve.
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

  /// Mean rest height of a resample of the tracers. A different set of tracers rests at a different height,
  /// so that the rest height is resampled with the curve. NaN if no tracer has a rest height.
  [[nodiscard]] double rest_of(const std::vector<std::size_t>& tracers) const {
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

  [[nodiscard]] std::vector<Result> closed_results() const {
    std::vector<Result> all;
    add_bounce(all);
    add_detection(all);
    add_convection(all);
    add_drift(all);
    add_phase(all);
    add_line(all);
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
      for (const char* name : {"s_b", "s_b_variance", "s_b_about_rest", "s_b_as_printed"})
        all.push_back(absent_result(name, reason, b4));
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

    s_k.no_interval = "s_b has the interval of the curve as a whole";
    const std::vector<double> curve_of_all = s_k.values;
    all.push_back(std::move(s_k));
    // s_b in each of the readings of eq. B4.
    const auto s_b = [&](const std::string& name, SbForm form) {
      const double rest = context_.tracer_rest_height;
      if (n_phases_ < 2) return absent_result(name, "a curve s(k) needs at least 2 phases per cycle", b4);
      Result r{.name = name,
               .values = {s_b_of(curve_of_all, form, rest)},
               .unit = "sigma",
               .n = used,
               .n_of = "cycles"};
      if (!std::isfinite(r.value()))
        return absent_result(name, "the rest height of the tracers is not known", b4);
      if (!context_.options.wants(name)) return r;
      r.interval = bootstrap_interval(
          n_tracers_,
          [&](const std::vector<std::size_t>& pick) {
            return s_b_of(curve(sums, pick), form, rest_of(pick));
          },
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
      r.source = b4;
      return r;
    };
    all.push_back(s_b("s_b", context_.options.s_b));
    all.push_back(s_b("s_b_variance", SbForm::variance));
    all.push_back(s_b("s_b_about_rest", SbForm::about_rest));
    all.push_back(s_b("s_b_as_printed", SbForm::as_printed));
  }

  /// Detection limits of the camera, for comparison with the threshold sigma/30.
  void add_detection(std::vector<Result>& all) const {
    const std::string source = "Fortini & Huang 2015, app. B";
    const auto against_threshold = [](double limit) {
      return fmt::format("{} sigma/30 = {:.4f}", limit <= kBouncingThreshold ? "below" : "above",
                         kBouncingThreshold);
    };
    if (const auto scale = context_.info.scale.pixels_per_sigma) {
      Result r{.name = "half_pixel", .values = {0.5 / *scale}, .unit = "sigma", .n = 1, .n_of = "scale"};
      r.convention =
          fmt::format("half a pixel at {:.4g} pixels per sigma; {}", *scale, against_threshold(r.value()));
      r.no_interval = "the scale is taken as given";
      r.source = source;
      all.push_back(std::move(r));
    } else {
      all.push_back(
          absent_result("half_pixel", "the trajectory has no pixels per sigma: it was not filmed", source));
    }
    const std::size_t used = std::max<std::size_t>(1, whole_cycles_ - whole_cycles_ % 2);
    if (!std::isfinite(noise())) {
      for (const char* name : {"s_b_noise", "s_j_noise"})
        all.push_back(absent_result(name, "the trajectory has no uncertainties of positions", source));
      return;
    }
    const double floor = noise() / std::sqrt(static_cast<double>(n_tracers_ * used));
    const auto noise_result = [&](const std::string& name, double value, const std::string& how) {
      Result r{.name = name, .values = {value}, .unit = "sigma", .n = noise_count_, .n_of = "heights"};
      r.convention = how + fmt::format("; one height is uncertain by {:.4g} sigma (rms)", noise());
      r.no_interval = "from the position uncertainties given by the locator";
      r.source = source;
      all.push_back(std::move(r));
    };
    noise_result(
        "s_b_noise", floor,
        fmt::format("s_b of a bed at rest from the camera's noise alone, sigma_z/sqrt(N_t N_f) with {} "
                    "tracers and {}; {}",
                    n_tracers_, counted(used, "cycle"), against_threshold(floor)));
    noise_result("s_j_noise", noise(), "contribution of the noise alone to s_j, added in quadrature");
  }

  void add_convection(std::vector<Result>& all) const {
    const std::string b1 = "Fortini & Huang 2015, eq. B1", b2 = "Fortini & Huang 2015, eq. B2";
    std::string reason = why_no_cycles();
    if (reason.empty() && n_tracers_ < 2) reason = "a spread of heights needs at least 2 tracers";
    if (reason.empty() && line_.n() == 0) reason = "no frame is at the beginning of a cycle";
    std::vector<std::size_t> everyone(n_tracers_);
    std::iota(everyone.begin(), everyone.end(), std::size_t{0});
    std::vector<double> spread;
    SeriesAverage squares;
    for (std::size_t j = 0; j < line_.n(); ++j) {
      const double squared = spread_squared(line_, j, everyone);
      spread.push_back(std::sqrt(squared));
      if (std::isfinite(squared)) squares.add(squared);
    }
    if (reason.empty() && squares.n() == 0)
      reason = "fewer than 80 % of the tracers are present at the beginning of every cycle";
    if (!reason.empty()) {
      all.push_back(absent_result("s_j", reason, b1));
      all.push_back(absent_result("s_c", reason, b2));
      all.push_back(absent_result("cycle_of_convection", reason, b1));
      return;
    }
    Result s_j{.name = "s_j",
               .values = spread,
               .shape = {spread.size()},
               .unit = "sigma",
               .n = squares.n(),
               .n_of = "cycles"};
    s_j.convention =
        fmt::format("spread of {} tracers about their mean at the beginning of each cycle, from cycle {}; {}",
                    n_tracers_, line_.cycle.front(), context_.tracer_choice);
    if (incomplete_starts_ > 0)
      s_j.convention += "; some tracers missing in " + counted(incomplete_starts_, "cycle");
    if (jumps_ > 0)
      s_j.convention += fmt::format("; {} jumps of a tracer by more than sigma/2 within one cycle", jumps_);
    s_j.no_interval = "single cycles; s_c has the interval of their mean square";
    s_j.source = b1;

    // s_c, the root mean square of s_j.
    Result s_c{.name = "s_c",
               .values = {std::sqrt(squares.mean())},
               .unit = "sigma",
               .n = squares.n(),
               .n_of = "cycles"};
    s_c.interval = interval_of_s_c(squares);
    if (!s_c.interval) s_c.no_interval = squares.why_no_interval("cycles");
    s_c.convention =
        fmt::format("root mean square of s_j over N_f = {} cycles; threshold sigma", squares.n());
    s_c.source = b2;

    // The first cycle that exceeds the threshold of convection.
    const auto first =
        std::find_if(spread.begin(), spread.end(), [](double s) { return s > kConvectionThreshold; });
    all.push_back(std::move(s_j));
    all.push_back(std::move(s_c));
    if (first == spread.end()) {
      all.push_back(absent_result("cycle_of_convection",
                                  "s_j does not exceed sigma in " + counted(spread.size(), "cycle"), b1));
      return;
    }
    Result onset{.name = "cycle_of_convection", .unit = "cycles", .n = squares.n(), .n_of = "cycles"};
    onset.values = {static_cast<double>(line_.cycle[static_cast<std::size_t>(first - spread.begin())])};
    onset.convention = "first cycle at whose beginning s_j > sigma";
    onset.no_interval = "a single event in one run; runs with other seeds give its scatter";
    onset.source = b1;
    all.push_back(std::move(onset));
  }

  /// Interval of s_c as a correlated series over cycles if s_j is stationary. The motion of a line that
  /// drifts or comes to rest is a single event, not a stationary series; the interval is then from the
  /// scatter between tracers.
  [[nodiscard]] std::optional<Interval> interval_of_s_c(const SeriesAverage& squares) const {
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

  void add_drift(std::vector<Result>& all) const {
    const std::string source = "Fortini & Huang 2015, eq. B1";
    const Result& s_j = find_result(all, "s_j");
    if (!s_j.present()) {
      for (const char* name : {"s_j_growth", "s_j_growth_late", "drift"})
        all.push_back(absent_result(name, s_j.absent, source));
      return;
    }
    const auto slope = [&](const std::string& name, const Growth& line, std::size_t first) {
      if (!std::isfinite(line.rate)) return absent_result(name, "a slope needs at least 2 cycles", source);
      Result r{
          .name = name, .values = {line.rate}, .unit = "sigma^2", .n = line_.n() - first, .n_of = "cycles"};
      r.interval = line.interval;
      if (!r.interval) r.no_interval = "fewer than 3 tracers, or the same slope for all tracers";
      r.convention = fmt::format("d s_j^2/dj by least squares, cycles {} to {}; per cycle",
                                 line_.cycle[first], line_.cycle.back());
      r.source = source;
      return r;
    };
    const double last = s_j.values.back();  // copied: additions to `all` below invalidate the reference
    const DriftVerdict verdict = judge_drift(line_, std::isfinite(noise()) ? noise() : 0);
    all.push_back(slope("s_j_growth", growth(line_, 0, line_.n()), 0));
    if (verdict.drift == Drift::undetermined) {
      all.push_back(absent_result("s_j_growth_late", verdict.reason, source));
      all.push_back(absent_result("drift", verdict.reason, source));
      return;
    }
    all.push_back(slope("s_j_growth_late", verdict.late, line_.n() / 2));
    Result word{.name = "drift", .text = drift_name(verdict.drift), .n = line_.n(), .n_of = "cycles"};
    word.convention = verdict.reason + fmt::format("; s_j ends at {:.3g} sigma", last);
    word.source = source;
    all.push_back(std::move(word));
  }

  void add_line(std::vector<Result>& all) const {
    const std::string source = "Fortini & Huang 2015, eq. B1";
    if (n_tracers_ == 0) {
      all.push_back(absent_result("tracers", context_.no_tracers, source));
      all.push_back(absent_result("tracer_heights", context_.no_tracers, source));
      return;
    }
    Result tracers{.name = "tracers",
                   .values = {context_.tracers.begin(), context_.tracers.end()},
                   .shape = {n_tracers_},
                   .unit = "id",
                   .n = n_tracers_,
                   .n_of = "tracers"};
    tracers.convention = context_.tracer_choice;
    tracers.source = source;
    all.push_back(std::move(tracers));
    if (line_.n() == 0) {
      const std::string none = why_no_cycles();
      all.push_back(absent_result("tracer_heights",
                                  none.empty() ? "no frame is at the beginning of a cycle" : none, source));
      return;
    }
    Result heights{.name = "tracer_heights",
                   .values = line_.height,
                   .shape = {line_.n(), n_tracers_},
                   .unit = "sigma",
                   .n = line_.n(),
                   .n_of = "cycles"};
    heights.convention = fmt::format("height of each tracer at the beginning of each cycle, from cycle {}",
                                     line_.cycle.front());
    heights.source = source;
    all.push_back(std::move(heights));
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
    r.convention = row_of(kBedPhases, phase).help;
    if (phase == BedPhase::convecting && find_result(all, "drift").text == drift_name(Drift::annealed))
      r.convention += "; but annealed: s_c shows the first rearrangement, not steady convection";
    r.source = source;
    all.push_back(std::move(r));
  }

  const AnalysisContext& context_;
  std::size_t n_tracers_;
  std::size_t n_phases_;
  HeightSums total_;  ///< an even number of whole cycles
  HeightSums pair_;   ///< the whole cycles after those
  HeightSums cycle_;  ///< the current cycle
  std::vector<char> phase_seen_;
  std::int64_t current_cycle_ = -1;
  std::size_t whole_cycles_ = 0;
  std::size_t broken_cycles_ = 0;
  bool no_plate_ = false;
  TracerLine line_;
  double noise_squares_ = 0;
  std::size_t noise_count_ = 0;
  std::size_t incomplete_starts_ = 0;
  std::size_t jumps_ = 0;
};

}  // namespace

std::string phase_name(BedPhase phase) {
  return std::string(row_of(kBedPhases, phase).word);
}

std::string onset_name(BedPhase phase) {
  return phase == BedPhase::convecting ? "convection" : phase_name(phase);
}

BedPhase phase_named(const std::string& name) {
  const auto row =
      std::find_if(kBedPhases.begin(), kBedPhases.end(), [&](const auto& r) { return r.word == name; });
  return row == kBedPhases.end() ? BedPhase::undetermined : row->value;
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

constinit const ObservableEntry phase_thresholds_observable = {kResults, &make_observable<PhaseThresholds>};

}  // namespace twincell::analysis
