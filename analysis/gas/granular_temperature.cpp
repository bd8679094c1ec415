#include "analysis/gas/granular_temperature.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>

#include "analysis/observable/cycle_average.hpp"
#include "analysis/statistics/ratio_average.hpp"

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {
    {.name = "T_g", .range = Range::not_negative, .main = true},
    {.name = "T_x", .range = Range::not_negative, .main = true},
    {.name = "T_y", .range = Range::not_negative},
    {.name = "T_z", .range = Range::not_negative, .main = true},
    {.name = "T", .range = Range::not_negative},
    {.name = "T_z_eq5", .range = Range::not_negative},
    {.name = "T_z_lab", .range = Range::not_negative},
    {.name = "T_z_field", .range = Range::not_negative},
    {.name = "T_bar_z", .range = Range::not_negative, .main = true, .over_peak_velocity = 2},
    {.name = "T_bar", .range = Range::not_negative, .over_peak_velocity = 2},
    {"T_z_tau"},
    {"T_g_aliasing"},
    {"T_z_aliasing"},
    {"T_g_sampling"}};

const char* const kPaper1 = "Fortini & Huang 2015, eq. 2";
const char* const kPaper2 = "Bhateja et al. 2016, eq. 5 and Table III";

/// Averages of m <v'^2> over cycles, for each component and for their sum.
class Components {
 public:
  explicit Components(int frames_per_cycle)
      : x(frames_per_cycle), y(frames_per_cycle), z(frames_per_cycle), sum(frames_per_cycle) {}

  /// Means over a completed cycle of the z component and of the sum of all components.
  struct Whole {
    double z, sum;
  };
  std::optional<Whole> add(const Frame& frame, const Vec3& t) {
    x.add(frame, t.x());
    y.add(frame, t.y());
    const auto of_z = z.add(frame, t.z()), of_sum = sum.add(frame, t.sum());
    return of_sum ? std::optional(Whole{*of_z, *of_sum}) : std::nullopt;
  }

  CycleAverage x, y, z, sum;
};

/// Number of beads, mass, and first two moments of the vertical velocity in one slab at one phase.
struct SlabSums {
  double n = 0, mass = 0, momentum = 0, squares = 0;
};

class GranularTemperature : public Observable {
 public:
  explicit GranularTemperature(const AnalysisContext& context)
      : info_(context.info),
        frames_(info_.phases_per_cycle),
        time_(info_.phases_per_cycle),
        coarse_(info_.phases_per_cycle),
        lab_z_(info_.phases_per_cycle) {}

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    if (!info_.columns.velocity) return;
    const Vec3 t = temperature_components(frame, info_.mass);
    if (!t.allFinite()) return;
    const auto of_frames = frames_.add(frame, t);
    lab_z_.add(frame, lab_temperature(frame));
    if (const TimeMean& mean = frame.time_mean; mean.temperature.allFinite()) {
      const auto of_time = time_.add(frame, mean.temperature);
      const auto of_coarse = coarse_.add(frame, mean.temperature_coarse);
      if (of_frames && of_time && of_coarse) {
        aliasing_z_.add(of_frames->z - of_time->z, of_time->z);
        aliasing_.add(of_frames->sum - of_time->sum, of_time->sum);
        sampling_.add(of_coarse->sum - of_time->sum, of_time->sum);
      }
    }
    if (frame.phase >= 0) add_field(frame);
  }

  [[nodiscard]] std::vector<Result> results() const override {
    if (!info_.columns.velocity || frames_.sum.average().n() == 0) {
      const std::string reason =
          info_.columns.velocity
              ? "no bead has a velocity in any frame"
              : "the trajectory has no velocities, and differences between frames are a different quantity";
      std::vector<Result> none;
      for (const NamedResult& result : kResults)
        none.push_back(
            absent_result(std::string(result.name), reason, result.name == "T_g" ? kPaper1 : kPaper2));
      return none;
    }
    const Components& means = best();
    const bool flat = info_.box.dimension == 2;
    const double d_f = flat ? 2 : 3;
    const std::string kinetic = " (not the factor 1/2 of eq. 5 as printed)";
    std::vector<Result> all;
    all.push_back(scaled("T_g", means.sum, 0.5, "(m/2) mean |v'|^2, all components", kPaper1));
    all.push_back(scaled("T_x", means.x, 1, "m mean u'^2" + kinetic, kPaper2));
    all.push_back(flat ? absent_result("T_y", "the cell is two-dimensional", kPaper2)
                       : scaled("T_y", means.y, 1, "m mean v'^2" + kinetic, kPaper2));
    all.push_back(scaled("T_z", means.z, 1, "m mean w'^2" + kinetic, kPaper2));
    all.push_back(scaled("T", means.sum, 1 / d_f, fmt::format("mean of the {} components", d_f), kPaper2));
    all.push_back(scaled("T_z_eq5", means.z, 0.5, "(m/2) mean w'^2, eq. 5 as printed", kPaper2));
    all.push_back(lab_result());
    all.push_back(field_result());
    add_scaled_by_drive(all, d_f);
    all.push_back(correlation_result());
    const std::string where =
        fmt::format("mean over the frames of whole cycles ({} per cycle) minus the mean over time",
                    info_.phases_per_cycle);
    all.push_back(excess("T_g_aliasing", aliasing_, where, kPaper1));
    all.push_back(excess("T_z_aliasing", aliasing_z_, where, kPaper2));
    all.push_back(
        excess("T_g_sampling", sampling_,
               fmt::format("time mean from every second of {} samples per cycle minus that from all",
                           info_.samples_per_cycle),
               kPaper1));
    return all;
  }

 private:
  /// Whether means over time are available; otherwise the means are over frames.
  [[nodiscard]] bool over_time() const { return time_.sum.by_cycles(); }
  [[nodiscard]] const Components& best() const { return over_time() ? time_ : frames_; }

  [[nodiscard]] static Result excess(const std::string& name, const RatioAverage& e, const std::string& what,
                                     const std::string& source) {
    if (e.n() == 0)
      return absent_result(
          name,
          "not known: the trajectory has no means over the time between its frames, which `simulate` "
          "writes",
          source);
    if (!std::isfinite(e.mean()))
      return absent_result(name, "the temperature is 0: no relative excess is defined", source);
    Result r{.name = name,
             .values = {e.mean()},
             .unit = "1",
             .n = e.n(),
             .n_of = "cycles",
             .convention = what + ", relative to the latter",
             .source = source};
    r.interval = e.interval("cycles");
    if (!r.interval) r.no_interval = e.why_no_interval("cycles");
    return r;
  }

  [[nodiscard]] std::string mean_over(const CycleAverage& cycles) const {
    if (over_time()) return fmt::format("time, {} samples per cycle", info_.samples_per_cycle);
    if (!cycles.by_cycles()) return "frames";
    return fmt::format("the frames of whole cycles; the aliasing of {} phases per cycle is not known",
                       info_.phases_per_cycle);
  }

  [[nodiscard]] Result scaled(const std::string& name, const CycleAverage& cycles, double factor,
                              const std::string& what, const std::string& source,
                              const std::string& unit = "m g sigma") const {
    const SeriesAverage& average = cycles.average();
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
                               what, mean_over(cycles));
    r.source = source;
    return r;
  }

  void add_scaled_by_drive(std::vector<Result>& all, double d_f) const {
    const double v_p = info_.drive && !info_.drive->ramp ? info_.drive->peak_velocity() : 0;
    if (!(v_p > 0)) {
      const char* const reason = info_.drive && info_.drive->ramp
                                     ? "the drive changes during the run (drive.ramp)"
                                     : "the drive's V_p is not known or zero";
      for (const char* name : {"T_bar_z", "T_bar"}) all.push_back(absent_result(name, reason, kPaper2));
      return;
    }
    const double per = 1 / (v_p * v_p);
    const std::string by = fmt::format(", over m V_p^2 with V_p = {:.6g} sigma/t0", v_p);
    all.push_back(scaled("T_bar_z", best().z, per, "m mean w'^2" + by, kPaper2, "m V_p^2"));
    all.push_back(scaled("T_bar", best().sum, per / d_f, "mean of the components" + by, kPaper2, "m V_p^2"));
  }

  [[nodiscard]] Result correlation_result() const {
    const CycleAverage& z = best().z;
    const SeriesAverage& average = z.average();
    const double tau = average.correlation_time();
    if (!std::isfinite(tau))
      return absent_result("T_z_tau",
                           average.n() < 2 ? "a single value has no correlation time"
                                           : "T_z drifts: its correlation does not end",
                           kPaper2);
    Result r{.name = "T_z_tau", .values = {tau}, .unit = z.of_what(), .n = average.n(), .n_of = z.of_what()};
    r.no_interval = "the intervals of the means are themselves based on it";
    r.convention =
        "integrated correlation time of T_z, 1/2 + sum of rho_k of the autoregressive process that describes "
        "it";
    r.source = "Burg 1975";
    return r;
  }

  /// m <w^2> of one frame.
  [[nodiscard]] double lab_temperature(const Frame& frame) const {
    double sum = 0;
    std::size_t n = 0;
    for (std::size_t i = 0; i < frame.velocity.size(); ++i) {
      if (!frame.present(i) || !frame.velocity[i].allFinite()) continue;
      sum += mass_of(info_.mass, i) * frame.velocity[i].z() * frame.velocity[i].z();
      ++n;
    }
    return sum / static_cast<double>(n);
  }

  [[nodiscard]] Result lab_result() const {
    const SeriesAverage& average = lab_z_.average();
    Result r{.name = "T_z_lab",
             .values = {average.mean()},
             .unit = "m g sigma",
             .n = average.n(),
             .n_of = lab_z_.of_what()};
    r.interval = average.interval(r.n_of);
    if (!r.interval) r.no_interval = average.why_no_interval(r.n_of);
    r.convention = fmt::format("m mean w^2 in the lab frame; mean over {}",
                               lab_z_.by_cycles() ? "the frames of whole cycles" : "frames");
    r.source = kPaper2;
    return r;
  }

  void add_field(const Frame& frame) {
    for (std::size_t i = 0; i < frame.velocity.size(); ++i) {
      if (!frame.present(i) || !frame.velocity[i].allFinite() || !std::isfinite(frame.position[i].z()))
        continue;
      const double m = mass_of(info_.mass, i), w = frame.velocity[i].z();
      SlabSums& slab =
          field_[{frame.phase, static_cast<int>(std::floor(info_.box.wrap(frame.position[i]).z()))}];
      slab.n += 1;
      slab.mass += m;
      slab.momentum += m * w;
      slab.squares += m * w * w;
    }
  }

  /// T_z_field. Each estimated mean velocity uses up one degree of freedom, hence the divisor samples -
  /// means.
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
    r.no_interval = "the mean velocities are estimated from the same frames; the interval of T_z is a guide";
    r.convention = fmt::format(
        "m mean w'^2, w' about the mean vertical velocity at its phase and height: {} slabs of sigma and "
        "phases, lab frame",
        field_.size());
    r.source = kPaper2;
    return r;
  }

  const TrajectoryInfo& info_;
  Components frames_, time_, coarse_;
  CycleAverage lab_z_;
  // Relative excess of one mean over another, from the cycles that have both.
  RatioAverage aliasing_, aliasing_z_, sampling_;
  std::map<std::pair<std::int32_t, int>, SlabSums> field_;
};

}  // namespace

double granular_temperature(const Frame& frame, const std::vector<double>& mass) {
  return temperature_components(frame, mass).sum() / 2;
}

constinit const ObservableEntry granular_temperature_observable = {kResults,
                                                                   &make_observable<GranularTemperature>};

}  // namespace twincell::analysis
