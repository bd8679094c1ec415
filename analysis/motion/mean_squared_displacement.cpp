#include "analysis/motion/mean_squared_displacement.hpp"

#include <cmath>
#include <deque>
#include <limits>
#include <numeric>

namespace twincell {
namespace {

constexpr NamedResult kResults[] = {{"msd"}, {"msd_lag"}};
const char* const kSource = "Allen & Tildesley, Computer Simulation of Liquids, sec. 2.7";

class MeanSquaredDisplacement : public Observable {
 public:
  explicit MeanSquaredDisplacement(const AnalysisContext& context)
      : info_(context.info), sums_(kLongestLag, 0), counts_(kLongestLag, 0) {}

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    if (frame.phase != 0 || frame.cycle < 0) return;
    std::vector<Vec3> now = frame.position;
    for (std::size_t i = 0; i < now.size(); ++i)
      if (!frame.present(i)) now[i].setConstant(std::numeric_limits<double>::quiet_NaN());
    for (const auto& [cycle, before] : past_) {
      const std::int64_t lag = frame.cycle - cycle;
      if (lag < 1 || lag > static_cast<std::int64_t>(kLongestLag)) continue;
      add_pair(before, now, static_cast<std::size_t>(lag - 1));
    }
    past_.push_back({frame.cycle, std::move(now)});
    if (past_.size() > kLongestLag) past_.pop_front();
  }

  [[nodiscard]] std::vector<Result> results() const override {
    std::vector<double> msd(kLongestLag, std::numeric_limits<double>::quiet_NaN()), lags(kLongestLag);
    std::iota(lags.begin(), lags.end(), 1.0);
    for (std::size_t m = 0; m < kLongestLag; ++m)
      if (counts_[m] > 0) msd[m] = sums_[m] / static_cast<double>(counts_[m]);
    const std::string none = info_.columns.phase
                                 ? "no bead is seen at phase 0 of two cycles that are at most 32 apart"
                                 : "the frames have no drive phase";
    Result times =
        array_of(lags, {.name = "msd_lag", .unit = "cycles", .n_of = "lags", .source = kSource}, none);
    Result values =
        array_of(msd,
                 {.name = "msd",
                  .unit = "sigma^2",
                  .n_of = "lags",
                  .convention = "phase 0 of whole cycles, relative to the mean displacement of the beads",
                  .source = kSource},
                 none);
    if (!values.present()) times = absent_result("msd_lag", none, kSource);
    return {values, times};
  }

 private:
  void add_pair(const std::vector<Vec3>& before, const std::vector<Vec3>& now, std::size_t m) {
    Vec3 drift = Vec3::Zero();
    std::size_t n = 0;
    const auto step = [&](std::size_t i) {
      Vec3 d = now[i] - before[i];
      if (info_.box.dimension == 2) d.y() = 0;
      return d;
    };
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
    sums_[m] += sum / static_cast<double>(n - 1) * static_cast<double>(n);  // n - 1: the drift is estimated
    counts_[m] += n;
  }

  struct Past {
    std::int64_t cycle;
    std::vector<Vec3> position;
  };
  const TrajectoryInfo& info_;
  std::deque<Past> past_;
  std::vector<double> sums_;
  std::vector<std::size_t> counts_;
};

}  // namespace

constinit const ObservableEntry mean_squared_displacement_observable = {
    kResults, &make_observable<MeanSquaredDisplacement>};

}  // namespace twincell
