#include "analysis/force/stress.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "analysis/force/frames_of_landings.hpp"
#include "analysis/observable/array_with_interval.hpp"
#include "analysis/observable/cycle_average.hpp"
#include "trajectory/bed_forces.hpp"
#include "trajectory/branch_vector.hpp"
#include "trajectory/plate.hpp"

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{"stress"},
                                    {"stress_kinetic"},
                                    {.name = "pressure", .main = true},
                                    {.name = "pressure_kinetic", .range = Range::not_negative},
                                    {.name = "stress_xx_z", .along = "stress_z", .elsewhere = 0},
                                    {.name = "stress_zz_z", .along = "stress_z", .elsewhere = 0},
                                    {.name = "stress_z", .along = "stress_z"},
                                    {"wall_force"},
                                    {"wall_force_low"},
                                    {"wall_force_high"},
                                    {"wall_support"}};
const char* const kSource = "Goldhirsch 2010";

using Tensor = BedForces::Tensor;

/// Sums over frames of a slab of the profiles.
struct Slab {
  double xx = 0, zz = 0;
};

/// Means of the forces of frames, or of their means over time.
class Means {
 public:
  /// \param frames_per_cycle 0: over all frames instead of whole cycles
  Means(const TrajectoryInfo& info, int frames_per_cycle)
      : pressure(frames_per_cycle),
        kinetic_pressure(frames_per_cycle),
        support(frames_per_cycle),
        stress(9, CycleAverage(frames_per_cycle)),
        kinetic(9, CycleAverage(frames_per_cycle)),
        walls(info.walls.size(), CycleAverage(frames_per_cycle)),
        dimension_(info.box.dimension) {}

  /// \param weight of the beads, m g
  void add_contacts(const Frame& frame, const BedForces& forces, double weight) {
    pressure.add(frame, forces.stress.trace() / dimension_);
    add_tensor(stress, frame, forces.stress);
    double vertical = 0;
    for (std::size_t w = 0; w < walls.size() && w < forces.wall_force.size(); ++w) {
      walls[w].add(frame, forces.wall_normal_force[w]);
      vertical -= forces.wall_force[w].z();
    }
    if (weight > 0) support.add(frame, vertical / weight);
  }
  void add_kinetic(const Frame& frame, const BedForces& forces) {
    if (!forces.kinetic.allFinite()) return;
    kinetic_pressure.add(frame, forces.kinetic.trace() / dimension_);
    add_tensor(kinetic, frame, forces.kinetic);
  }

  CycleAverage pressure, kinetic_pressure, support;
  std::vector<CycleAverage> stress, kinetic, walls;

 private:
  static void add_tensor(std::vector<CycleAverage>& sums, const Frame& frame, const Tensor& t) {
    for (int k = 0; k < 9; ++k) sums[static_cast<std::size_t>(k)].add(frame, t(k / 3, k % 3));
  }
  int dimension_;
};

class Stress : public Observable {
 public:
  explicit Stress(const AnalysisContext& context)
      : info_(context.info), of_frames_(info_, 0), over_time_(info_, info_.phases_per_cycle) {
    if (!info_.box.periodic(Axis::z)) return;
    const double height = info_.box.size().z();
    period_ = std::max<std::int64_t>(1, std::llround(std::min(height / kStressSlab, 1e9)));
    thickness_ = height / static_cast<double>(period_);
  }

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    const BedForces now = bed_forces(frame, info_);
    if (!now.known()) return;
    ++frames_;
    of_frames_.add_kinetic(frame, now);
    if (!info_.columns.contact_forces) return;
    const double weight = weight_of(frame);
    of_frames_.add_contacts(frame, now, weight);
    if (frame.force_mean.known()) {
      over_time_.add_contacts(frame, frame.force_mean, weight);
      over_time_.add_kinetic(frame, frame.force_mean);
    }
    const BedWindow window = stress_window(frame, info_.box);
    const double per_area = (window.high.z() - window.low.z()) / window.content,
                 plate = plate_height(info_, frame).value_or(info_.box.lower.z());
    for (const ContactForce& c : frame.contact_forces)
      add_to_slabs(frame.position[static_cast<std::size_t>(c.i)].z() - plate, branch_vector(c, info_),
                   c.force(), per_area);
  }

  [[nodiscard]] std::vector<Result> results() const override {
    const std::string no_bead = "no frame has a bead",
                      none = info_.columns.contact_forces
                                 ? no_bead
                                 : "the trajectory stores no contact forces (simulate --contacts)",
                      still = info_.columns.velocity ? no_bead : "the trajectory has no velocities";
    const bool planar = info_.box.dimension == 2;
    const std::string unit = planar ? "m g/sigma" : "m g/sigma^2";
    const std::string volume =
        "positive in compression; volume of the bed between the 0.5 and 99.5 "
        "percentiles of the centres and half a diameter beyond; " +
        mean_over();
    const Means& means = best();
    const auto scalar = [&](const char* name, const CycleAverage& series, const char* what,
                            const std::string& why_absent) {
      return judged(mean_of(
          series.average(),
          {.name = name,
           .unit = unit,
           .n_of = series.of_what(),
           .convention = fmt::format("trace over {} of the {}; {}", info_.box.dimension, what, volume),
           .source = kSource},
          why_absent));
    };
    std::vector<Result> all = {
        tensor("stress", means.stress, unit, "virial of the contacts; " + volume, none),
        tensor("stress_kinetic", means.kinetic, unit,
               "m v'v' relative to the mean velocity of each instant; " + volume, still),
        scalar("pressure", means.pressure, "virial of the contacts", none),
        scalar("pressure_kinetic", means.kinetic_pressure, "kinetic stress", still)};
    std::vector<double> xx, zz, z;
    for (const auto& [k, slab] : slabs_) {
      xx.push_back(slab.xx / static_cast<double>(frames_));
      zz.push_back(slab.zz / static_cast<double>(frames_));
      z.push_back((static_cast<double>(k) + 0.5) * thickness_);
    }
    const std::string empty = info_.columns.contact_forces ? "no frame has a contact" : none;
    const auto array = [&](const char* name, const std::vector<double>& values, const std::string& of_unit,
                           const std::string& convention) {
      return array_of(
          values,
          {.name = name, .unit = of_unit, .n_of = "slabs", .convention = convention, .source = kSource},
          empty);
    };
    const std::string cut = "branch vectors cut at the slabs; mean over all frames" + aliasing_note(info_);
    all.push_back(array("stress_xx_z", xx, unit, cut));
    all.push_back(array("stress_zz_z", zz, unit, cut));
    all.push_back(array("stress_z", z, "sigma",
                        period_ > 0
                            ? fmt::format("centres of {} slabs above the lower border of the period", period_)
                            : "centres of slabs of thickness sigma above the plate"));
    for (Result& r : wall_results(none)) all.push_back(std::move(r));
    return all;
  }

 private:
  /// Adds f_a l_b of a branch that ends at height `top` to the slabs that it crosses, over the area and the
  /// thickness of a slab.
  void add_to_slabs(double top, const Vec3& branch, const Vec3& force, double per_area) {
    const double low = std::min(top, top - branch.z()), high = std::max(top, top - branch.z());
    const auto first = static_cast<std::int64_t>(std::floor(low / thickness_)),
               last = static_cast<std::int64_t>(std::floor(high / thickness_));
    constexpr std::int64_t kMaxSlabs = 100'000;  // a damaged file may have a bead at 1e7
    constexpr double kRounding = 1e-6;  // a wall lies on the border of a slab up to the rounding of overlaps
    if (last - first > kMaxSlabs) return;
    for (std::int64_t k = first; k <= last; ++k) {
      const double bottom = static_cast<double>(k) * thickness_;
      const double share =
          high > low ? (std::min(high, bottom + thickness_) - std::max(low, bottom)) / (high - low) : 1;
      if (!(share > kRounding)) continue;
      Slab& slab = slabs_[period_ > 0 ? (k % period_ + period_) % period_ : k];
      slab.xx += share * force.x() * branch.x() * per_area / thickness_;
      slab.zz += share * force.z() * branch.z() * per_area / thickness_;
    }
  }

  /// Whether means over time are available; otherwise the means are over frames.
  [[nodiscard]] bool over_time() const { return over_time_.pressure.by_cycles(); }
  [[nodiscard]] const Means& best() const { return over_time() ? over_time_ : of_frames_; }
  [[nodiscard]] std::string mean_over() const {
    return over_time() ? fmt::format("mean over time, {} samples per cycle", info_.samples_per_cycle / 2)
                       : "mean over all frames";
  }
  /// A mean over frames does not keep an interval that says nothing of its aliasing.
  [[nodiscard]] Result judged(Result r) const { return over_time() ? r : over_frames(std::move(r), info_); }

  /// Weight of the beads present, m g; 0 without gravity.
  [[nodiscard]] double weight_of(const Frame& frame) const {
    double mass = 0;
    for (std::size_t i = 0; i < frame.position.size(); ++i)
      if (frame.present(i)) mass += mass_of(info_.mass, i);
    return mass * gravity_of(info_) * (info_.drive ? info_.drive->downward_share : 1);
  }

  [[nodiscard]] Result tensor(const char* name, const std::vector<CycleAverage>& components,
                              const std::string& unit, const std::string& convention,
                              const std::string& none) const {
    const SeriesAverage& first = components.front().average();
    if (first.n() == 0) return absent_result(name, none, kSource);
    Result r{.name = name,
             .unit = unit,
             .n = first.n(),
             .n_of = components.front().of_what(),
             .no_interval = "pressure and pressure_kinetic have one",
             .convention = convention,
             .source = kSource};
    const std::vector<int> axes = info_.box.dimension == 2 ? std::vector{0, 2} : std::vector{0, 1, 2};
    for (const int a : axes)
      for (const int b : axes)
        r.values.push_back(components[static_cast<std::size_t>(3 * a + b)].average().mean());
    r.shape = {axes.size(), axes.size()};
    return judged(std::move(r));
  }

  /// wall_force with the ends of its intervals, and wall_support.
  [[nodiscard]] std::vector<Result> wall_results(const std::string& none) const {
    const Means& means = best();
    if (means.pressure.average().n() == 0 || means.walls.empty()) {
      const std::string why =
          means.walls.empty() && info_.columns.contact_forces ? "the cell has no walls" : none;
      std::vector<Result> absent;
      for (const char* name : {"wall_force", "wall_force_low", "wall_force_high", "wall_support"})
        absent.push_back(absent_result(name, why, kSource));
      return absent;
    }
    const std::string of_what = means.pressure.of_what();
    std::vector<SeriesAverage> walls;
    for (const CycleAverage& w : means.walls) walls.push_back(w.average());
    const SeriesAverage& support = means.support.average();
    std::vector<Result> all = array_with_interval(
        walls,
        {.name = "wall_force",
         .unit = "m g",
         .n_of = "walls",
         .convention = fmt::format(
             "normal force of all beads, {}; {}{}", mean_over(), fmt::join(info_.walls, ", "),
             support.n() == 0 ? std::string()
                              : fmt::format("; the walls carry {:.3g} of the weight", support.mean())),
         .source = kSource},
        of_what, none);
    all[0] = judged(std::move(all[0]));
    if (!over_time() && frames_may_alias(info_))
      for (std::size_t k : {1, 2}) all[k] = absent_result(all[k].name, all[0].no_interval, kSource);
    all.push_back(
        judged(mean_of(support,
                       {.name = "wall_support",
                        .unit = "1",
                        .n_of = means.support.of_what(),
                        .convention = "vertical force of all walls on the beads over their weight, " +
                                      mean_over() + "; 1 in a steady state without drag of the plates",
                        .source = "momentum balance"},
                       "there is no gravity")));
    return all;
  }

  const TrajectoryInfo& info_;
  std::size_t frames_ = 0;
  Means of_frames_, over_time_;
  std::map<std::int64_t, Slab> slabs_;
  std::int64_t period_ = 0;  // slabs of a period along z; 0 if there is none
  double thickness_ = kStressSlab;
};

}  // namespace

constinit const ObservableEntry stress_observable = {kResults, &make_observable<Stress>};

}  // namespace twincell::analysis
