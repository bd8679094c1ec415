#include "analysis/motion/velocity_autocorrelation.hpp"

#include "analysis/motion/lagged_vectors.hpp"
#include "analysis/observable/array_with_interval.hpp"
#include "analysis/statistics/ratio_average.hpp"

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{"vacf"}, {"vacf_low"}, {"vacf_high"}, {"vacf_lag"}};
const char* const kSource = "Allen & Tildesley, Computer Simulation of Liquids, sec. 2.7";

class VelocityAutocorrelation : public Observable {
 public:
  explicit VelocityAutocorrelation(const AnalysisContext& context)
      : info_(context.info), past_(kLongestVelocityLag), c_(kLongestVelocityLag + 1) {}

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    if (frame.velocity.empty()) return;
    std::vector<Vec3> now = fluctuations(frame);
    if (now.empty()) return;
    if (!past_.empty() && !(interval_ > 0)) interval_ = frame.time - past_.last();
    past_.add(frame.time, std::move(now), interval_,
              [&](std::size_t lag, const std::vector<Vec3>& before, const std::vector<Vec3>& after) {
                add_pair(before, after, lag);
              });
  }

  [[nodiscard]] std::vector<Result> results() const override {
    std::vector<double> lags(c_.size());
    for (std::size_t m = 0; m < lags.size(); ++m) lags[m] = static_cast<double>(m) * interval_;
    const std::string none = info_.columns.velocity ? "no two frames have two beads that move"
                                                    : "the trajectory has no velocities";
    const bool some = interval_ > 0 && c_[1].n() > 0;
    std::vector<Result> all = array_with_interval(
        some ? c_ : std::vector<RatioAverage>(c_.size()),
        {.name = "vacf",
         .unit = "1",
         .n_of = "lags",
         .convention = "relative to the mean velocity of each frame, over the mean square at both frames",
         .source = kSource},
        "pairs of frames", none);
    Result lag{.name = "vacf_lag", .unit = "t0", .n_of = "lags", .source = kSource};
    all.push_back(some ? array_of(lags, lag, none) : absent_result("vacf_lag", none, kSource));
    return all;
  }

 private:
  /// Velocities relative to their mean; NaN where unknown; empty if fewer than two are known.
  [[nodiscard]] std::vector<Vec3> fluctuations(const Frame& frame) const {
    std::vector<Vec3> v = of_present(frame, frame.velocity, info_.box);
    Vec3 sum = Vec3::Zero();
    double n = 0;
    for (const Vec3& each : v) {
      if (!each.allFinite()) continue;
      sum += each;
      ++n;
    }
    if (n < 2) return {};
    const Vec3 mean = sum / n;
    for (Vec3& each : v) {
      // What is left of beads that all move alike is the rounding of the mean.
      constexpr double kRounding = 1e-12;
      const double before = each.norm();
      each -= mean;
      if (each.norm() < kRounding * before) each = Vec3::Zero();
    }
    return v;
  }

  void add_pair(const std::vector<Vec3>& before, const std::vector<Vec3>& now, std::size_t lag) {
    double product = 0, squares = 0;
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (!before[i].allFinite() || !now[i].allFinite()) continue;
      product += before[i].dot(now[i]);
      squares += 0.5 * (before[i].squaredNorm() + now[i].squaredNorm());
    }
    if (squares > 0) c_[lag].add(product, squares);
  }

  const TrajectoryInfo& info_;
  double interval_ = 0;  ///< time between the first two frames, t0
  LaggedVectors past_;   ///< velocities by time
  std::vector<RatioAverage> c_;
};

}  // namespace

constinit const ObservableEntry velocity_autocorrelation_observable = {
    kResults, &make_observable<VelocityAutocorrelation>};

}  // namespace twincell::analysis
