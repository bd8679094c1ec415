#include "sweep/precision_rule.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "trajectory/temperature.hpp"

namespace twincell::sweep {

namespace {

constexpr double kBetweenLooks = 1.2;  // ratio of run lengths at consecutive checks
constexpr double kMinCycles = 100, kMinFlights = 40;

std::int64_t first_look(const sim::Scene& scene) {
  // A flight of 2 V_p/g takes Gamma/pi periods.
  const double periods = scene.g() > 0 && !scene.lid ? scene.drive.gamma() / std::numbers::pi : 0;
  return static_cast<std::int64_t>(std::ceil(std::max(kMinCycles, kMinFlights * periods)));
}

}  // namespace

const std::vector<std::string>& precision_quantities() {
  static const std::vector<std::string> all = {"T_x", "T_y", "T_z", "T", "T_g", "T_bar_z", "T_bar", "h_cm"};
  return all;
}

PrecisionRule::PrecisionRule(const sim::Scene& scene, const TrajectoryInfo& info)
    : asked_(scene.until.value()),
      cap_(scene.cycles),
      mass_(info.mass),
      phases_(info.phases_per_cycle),
      dimension_(info.box.dimension),
      v_p_(scene.drive.peak_velocity()),
      next_look_(first_look(scene)) {
  const auto& known = precision_quantities();
  const std::string& name = asked_.quantity;
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw ConfigError(scene.where("until.quantity"),
                      fmt::format("\"{}\" is not one of {}.", name, fmt::join(known, ", ")));
  if (name.starts_with("T_bar") && !(v_p_ > 0))
    throw ConfigError(scene.where("until.quantity"),
                      fmt::format("\"{}\" is in units of V_p, and the plate is at rest.", name));
}

bool PrecisionRule::reached(const Frame& frame) {
  const std::string& name = asked_.quantity;
  if (name == "h_cm") {
    sum_ += centre_of_mass_height(frame, mass_);
  } else {
    // Time mean since the previous frame, as in `analyze`; the first frame has only its own value.
    const Vec3 t = frame.time_mean.temperature.allFinite() ? frame.time_mean.temperature
                                                           : temperature_components(frame, mass_);
    double value = t.sum() / dimension_;
    if (name == "T_g") value = t.sum() / 2;
    if (name == "T_x") value = t.x();
    if (name == "T_y") value = t.y();
    if (name == "T_z" || name == "T_bar_z") value = t.z();
    if (name.starts_with("T_bar")) value /= v_p_ * v_p_;
    sum_ += value;
  }
  if (frame.phase + 1 < phases_) return false;
  const double mean = sum_ / phases_;
  sum_ = 0;
  if (std::isfinite(mean)) cycles_.add(mean);  // a cell without beads has no mean
  const std::int64_t done = frame.cycle + 1;
  if (done < next_look_ && done < cap_) return false;
  next_look_ = static_cast<std::int64_t>(std::ceil(kBetweenLooks * static_cast<double>(done)));
  reached_ = narrow();
  return reached_;
}

bool PrecisionRule::narrow() const {
  // A quantity that does not vary between cycles has no statistical error.
  if (cycles_.has_no_scatter()) return true;
  const auto interval = cycles_.interval("cycles");
  if (!interval) return false;
  const double half = (interval->high - interval->low) / 2;
  return half <= std::max(asked_.relative * std::abs(cycles_.mean()), asked_.absolute);
}

std::string PrecisionRule::text() const {
  const auto interval = cycles_.interval("cycles");
  const std::string& name = asked_.quantity;
  std::string known =
      interval ? fmt::format("{} is known to {:.3g} %", name,
                             50 * (interval->high - interval->low) / std::abs(cycles_.mean()))
               : fmt::format("the error of {} is not known, {}", name, cycles_.why_no_interval("cycles"));
  if (cycles_.has_no_scatter())
    known = cycles_.mean() == 0
                ? fmt::format("{} is 0", name)
                : fmt::format("{} does not scatter: {}", name, cycles_.why_no_interval("cycles"));
  std::string asked = fmt::format("{:g} % was asked", 100 * asked_.relative);
  if (asked_.absolute > 0) asked += fmt::format(", or {:g}", asked_.absolute);
  const std::string time = fmt::format("correlation time {:.3g} cycles", cycles_.correlation_time());
  if (reached_) return fmt::format("{} after {} cycles; {}; {}", known, cycles_.n(), asked, time);
  return fmt::format("the cap of {} cycles ended the run: {}; {}; {}", cap_, known, asked, time);
}

}  // namespace twincell::sweep
