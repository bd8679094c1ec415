#include "trajectory/recorded_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace twincell {

namespace {

/// The polynomial of degree 5 between two samples that are h apart, at u intervals after the first.
MotionSample between(const MotionSample& from, const MotionSample& to, double h, double u) {
  const double c0 = from.z, c1 = from.v * h, c2 = from.a * h * h / 2;
  // What the first three terms leave of displacement, velocity and acceleration at u = 1.
  const double z = to.z - (c0 + c1 + c2), v = to.v * h - (c1 + 2 * c2), a = to.a * h * h - 2 * c2;
  const double c3 = 10 * z - 4 * v + a / 2, c4 = -15 * z + 7 * v - a, c5 = 6 * z - 3 * v + a / 2;
  return {c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5)))),
          (c1 + u * (2 * c2 + u * (3 * c3 + u * (4 * c4 + u * 5 * c5)))) / h,
          (2 * c2 + u * (6 * c3 + u * (12 * c4 + u * 20 * c5))) / (h * h)};
}

RecordedMotion::Range range_of(const std::vector<MotionSample>& samples, double interval, bool repeats) {
  constexpr int kParts = 8;
  RecordedMotion::Range range{.lowest = samples.front().z, .highest = samples.front().z};
  const std::size_t n = samples.size(), intervals = repeats ? n : n - 1;
  for (std::size_t k = 0; k < intervals; ++k)
    for (int part = 0; part <= kParts; ++part) {
      const MotionSample s =
          between(samples[k], samples[(k + 1) % n], interval, static_cast<double>(part) / kParts);
      range.lowest = std::min(range.lowest, s.z);
      range.highest = std::max(range.highest, s.z);
      range.speed = std::max(range.speed, std::abs(s.v));
      range.fall = std::max(range.fall, -s.a);
      range.rise = std::max(range.rise, s.a);
    }
  return range;
}

}  // namespace

RecordedMotion::RecordedMotion(std::vector<MotionSample> samples, RecordInfo info)
    : samples_(std::move(samples)),
      info_(std::move(info)),
      range_(range_of(samples_, info_.interval, info_.cycles > 0)) {}

MotionSample RecordedMotion::at(std::int64_t cycle, double fraction, double period) const {
  const auto n = static_cast<std::int64_t>(samples_.size());
  const auto interpolated = [&](std::int64_t k, double u) {
    return between(samples_[static_cast<std::size_t>(k)], samples_[static_cast<std::size_t>((k + 1) % n)],
                   info_.interval, u);
  };
  const double first = info_.start / info_.interval;
  if (info_.cycles > 0) {
    const std::int64_t within = (cycle % info_.cycles + info_.cycles) % info_.cycles;
    const auto all = static_cast<double>(n);
    const double place = first + (static_cast<double>(within) + fraction) * (all / info_.cycles);
    const double position = place - std::floor(place / all) * all, whole = std::floor(position);
    return interpolated(static_cast<std::int64_t>(whole) % n, position - whole);
  }
  const double position = first + (static_cast<double>(cycle) + fraction) * (period / info_.interval);
  const double k = std::clamp(std::floor(position), 0.0, static_cast<double>(n - 2));
  return interpolated(static_cast<std::int64_t>(k), std::clamp(position - k, -1.0, 2.0));
}

double RecordedMotion::length(double period) const {
  if (info_.cycles > 0) return std::numeric_limits<double>::infinity();
  return (static_cast<double>(samples_.size() - 1) * info_.interval - info_.start) / period;
}

RecordedMotion RecordedMotion::scaled(double factor) const {
  std::vector<MotionSample> samples = samples_;
  for (MotionSample& s : samples) s = {factor * s.z, factor * s.v, factor * s.a};
  return {std::move(samples), info_};
}

}  // namespace twincell
