#include "analysis/motion/phase_thresholds.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "analysis/motion/bed_phase.hpp"
#include "analysis/motion/bouncing_measure.hpp"
#include "analysis/motion/convection_measure.hpp"
#include "analysis/motion/detection_limit.hpp"
#include "analysis/motion/tracer_line.hpp"
#include "core/constants.hpp"

namespace twincell::analysis {
namespace {

constexpr double kRmsOfSine = 1 / std::numbers::sqrt2;

constexpr NamedResult kResults[] = {
    {"s_k"},
    {.name = "s_b",
     .pooling = Pooling::root_mean_square,
     .range = Range::not_negative,
     .main = true,
     .above_plate = kRmsOfSine},
    {.name = "s_b_variance", .pooling = Pooling::root_mean_square, .above_plate = kRmsOfSine},
    // The height at rest is that of one frame, which the plate's error shifts as much as any other.
    {.name = "s_b_about_rest", .pooling = Pooling::root_mean_square, .above_plate = 1},
    {.name = "s_b_as_printed", .pooling = Pooling::root_mean_square, .above_plate = kRmsOfSine},
    {.name = "half_pixel", .range = Range::not_negative, .may_repeat = true},
    {"s_b_noise"},
    {"s_j_noise"},
    {"s_j", Pooling::root_mean_square},
    {.name = "s_c", .pooling = Pooling::root_mean_square, .range = Range::not_negative, .main = true},
    {"cycle_of_convection"},
    {"s_j_growth"},
    {"s_j_growth_late"},
    {"drift"},
    {"phase"},
    {"tracers", Pooling::per_bead},
    {"tracer_heights", Pooling::per_bead}};

/// The phase by s_b and s_c, which are in `all`.
Result phase_result(const std::vector<Result>& all) {
  const Result& s_b = find_result(all, "s_b");
  const Result& s_c = find_result(all, "s_c");
  const BedPhase phase = bed_phase(s_b.value(), s_c.value());
  const std::string source = "Fortini & Huang 2015, app. B";
  if (phase == BedPhase::undetermined)
    return absent_result("phase", s_b.present() ? "s_c: " + s_c.absent : "s_b: " + s_b.absent, source);
  Result r{.name = "phase", .text = phase_name(phase), .n = s_b.n, .n_of = s_b.n_of};
  r.convention = row_of(kBedPhases, phase).help;
  if (phase == BedPhase::convecting && find_result(all, "drift").text == drift_name(Drift::annealed))
    r.convention += "; but annealed: s_c shows the first rearrangement, not steady convection";
  r.source = source;
  return r;
}

class PhaseThresholds : public Observable {
 public:
  explicit PhaseThresholds(const AnalysisContext& context)
      : context_(context), bouncing_(context), spread_(context), limit_(context) {}

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    if (frame.phase < 0 || frame.cycle < 0 || frame.phase >= context_.info.phases_per_cycle ||
        context_.tracers.empty())
      return;
    const std::vector<double> heights = tracer_heights(frame);
    bouncing_.add(frame, heights);
    limit_.add(frame, heights);
    if (frame.phase == 0) spread_.add(frame, heights);
  }

  [[nodiscard]] std::vector<Result> results() const override {
    // A copy: the last cycle may be whole, and closing it must not disturb the accumulation.
    Bouncing closed = bouncing_;
    closed.close_cycle();
    const std::string no_cycles = why_no_cycles();
    std::vector<Result> all;
    closed.add_results(no_cycles, all);
    limit_.add_results(closed.cycles_used(), all);
    spread_.add_spread(no_cycles, all);
    spread_.add_drift(limit_.noise(), all);
    all.push_back(phase_result(all));
    spread_.add_line(no_cycles, all);
    return all;
  }

 private:
  /// [tracers] heights in a frame; NaN where a tracer is missing.
  [[nodiscard]] std::vector<double> tracer_heights(const Frame& frame) const {
    std::vector<double> heights;
    heights.reserve(context_.tracers.size());
    for (const std::size_t slot : context_.tracers) {
      const double z = frame.present(slot) ? frame.position[slot].z() : kNaN;
      heights.push_back(std::isfinite(z) ? z : kNaN);
    }
    return heights;
  }

  [[nodiscard]] std::string why_no_cycles() const {
    if (context_.info.phases_per_cycle <= 0) return "the frames are not locked to the drive's phase";
    if (context_.info.box.periodic(Axis::z)) return "the cell is periodic along z: it has no plate";
    if (context_.tracers.empty()) return context_.no_tracers;
    return "";
  }

  const AnalysisContext& context_;
  Bouncing bouncing_;
  TracerSpread spread_;
  DetectionLimit limit_;
};

}  // namespace

constinit const ObservableEntry phase_thresholds_observable = {
    kResults, &make_observable<PhaseThresholds>, {"tracers", "s_b"}};

}  // namespace twincell::analysis
