#include "analysis/motion/velocity_autocorrelation.hpp"

#include <cmath>
#include <deque>
#include <limits>

#include "analysis/observable/array_with_interval.hpp"
#include "analysis/statistics/ratio_average.hpp"

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{"vacf"}, {"vacf_low"}, {"vacf_high"}, {"vacf_lag"}};
const char* const kSource = "Allen & Tildesley, Computer Simulation of Liquids, sec. 2.7";

class VelocityAutocorrelation : public Observable {
 public:
  explicit VelocityAutocorrelation(const AnalysisContext& context)
      : info_(context.info), c_(kLongestVelocityLag + 1) {}

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    if (frame.velocity.empty()) return;
    std::vector<Vec3> now = fluctuations(frame);
    if (now.empty()) return;
    if (!past_.empty() && !(interval_ > 0)) interval_ = frame.time - past_.back().time;
    past_.push_back({frame.time, std::move(now)});
    for (const auto& [time, before] : past_) {
      const double lag = interval_ > 0 ? (frame.time - time) / interval_ : 0, whole = std::round(lag);
      constexpr double kJitter = 0.1;  // of a lag that still counts
      if (whole > kLongestVelocityLag || std::abs(lag - whole) > kJitter) continue;
      add_pair(before, past_.back().velocity, static_cast<std::size_t>(whole));
    }
    if (past_.size() > kLongestVelocityLag) past_.pop_front();
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
    std::vector<Vec3> v = frame.velocity;
    Vec3 sum = Vec3::Zero();
    double n = 0;
    for (std::size_t i = 0; i < v.size(); ++i) {
      if (info_.box.dimension == 2) v[i].y() = 0;
      if (!frame.present(i)) v[i].setConstant(std::numeric_limits<double>::quiet_NaN());
      if (!v[i].allFinite()) continue;
      sum += v[i];
      ++n;
    }
    if (n < 2) return {};
    for (Vec3& each : v) each -= sum / n;
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

  struct Past {
    double time;
    std::vector<Vec3> velocity;
  };
  const TrajectoryInfo& info_;
  double interval_ = 0;  ///< time between the first two frames, t0
  std::deque<Past> past_;
  std::vector<RatioAverage> c_;
};

}  // namespace

constinit const ObservableEntry velocity_autocorrelation_observable = {
    kResults, &make_observable<VelocityAutocorrelation>};

}  // namespace twincell::analysis
