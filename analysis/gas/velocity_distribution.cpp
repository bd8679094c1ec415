#include "analysis/gas/velocity_distribution.hpp"

#include <cmath>

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{"a2_x"}, {"a2_z"}};
const char* const kSource = "van Noije & Ernst 1998";

class VelocityDistribution : public Observable {
 public:
  explicit VelocityDistribution(const AnalysisContext& context) : info_(context.info) {}

  void add(const FrameView& view) override {
    if (view.frame().velocity.empty()) return;
    add_component(view.frame(), 0, x_);
    add_component(view.frame(), 2, z_);
  }

  [[nodiscard]] std::vector<Result> results() const override { return {mean("a2_x", x_), mean("a2_z", z_)}; }

 private:
  static void add_component(const Frame& frame, int axis, SeriesAverage& average) {
    constexpr double kMinBeads = 4;
    double n = 0, sum = 0, second = 0, fourth = 0;
    const auto each = [&](auto&& visit) {
      for (std::size_t i = 0; i < frame.velocity.size(); ++i)
        if (frame.present(i) && std::isfinite(frame.velocity[i][axis])) visit(frame.velocity[i][axis]);
    };
    each([&](double v) { ++n, sum += v; });
    if (n < kMinBeads) return;
    each([&](double v) {
      const double square = (v - sum / n) * (v - sum / n);
      second += square / n;
      fourth += square * square / n;
    });
    // Rounding of the mean of equal velocities is no distribution.
    constexpr double kRounding = 1e-24;
    if (!(second > kRounding * (sum / n) * (sum / n)) || second <= 0) return;
    average.add(fourth / (second * second) * (n + 1) / (3 * (n - 1)) - 1);
  }

  [[nodiscard]] Result mean(const char* name, const SeriesAverage& series) const {
    return mean_of(
        series,
        {.name = name,
         .unit = "1",
         .n_of = "frames",
         .convention = "relative to the mean velocity of the frame; mean over frames",
         .source = kSource},
        info_.columns.velocity ? "no frame has four beads that move" : "the trajectory has no velocities");
  }

  const TrajectoryInfo& info_;
  SeriesAverage x_, z_;
};

}  // namespace

constinit const ObservableEntry velocity_distribution_observable = {kResults,
                                                                    &make_observable<VelocityDistribution>};

}  // namespace twincell::analysis
