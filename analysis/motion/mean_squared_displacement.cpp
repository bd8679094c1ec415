#include "analysis/motion/mean_squared_displacement.hpp"

#include <cmath>
#include <numeric>

#include "analysis/motion/lagged_vectors.hpp"
#include "analysis/observable/array_with_interval.hpp"
#include "analysis/statistics/ratio_average.hpp"

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{"msd"}, {"msd_low"}, {"msd_high"}, {"msd_lag"}};
const char* const kSource = "Allen & Tildesley, Computer Simulation of Liquids, sec. 2.7";

class MeanSquaredDisplacement : public Observable {
 public:
  explicit MeanSquaredDisplacement(const AnalysisContext& context)
      : info_(context.info),
        interval_(context.info.columns.phase ? 1 : 0),
        past_(kLongestLag),
        msd_(kLongestLag) {}

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    if (info_.columns.phase && (frame.phase != 0 || frame.cycle < 0)) return;
    const double at = info_.columns.phase ? static_cast<double>(frame.cycle) : frame.time;
    if (!info_.columns.phase && !past_.empty() && !(interval_ > 0)) interval_ = at - past_.last();
    past_.add(at, of_present(frame, frame.position, info_.box), interval_,
              [&](std::size_t lag, const std::vector<Vec3>& before, const std::vector<Vec3>& now) {
                if (lag > 0) add_pair(before, now, lag - 1);
              });
  }

  [[nodiscard]] std::vector<Result> results() const override {
    std::vector<double> lags(kLongestLag);
    std::iota(lags.begin(), lags.end(), 1.0);
    const std::string none = info_.columns.phase
                                 ? "no bead is seen at phase 0 of two cycles that are at most 32 apart"
                                 : "no bead is seen in two frames that are at most 32 apart";
    const std::string relative = ", relative to the mean displacement of the beads";
    std::vector<Result> all = array_with_interval(
        msd_,
        {.name = "msd",
         .unit = "sigma^2",
         .n_of = "lags",
         .convention =
             (info_.columns.phase ? "phase 0 of whole cycles" : "frames, which have no phase") + relative,
         .source = kSource},
        info_.columns.phase ? "pairs of cycles" : "pairs of frames", none);
    all.push_back(all.front().present() ? array_of(lags,
                                                   {.name = "msd_lag",
                                                    .unit = info_.columns.phase ? "cycles" : "frames",
                                                    .n_of = "lags",
                                                    .source = kSource},
                                                   none)
                                        : absent_result("msd_lag", none, kSource));
    return all;
  }

 private:
  void add_pair(const std::vector<Vec3>& before, const std::vector<Vec3>& now, std::size_t m) {
    Vec3 drift = Vec3::Zero();
    std::size_t n = 0;
    const auto step = [&](std::size_t i) { return Vec3(now[i] - before[i]); };
    for (std::size_t i = 0; i < now.size(); ++i)
      if (const Vec3 d = step(i); d.allFinite()) {
        drift += d;
        ++n;
      }
    if (n < 2) return;
    drift /= static_cast<double>(n);
    double sum = 0;
    for (std::size_t i = 0; i < now.size(); ++i)
      if (const Vec3 d = step(i); d.allFinite()) sum += (d - drift).squaredNorm();
    const auto beads = static_cast<double>(n);
    msd_[m].add(sum / (beads - 1) * beads, beads);  // n - 1: the drift is estimated
  }

  const TrajectoryInfo& info_;
  double interval_;     ///< between cycles, 1; without phases between the first two frames, t0
  LaggedVectors past_;  ///< positions by cycle, or by time
  std::vector<RatioAverage> msd_;
};

}  // namespace

constinit const ObservableEntry mean_squared_displacement_observable = {
    kResults, &make_observable<MeanSquaredDisplacement>};

}  // namespace twincell::analysis
