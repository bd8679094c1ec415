#include "analysis/motion/centre_of_mass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "trajectory/plate.hpp"

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{.name = "h_cm", .main = true},
                                    {"h_cm_k"},
                                    {"h_cm_j"},
                                    {.name = "delta_h_cm", .main = true},
                                    {.name = "delta_h_bar", .over_peak_velocity = 2}};

const char* const kSource = "Bhateja, Sharma & Singh 2016, Table II and Fig. 7";

class CentreOfMass : public Observable {
 public:
  explicit CentreOfMass(const AnalysisContext& context)
      : info_(context.info),
        context_(context),
        phases_(context.info.columns.phase ? static_cast<std::size_t>(context.info.phases_per_cycle) : 0),
        by_phase_(phases_) {}

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    const double height = centre_of_mass_height(frame, info_.mass);
    if (!std::isfinite(height) || info_.box.periodic(Axis::z)) return;
    if (phases_ == 0) {
      mean_.add(height);
      return;
    }
    if (frame.phase < 0 || static_cast<std::size_t>(frame.phase) >= phases_) return;
    by_phase_[static_cast<std::size_t>(frame.phase)].add(height);
    if (frame.cycle != cycle_) {
      cycle_ = frame.cycle;
      sum_ = 0;
      count_ = 0;
    }
    sum_ += height;
    // Only whole cycles count: an incomplete cycle would give more weight to the phases that it contains.
    if (++count_ == phases_) {
      by_cycle_.push_back(sum_ / static_cast<double>(phases_));
      mean_.add(by_cycle_.back());
    }
  }

  [[nodiscard]] std::vector<Result> results() const override {
    const char* of = phases_ > 0 ? "cycles" : "frames";
    const std::string none = info_.box.periodic(Axis::z) ? "the cell is periodic along z: it has no plate"
                             : phases_ > 0               ? "no whole cycle"
                                                         : "no frame holds a bead";
    const std::string rule =
        fmt::format("mean over {} of the height of the centre of mass above the plate's mean",
                    phases_ > 0 ? "whole cycles" : "frames");
    const Result h = mean_of(
        mean_, {.name = "h_cm", .unit = "sigma", .n_of = of, .convention = rule, .source = kSource}, none);
    std::vector<double> phases;
    for (const SeriesAverage& phase : by_phase_) phases.push_back(phase.mean());
    const std::string no_phase = phases_ > 0 ? none : "the frames have no phase";
    return {h,
            array_of(phases,
                     {.name = "h_cm_k",
                      .unit = "sigma",
                      .n_of = "phases",
                      .convention = "height of the centre of mass at each phase, mean over cycles",
                      .source = kSource},
                     no_phase),
            array_of(by_cycle_,
                     {.name = "h_cm_j",
                      .unit = "sigma",
                      .n_of = "cycles",
                      .convention = "height of the centre of mass, mean of each whole cycle",
                      .source = kSource},
                     no_phase),
            lift("delta_h_cm", h, "sigma", 1), lift("delta_h_bar", h, "1", velocity_scale())};
  }

 private:
  /// V_p^2/g in sigma; NaN if the drive is unknown or at rest.
  [[nodiscard]] double velocity_scale() const {
    if (!info_.drive || info_.drive->ramp || info_.drive->peak_velocity() == 0)
      return std::numeric_limits<double>::quiet_NaN();
    return info_.drive->peak_velocity() * info_.drive->peak_velocity() / info_.drive->gravity;
  }

  [[nodiscard]] Result lift(const std::string& name, const Result& h, const std::string& unit,
                            double scale) const {
    if (!h.present()) return absent_result(name, h.absent, kSource);
    if (!context_.rest_height)
      return absent_result(name, "the rest height is neither given nor measured: " + context_.no_rest_height,
                           kSource);
    const double rest = *context_.rest_height;
    // Shaking compacts a loose bed by a tenth at most; a state far below the height at rest does not exist.
    constexpr double kMinHeightRatio = 0.8;
    if (h.value() < kMinHeightRatio * rest)
      return absent_result(
          name,
          fmt::format("the rest height, {:.6g} sigma, is {:.3g} times the mean height during the "
                      "run, {:.4g} sigma; a bed at rest lies no higher: is it in sigma, and of "
                      "this bed?",
                      rest, rest / h.value(), h.value()),
          kSource);
    if (std::isnan(scale))
      return absent_result(name,
                           info_.drive && info_.drive->ramp ? "the drive changes during the run (drive.ramp)"
                                                            : "the trajectory does not state its drive",
                           kSource);
    Result r = h;
    r.name = name;
    r.unit = unit;
    r.values = {(h.value() - rest) / scale};
    if (r.interval) {
      r.interval->low = (r.interval->low - rest) / scale;
      r.interval->high = (r.interval->high - rest) / scale;
    }
    r.convention = fmt::format(
        "h_cm above its rest height, {:.6g} sigma ({}){}; {}", rest,
        context_.options.rest_height ? context_.options.rest_height_is : "of the first frame, at rest",
        scale == 1 && unit != "1" ? "" : ", divided by V_p^2/g", h.convention);
    return r;
  }

  const TrajectoryInfo& info_;
  const AnalysisContext& context_;
  std::size_t phases_;
  std::vector<SeriesAverage> by_phase_;
  std::vector<double> by_cycle_;
  std::int64_t cycle_ = -1;
  double sum_ = 0;
  std::size_t count_ = 0;
  SeriesAverage mean_;
};

}  // namespace

std::string why_not_at_rest(const TrajectoryInfo& info, const Frame& frame) {
  if (frame.time > 0 && info.conditions.gamma && *info.conditions.gamma > 1)
    return fmt::format(
        "the file begins {:.3g} t0 after the drive has begun, at Gamma = {:.3g}, when the bed no longer lies "
        "as it did at rest; analyse a file without time.discard",
        frame.time, *info.conditions.gamma);
  if (frame.velocity.empty()) return {};
  Vec3 of_plate = Vec3::Zero();
  if (info.drive && frame.phase >= 0 && info.phases_per_cycle > 0) {
    const double fraction = static_cast<double>(frame.phase) / info.phases_per_cycle;
    of_plate = info.drive->velocity_in_space(fraction, info.drive->cycle_at(frame.time, fraction));
  }
  double riding = 0, still = 0, n = 0;
  for (std::size_t i = 0; i < frame.velocity.size(); ++i) {
    if (!frame.present(i) || !frame.velocity[i].allFinite()) continue;
    riding += (frame.velocity[i] - of_plate).squaredNorm() / 2;
    still += frame.velocity[i].squaredNorm() / 2;
    ++n;
  }
  if (n == 0) return {};
  // At time 0 a bed at rest in the lab counts as well. At other times it does not, because the bed may be at
  // the top of its flight.
  const double energy = (frame.time == 0 ? std::min(riding, still) : riding) / n;
  if (energy <= kAtRest) return {};
  return fmt::format(
      "the beads of the first frame move with {:.2g} m g sigma each relative to the plate; at most {:g} at "
      "rest",
      energy, kAtRest);
}

std::optional<double> resting_height(const TrajectoryInfo& info, const Frame& frame, std::string& why_not) {
  const auto plate = plate_height(info, frame);
  const double height = centre_of_mass_height(frame, info.mass);
  if (!plate || !std::isfinite(height))
    why_not = plate ? "the first frame holds no bead" : "the plate's height is not known";
  else if (why_not = why_not_at_rest(info, frame); !why_not.empty())
    why_not += "; --rest-height states the height";
  else if (frame.velocity.empty())
    why_not = "the trajectory has no velocities that show whether the bed is at rest in its first frame";
  else
    return height - *plate;
  return std::nullopt;
}

constinit const ObservableEntry centre_of_mass_observable = {
    kResults, &make_observable<CentreOfMass>, {"rest_height"}};

}  // namespace twincell::analysis
