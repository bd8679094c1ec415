#include "analysis/granular_temperature.hpp"

#include <cmath>
#include <limits>

namespace twincell {
namespace {

class GranularTemperature : public Observable {
 public:
  explicit GranularTemperature(const AnalysisContext& context)
      : mass_(context.info.mass), has_velocity_(context.info.columns.velocity) {}

  void add(const FrameView& view) override {
    const double temperature = granular_temperature(view.frame(), mass_);
    if (std::isfinite(temperature)) average_.add(temperature);
  }

  [[nodiscard]] std::vector<Result> results() const override {
    const std::string source = "Fortini & Huang 2015, eq. 2";
    if (!has_velocity_)
      return {absent_result(
          "T_g", "the trajectory has no velocities, and differences between frames are another quantity",
          source)};
    if (average_.n() == 0) return {absent_result("T_g", "no bead has a velocity in any frame", source)};
    Result r{
        .name = "T_g", .values = {average_.mean()}, .unit = "m g sigma", .n = average_.n(), .n_of = "frames"};
    r.interval = average_.interval("frames");
    r.convention = "(m/2) mean |v - v_cm|^2, v_cm of each instant, no rotation, mean over frames";
    r.source = source;
    return {r};
  }

 private:
  const std::vector<double>& mass_;
  bool has_velocity_;
  BlockAverage average_;
};

}  // namespace

double granular_temperature(const Frame& frame, const std::vector<double>& mass) {
  const auto counts = [&](std::size_t i) { return frame.present(i) && frame.velocity[i].allFinite(); };
  const auto mass_of = [&](std::size_t i) { return mass.empty() ? 1.0 : mass[i]; };
  Vec3 momentum = Vec3::Zero();
  double total_mass = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < frame.velocity.size(); ++i)
    if (counts(i)) {
      momentum += mass_of(i) * frame.velocity[i];
      total_mass += mass_of(i);
      ++n;
    }
  if (n == 0) return std::numeric_limits<double>::quiet_NaN();
  const Vec3 v_cm = momentum / total_mass;
  double sum = 0;
  for (std::size_t i = 0; i < frame.velocity.size(); ++i)
    if (counts(i)) sum += mass_of(i) * (frame.velocity[i] - v_cm).squaredNorm();
  return 0.5 * sum / static_cast<double>(n);
}

std::unique_ptr<Observable> make_granular_temperature(const AnalysisContext& context) {
  return std::make_unique<GranularTemperature>(context);
}

}  // namespace twincell
