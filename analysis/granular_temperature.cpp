#include "analysis/granular_temperature.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>

#include "analysis/trajectory/centre_of_mass.hpp"

namespace twincell {
namespace {

const char* const kPaper1 = "Fortini & Huang 2015, eq. 2";
const char* const kPaper2 = "Bhateja et al. 2016, eq. 5 and Table III";

/// Mean over the frames of whole cycles; over all frames where no cycle is whole.
class CycleAverage {
 public:
  explicit CycleAverage(int frames_per_cycle) : frames_per_cycle_(frames_per_cycle) {}

  void add(const Frame& frame, double value) {
    frames_.add(value);
    if (frames_per_cycle_ <= 0 || frame.cycle < 0) return;
    if (frame.cycle != cycle_) {
      cycle_ = frame.cycle;
      sum_ = 0;
      count_ = 0;
    }
    sum_ += value;
    if (++count_ == frames_per_cycle_) cycles_.add(sum_ / count_);
  }
  [[nodiscard]] bool by_cycles() const { return cycles_.n() > 0; }
  [[nodiscard]] const BlockAverage& average() const { return by_cycles() ? cycles_ : frames_; }
  [[nodiscard]] std::string of_what() const { return by_cycles() ? "cycles" : "frames"; }

 private:
  int frames_per_cycle_;
  std::int64_t cycle_ = -1;
  double sum_ = 0;
  int count_ = 0;
  BlockAverage cycles_, frames_;
};

/// Mass and first two moments of the vertical velocity in one slab at one phase.
struct SlabSums {
  double n = 0, mass = 0, momentum = 0, squares = 0;
};

class GranularTemperature : public Observable {
 public:
  explicit GranularTemperature(const AnalysisContext& context)
      : info_(context.info),
        x_(info_.phases_per_cycle),
        y_(info_.phases_per_cycle),
        z_(info_.phases_per_cycle),
        sum_(info_.phases_per_cycle) {}

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    if (!info_.columns.velocity) return;
    const Vec3 t = temperature_components(frame, info_.mass);
    if (!t.allFinite()) return;
    x_.add(frame, t.x());
    y_.add(frame, t.y());
    z_.add(frame, t.z());
    sum_.add(frame, t.sum());
    if (frame.phase >= 0) add_field(frame);
  }

  [[nodiscard]] std::vector<Result> results() const override {
    if (!info_.columns.velocity || sum_.average().n() == 0) {
      const std::string reason =
          info_.columns.velocity
              ? "no bead has a velocity in any frame"
              : "the trajectory has no velocities, and differences between frames are another quantity";
      std::vector<Result> none = {absent_result("T_g", reason, kPaper1)};
      for (const char* name :
           {"T_x", "T_y", "T_z", "T", "T_z_eq5", "T_z_field", "T_bar_z", "T_bar", "T_z_tau"})
        none.push_back(absent_result(name, reason, kPaper2));
      return none;
    }
    const bool flat = info_.box.dimension == 2;
    const double d_f = flat ? 2 : 3;
    const std::string kinetic = " (not the factor 1/2 of eq. 5 as printed)";
    std::vector<Result> all;
    all.push_back(scaled("T_g", sum_, 0.5, "(m/2) mean |v'|^2, all components", kPaper1));
    all.push_back(scaled("T_x", x_, 1, "m mean u'^2" + kinetic, kPaper2));
    all.push_back(flat ? absent_result("T_y", "the cell is two-dimensional", kPaper2)
                       : scaled("T_y", y_, 1, "m mean v'^2" + kinetic, kPaper2));
    all.push_back(scaled("T_z", z_, 1, "m mean w'^2" + kinetic, kPaper2));
    all.push_back(scaled("T", sum_, 1 / d_f, fmt::format("mean of the {} components", d_f), kPaper2));
    all.push_back(scaled("T_z_eq5", z_, 0.5, "(m/2) mean w'^2, eq. 5 as printed", kPaper2));
    all.push_back(field_result());
    add_scaled_by_drive(all, d_f);
    all.push_back(correlation_result());
    return all;
  }

 private:
  [[nodiscard]] static Result scaled(const std::string& name, const CycleAverage& cycles, double factor,
                                     const std::string& what, const std::string& source,
                                     const std::string& unit = "m g sigma") {
    const BlockAverage& average = cycles.average();
    Result r{.name = name,
             .values = {factor * average.mean()},
             .unit = unit,
             .n = average.n(),
             .n_of = cycles.of_what()};
    if (auto interval = average.interval(r.n_of)) {
      interval->low *= factor;
      interval->high *= factor;
      r.interval = interval;
    } else {
      r.no_interval = average.why_no_interval(r.n_of);
    }
    r.convention = fmt::format("{}; v' about the centre of mass of each instant, no rotation; mean over {}",
                               what, cycles.by_cycles() ? "the frames of whole cycles" : "frames");
    r.source = source;
    return r;
  }

  void add_scaled_by_drive(std::vector<Result>& all, double d_f) const {
    const double v_p = info_.drive ? info_.drive->peak_velocity() : 0;
    if (!(v_p > 0)) {
      for (const char* name : {"T_bar_z", "T_bar"})
        all.push_back(absent_result(name, "the drive's V_p is not known or zero", kPaper2));
      return;
    }
    const double per = 1 / (v_p * v_p);
    const std::string by = fmt::format(", over m V_p^2 with V_p = {:.6g} sigma/t0", v_p);
    all.push_back(scaled("T_bar_z", z_, per, "m mean w'^2" + by, kPaper2, "m V_p^2"));
    all.push_back(scaled("T_bar", sum_, per / d_f, "mean of the components" + by, kPaper2, "m V_p^2"));
  }

  [[nodiscard]] Result correlation_result() const {
    const BlockAverage& average = z_.average();
    const double tau = average.correlation_time();
    if (!std::isfinite(tau)) return absent_result("T_z_tau", "one value has no correlation", kPaper2);
    Result r{
        .name = "T_z_tau", .values = {tau}, .unit = z_.of_what(), .n = average.n(), .n_of = z_.of_what()};
    r.no_interval = "it is itself what the intervals of the means rest on";
    r.convention =
        "integrated correlation time of T_z, 1/2 + sum of rho_k; blocks of the error bar are five of it";
    r.source = "Sokal 1997; Wolff 2004";
    return r;
  }

  void add_field(const Frame& frame) {
    for (std::size_t i = 0; i < frame.velocity.size(); ++i) {
      if (!frame.present(i) || !frame.velocity[i].allFinite() || !std::isfinite(frame.position[i].z()))
        continue;
      const double m = info_.mass.empty() ? 1.0 : info_.mass[i], w = frame.velocity[i].z();
      SlabSums& slab = field_[{frame.phase, static_cast<int>(std::floor(frame.position[i].z()))}];
      slab.n += 1;
      slab.mass += m;
      slab.momentum += m * w;
      slab.squares += m * w * w;
    }
  }

  /// Every mean velocity that is estimated takes one sample with it, hence the divisor.
  [[nodiscard]] Result field_result() const {
    double fluctuation = 0, samples = 0;
    for (const auto& [where, slab] : field_) {
      fluctuation += slab.squares - slab.momentum * slab.momentum / slab.mass;
      samples += slab.n;
    }
    const auto means = static_cast<double>(field_.size());
    if (field_.empty())
      return absent_result("T_z_field", "the frames are not locked to the drive's phase", kPaper2);
    if (samples < 2 * means)
      return absent_result("T_z_field",
                           fmt::format("{} samples do not determine the mean velocity of {} slabs and phases",
                                       samples, field_.size()),
                           kPaper2);
    Result r{.name = "T_z_field",
             .values = {fluctuation / (samples - means)},
             .unit = "m g sigma",
             .n = static_cast<std::size_t>(samples),
             .n_of = "bead-frames"};
    r.no_interval = "the field is estimated from the same frames; that of T_z is a guide";
    r.convention = fmt::format(
        "m mean w'^2, w' about the mean vertical velocity at its phase and height: {} slabs of sigma and "
        "phases, "
        "lab frame",
        field_.size());
    r.source = kPaper2;
    return r;
  }

  const TrajectoryInfo& info_;
  CycleAverage x_, y_, z_, sum_;
  std::map<std::pair<std::int32_t, int>, SlabSums> field_;
};

}  // namespace

Vec3 temperature_components(const Frame& frame, const std::vector<double>& mass) {
  const auto counts = [&](std::size_t i) { return frame.present(i) && frame.velocity[i].allFinite(); };
  const auto mass_of = [&](std::size_t i) { return mass.empty() ? 1.0 : mass[i]; };
  const auto v_cm = centre_of_mass_velocity(frame, mass);
  if (!v_cm) return Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  Vec3 sum = Vec3::Zero();
  std::size_t n = 0;
  for (std::size_t i = 0; i < frame.velocity.size(); ++i)
    if (counts(i)) {
      sum += mass_of(i) * (frame.velocity[i] - *v_cm).cwiseAbs2();
      ++n;
    }
  return sum / static_cast<double>(n);
}

double granular_temperature(const Frame& frame, const std::vector<double>& mass) {
  return temperature_components(frame, mass).sum() / 2;
}

std::unique_ptr<Observable> make_granular_temperature(const AnalysisContext& context) {
  return std::make_unique<GranularTemperature>(context);
}

}  // namespace twincell
