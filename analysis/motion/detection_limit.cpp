#include "analysis/motion/detection_limit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "analysis/motion/bed_phase.hpp"
#include "core/constants.hpp"
#include "core/plural.hpp"

namespace twincell::analysis {
namespace {

const char* const kLimitSource = "Fortini & Huang 2015, app. B";

std::string against_threshold(double limit) {
  return fmt::format("{} sigma/30 = {:.4f}", limit <= kBouncingThreshold ? "below" : "above",
                     kBouncingThreshold);
}

}  // namespace

void DetectionLimit::add(const Frame& frame, const std::vector<double>& heights) {
  if (frame.position_sigma.empty()) return;
  for (std::size_t t = 0; t < heights.size(); ++t) {
    const double u = frame.position_sigma[context_.tracers[t]].z();
    if (!std::isfinite(heights[t]) || !std::isfinite(u)) continue;
    squares_ += u * u;
    ++count_;
  }
}

double DetectionLimit::noise() const {
  return count_ > 0 ? std::sqrt(squares_ / static_cast<double>(count_)) : kNaN;
}

Result DetectionLimit::half_pixel() const {
  const auto scale = context_.info.scale.pixels_per_sigma;
  if (!scale)
    return absent_result("half_pixel", "the trajectory has no pixels per sigma: it was not filmed",
                         kLimitSource);
  Result r{.name = "half_pixel", .values = {0.5 / *scale}, .unit = "sigma", .n = 1, .n_of = "scale"};
  r.convention =
      fmt::format("half a pixel at {:.4g} pixels per sigma; {}", *scale, against_threshold(r.value()));
  r.no_interval = "the scale is taken as given";
  r.source = kLimitSource;
  return r;
}

Result DetectionLimit::noise_result(const std::string& name, double value, const std::string& how) const {
  Result r{.name = name, .values = {value}, .unit = "sigma", .n = count_, .n_of = "heights"};
  r.convention = how + fmt::format("; one height is uncertain by {:.4g} sigma (rms)", noise());
  r.no_interval = "from the position uncertainties given by the locator";
  r.source = kLimitSource;
  return r;
}

void DetectionLimit::add_results(std::size_t cycles, std::vector<Result>& all) const {
  all.push_back(half_pixel());
  if (!std::isfinite(noise())) {
    for (const char* name : {"s_b_noise", "s_j_noise"})
      all.push_back(absent_result(name, "the trajectory has no uncertainties of positions", kLimitSource));
    return;
  }
  const std::size_t n_tracers = context_.tracers.size(), used = std::max<std::size_t>(1, cycles);
  const double floor = noise() / std::sqrt(static_cast<double>(n_tracers * used));
  all.push_back(noise_result(
      "s_b_noise", floor,
      fmt::format("s_b of a bed at rest from the camera's noise alone, sigma_z/sqrt(N_t N_f) with {} "
                  "tracers and {}; {}",
                  n_tracers, plural(used, "cycle"), against_threshold(floor))));
  all.push_back(
      noise_result("s_j_noise", noise(), "contribution of the noise alone to s_j, added in quadrature"));
}

}  // namespace twincell::analysis
