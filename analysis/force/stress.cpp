#include "analysis/force/stress.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "analysis/force/branch_vector.hpp"
#include "analysis/neighbours/bed_window.hpp"
#include "analysis/observable/array_with_interval.hpp"
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
                                    {"wall_force"}};
const char* const kSource = "Goldhirsch 2010";
constexpr double kMargin = 0.5;  // sigma, of the window: a bead reaches half its diameter beyond its centre

using Tensor = Eigen::Matrix3d;

/// Sums over frames of a slab of the profiles.
struct Slab {
  double xx = 0, zz = 0;
};

class Stress : public Observable {
 public:
  explicit Stress(const AnalysisContext& context) : info_(context.info), wall_sums_(info_.walls.size(), 0) {
    if (!info_.box.periodic(Axis::z)) return;
    const double height = info_.box.size().z();
    period_ = std::max<std::int64_t>(1, std::llround(std::min(height / kStressSlab, 1e9)));
    thickness_ = height / static_cast<double>(period_);
  }

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    const std::vector<Vec3> centres = present_centres(frame);
    if (!info_.columns.contact_forces || centres.empty()) return;
    const BedWindow window = bed_window(centres, info_.box, kMargin);
    if (!(window.content > 0)) return;
    const double height = window.high.z() - window.low.z(),
                 plate = plate_height(info_, frame).value_or(info_.box.lower.z());
    Tensor contact = Tensor::Zero();
    for (const ContactForce& c : frame.contact_forces) {
      const Vec3 branch = branch_vector(c, info_), force = c.force();
      contact += force * branch.transpose();
      add_to_slabs(frame.position[static_cast<std::size_t>(c.i)].z() - plate, branch, force,
                   height / window.content);
      if (const auto w = static_cast<std::size_t>(-1 - c.j); c.j < 0 && w < wall_sums_.size())
        wall_sums_[w] += c.normal_force;
    }
    contact_ += contact / window.content;
    pressure_.add(contact.trace() / (window.content * info_.box.dimension));
    ++frames_;
    if (const Tensor kinetic = kinetic_of(frame); kinetic.allFinite()) {
      kinetic_ += kinetic / window.content;
      kinetic_pressure_.add(kinetic.trace() / (window.content * info_.box.dimension));
    }
  }

  [[nodiscard]] std::vector<Result> results() const override {
    const std::string none = info_.columns.contact_forces
                                 ? "no frame has a bead"
                                 : "the trajectory stores no contact forces (simulate --contacts)";
    const bool planar = info_.box.dimension == 2;
    const std::string unit = planar ? "m g/sigma" : "m g/sigma^2";
    const std::string volume =
        "positive in compression; volume of the bed between the 0.5 and 99.5 "
        "percentiles of the centres and half a diameter beyond";
    const auto scalar = [&](const char* name, const SeriesAverage& series, const char* what) {
      return mean_of(
          series,
          {.name = name,
           .unit = unit,
           .n_of = "frames",
           .convention = fmt::format("trace over {} of the {}; {}", info_.box.dimension, what, volume),
           .source = kSource},
          none);
    };
    std::vector<Result> all = {
        tensor("stress", contact_, frames_, unit, "virial of the contacts; " + volume, none),
        tensor("stress_kinetic", kinetic_, kinetic_pressure_.n(), unit,
               "m v'v' relative to the mean velocity of the frame; " + volume, none),
        scalar("pressure", pressure_, "virial of the contacts"),
        scalar("pressure_kinetic", kinetic_pressure_, "kinetic stress")};
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
    all.push_back(array("stress_xx_z", xx, unit, "branch vectors cut at the slabs; mean over all frames"));
    all.push_back(array("stress_zz_z", zz, unit, "branch vectors cut at the slabs; mean over all frames"));
    all.push_back(array("stress_z", z, "sigma",
                        period_ > 0
                            ? fmt::format("centres of {} slabs above the lower border of the period", period_)
                            : "centres of slabs of thickness sigma above the plate"));
    std::vector<double> walls;
    for (const double sum : wall_sums_) walls.push_back(sum / static_cast<double>(frames_));
    all.push_back(
        frames_ == 0 || walls.empty()
            ? absent_result("wall_force", frames_ == 0 ? none : "the cell has no walls", kSource)
            : array_of(walls,
                       {.name = "wall_force",
                        .unit = "m g",
                        .n_of = "walls",
                        .convention = fmt::format("normal force of all beads, mean over all frames; {}",
                                                  fmt::join(info_.walls, ", ")),
                        .source = kSource},
                       none));
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

  /// Sum of m v' v'; NaN without velocities.
  [[nodiscard]] Tensor kinetic_of(const Frame& frame) const {
    Tensor sum = Tensor::Zero();
    Vec3 momentum = Vec3::Zero();
    double mass = 0;
    const auto each = [&](auto&& visit) {
      for (std::size_t i = 0; i < frame.velocity.size(); ++i)
        if (frame.present(i) && frame.velocity[i].allFinite())
          visit(mass_of(info_.mass, i), frame.velocity[i]);
    };
    each([&](double m, const Vec3& v) { momentum += m * v, mass += m; });
    if (!(mass > 0)) return Tensor::Constant(std::numeric_limits<double>::quiet_NaN());
    each([&](double m, const Vec3& v) {
      const Vec3 off = v - momentum / mass;
      sum += m * off * off.transpose();
    });
    return sum;
  }

  [[nodiscard]] Result tensor(const char* name, const Tensor& sum, std::size_t frames,
                              const std::string& unit, const std::string& convention,
                              const std::string& none) const {
    if (frames == 0) return absent_result(name, none, kSource);
    Result r{.name = name,
             .unit = unit,
             .n = frames,
             .n_of = "frames",
             .no_interval = "pressure and pressure_kinetic have one",
             .convention = convention,
             .source = kSource};
    const std::vector<int> axes = info_.box.dimension == 2 ? std::vector{0, 2} : std::vector{0, 1, 2};
    for (const int a : axes)
      for (const int b : axes) r.values.push_back(sum(a, b) / static_cast<double>(frames));
    r.shape = {axes.size(), axes.size()};
    return r;
  }

  const TrajectoryInfo& info_;
  std::size_t frames_ = 0;
  Tensor contact_ = Tensor::Zero(), kinetic_ = Tensor::Zero();
  SeriesAverage pressure_, kinetic_pressure_;
  std::map<std::int64_t, Slab> slabs_;
  std::int64_t period_ = 0;  // slabs of a period along z; 0 if there is none
  double thickness_ = kStressSlab;
  std::vector<double> wall_sums_;
};

}  // namespace

constinit const ObservableEntry stress_observable = {kResults, &make_observable<Stress>};

}  // namespace twincell::analysis
