#include "analysis/gas/profiles.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/constants.hpp"
#include "trajectory/centre_of_mass.hpp"

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{.name = "profile_z", .along = "profile_z"},
                                    {.name = "phi_z", .along = "profile_z", .elsewhere = 0},
                                    {.name = "T_z_z", .along = "profile_z"},
                                    {.name = "T_x_z", .along = "profile_z"},
                                    {.name = "T_z_frames_z", .along = "profile_z"},
                                    {.name = "T_z_instant_z", .along = "profile_z"},
                                    {"T_z_volume"}};

const char* const kSource = "Bhateja, Sharma & Singh 2016, Figs. 12 to 16";

/// Mass-weighted mean and sum of squares of a velocity, updated in one pass.
struct Spread {
  double mass = 0, mean = 0, sum = 0;
  std::size_t n = 0;
  void add(double m, double v) {
    ++n;
    mass += m;
    const double off = v - mean;
    mean += off * m / mass;
    sum += m * off * (v - mean);
  }
  /// m <(v - <v>)^2>
  [[nodiscard]] double temperature() const {
    return n < kProfileSamples ? kNaN : sum / static_cast<double>(n);
  }
};

/// Sums of one slab.
struct Slab {
  double filled =
      0;           ///< overlap of the beads with the slab, summed over frames: sigma^2 (2D) or sigma^3 (3D)
  Spread w, u;     ///< vertical velocity, horizontal velocity along x
  double now = 0;  ///< current frame: sum of m (w - w_cm)^2
  Spread w_now;    ///< current frame: vertical velocity
  double over_frames = 0;    ///< sum over frames of the mean over beads
  double over_instants = 0;  ///< the same of m (w - <w>)^2, <w> the mean of the slab in the frame
};

class Profiles : public Observable {
 public:
  explicit Profiles(const AnalysisContext& context) : info_(context.info) {
    if (!info_.box.periodic(Axis::z)) return;
    // Slabs divide the period evenly.
    const double period = info_.box.size().z();
    slabs_in_period_ = std::max<std::int64_t>(1, std::llround(period));
    thickness_ = period / static_cast<double>(slabs_in_period_);
    foot_ = info_.box.lower.z();
  }

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    ++frames_;
    const double drift = centre_of_mass_velocity(frame, info_.mass).value_or(Vec3::Zero()).z();
    for (std::size_t i = 0; i < frame.position.size(); ++i) {
      if (!frame.present(i) || !frame.position[i].allFinite()) continue;
      const double z = frame.position[i].z() - foot_;
      const double radius = radius_of(info_.radius, i);
      const auto below = [&](double height) {
        return info_.box.dimension == 2 ? disc_below(radius, height) : sphere_below(radius, height);
      };
      const auto top = static_cast<std::int64_t>(std::floor((z + radius) / thickness_));
      double under = 0;
      for (auto k = static_cast<std::int64_t>(std::floor((z - radius) / thickness_)); k <= top; ++k) {
        const double up_to = below(thickness_ * static_cast<double>(k + 1) - z);
        slabs_[slab_of(k)].filled += up_to - under;
        under = up_to;
      }
      if (frame.velocity.empty() || !frame.velocity[i].allFinite()) continue;
      const double mass = mass_of(info_.mass, i);
      Slab& slab = slabs_[slab_of(static_cast<std::int64_t>(std::floor(z / thickness_)))];
      slab.w.add(mass, frame.velocity[i].z());
      slab.u.add(mass, frame.velocity[i].x());
      slab.now += mass * (frame.velocity[i].z() - drift) * (frame.velocity[i].z() - drift);
      slab.w_now.add(mass, frame.velocity[i].z());
    }
    for (auto& [k, slab] : slabs_) {
      if (const auto n = static_cast<double>(slab.w_now.n); n > 0) {
        slab.over_frames += slab.now / n;
        slab.over_instants += slab.w_now.sum / n;
      }
      slab.now = 0, slab.w_now = {};
    }
  }

  [[nodiscard]] std::vector<Result> results() const override {
    std::vector<double> z, phi, t_z, t_x, t_frames, t_instant;
    const Vec3 size = info_.box.size();
    const double slab_size = thickness_ * size.x() * (info_.box.dimension == 2 ? 1 : size.y());
    for (const auto& [k, slab] : slabs_) {
      if (!(slab.filled > 0)) continue;  // a bead touches the border of this slab without overlapping it
      z.push_back(foot_ + thickness_ * (static_cast<double>(k) + 0.5));
      phi.push_back(slab.filled / slab_size / static_cast<double>(frames_));
      t_z.push_back(slab.w.temperature());
      t_x.push_back(slab.u.temperature());
      const auto mean = [&](double over_frames) {
        return slab.w.n < kProfileSamples ? kNaN : over_frames / static_cast<double>(frames_);
      };
      t_frames.push_back(mean(slab.over_frames));
      t_instant.push_back(mean(slab.over_instants));
    }
    const std::string none = "no frame holds a bead";
    const std::string cold =
        !info_.columns.velocity ? "the trajectory has no velocities" : "no slab holds enough velocities";
    const auto array = [&](const char* name, const std::vector<double>& values, const char* unit,
                           const char* convention, const std::string& why) {
      return array_of(
          values, {.name = name, .unit = unit, .n_of = "slabs", .convention = convention, .source = kSource},
          why);
    };
    const char* temperature =
        "m <(v - <v>)^2>, <v> the mean of the slab over all frames, no factor 1/2; NaN with fewer than 100 "
        "velocities";
    return {
        array("profile_z", z, "sigma",
              slabs_in_period_ == 0 ? "centres of slabs of thickness sigma, plate mean at 0"
                                    : "centres of slabs about sigma thick that divide the period evenly",
              none),
        array("phi_z", phi, "1",
              info_.box.dimension == 2 ? "area of discs in the slab over its area, mean over frames"
                                       : "volume of spheres in the slab over its volume, mean over frames",
              none),
        array("T_z_z", t_z, "m g sigma", temperature, cold),
        array("T_x_z", t_x, "m g sigma", temperature, cold),
        array("T_z_frames_z", t_frames, "m g sigma",
              "mean over frames of the mean over beads of m (w - w_cm)^2, a frame in which the slab is empty "
              "counting as 0; no factor 1/2; NaN with fewer than 100 velocities",
              cold),
        array("T_z_instant_z", t_instant, "m g sigma",
              "mean over frames of the mean over beads of m (w - <w>)^2, <w> the mean of the slab in the "
              "frame, a frame with fewer than two beads in the slab counting as 0; no factor 1/2; NaN with "
              "fewer than "
              "100 velocities",
              cold),
        volume_mean()};
  }

 private:
  /// Local temperature averaged over volume instead of over beads. Because the top is open, the volume is
  /// that of the lowest slabs that contain the share kMaxOfTheBeads of the velocities.
  [[nodiscard]] Result volume_mean() const {
    std::size_t all = 0;
    for (const auto& [k, slab] : slabs_) all += slab.w.n;
    double sum = 0;
    std::size_t held = 0, n = 0;
    for (const auto& [k, slab] : slabs_) {
      if (static_cast<double>(held) >= kMaxOfTheBeads * static_cast<double>(all)) break;
      held += slab.w.n;
      if (slab.w.n < kProfileSamples) continue;
      sum += slab.w.temperature();
      ++n;
    }
    if (n == 0) return absent_result("T_z_volume", "no slab holds enough velocities", kSource);
    Result r{.name = "T_z_volume",
             .values = {sum / static_cast<double>(n)},
             .unit = "m g sigma",
             .n = n,
             .n_of = "slabs"};
    r.no_interval = "the slabs share their beads and are not independent";
    r.convention =
        "mean of T_z_z over the lowest slabs that hold 99 % of the beads, all slabs weighted equally";
    r.source = "Bhateja, Sharma & Singh 2016, eq. 1";
    return r;
  }

  [[nodiscard]] std::int64_t slab_of(std::int64_t k) const {
    return slabs_in_period_ == 0 ? k : ((k % slabs_in_period_) + slabs_in_period_) % slabs_in_period_;
  }

  static constexpr double kMaxOfTheBeads = 0.99;
  const TrajectoryInfo& info_;
  std::int64_t slabs_in_period_ = 0;  ///< along a periodic z; 0: not periodic
  double thickness_ = 1, foot_ = 0;   ///< of a slab; lower side of slab 0, sigma
  std::size_t frames_ = 0;
  std::map<std::int64_t, Slab>
      slabs_;  // sparse: a bead far above the bed adds two slabs instead of thousands
};

}  // namespace

double disc_below(double radius, double height) {
  const double u = std::clamp(height / radius, -1.0, 1.0);
  return radius * radius * (std::numbers::pi / 2 + std::asin(u) + u * std::sqrt(1 - u * u));
}

double sphere_below(double radius, double height) {
  const double u = std::clamp(height / radius, -1.0, 1.0);
  return std::numbers::pi * radius * radius * radius * (2.0 / 3 + u - u * u * u / 3);
}

constinit const ObservableEntry profiles_observable = {kResults, &make_observable<Profiles>};

}  // namespace twincell::analysis
