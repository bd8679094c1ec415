#include "imaging/refine/residual_correlation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

namespace twincell::imaging {

namespace {

/// \returns nothing if a pixel of the ring is outside the frame or hidden.
std::optional<RimHarmonics> harmonics_of(const RingArgs& args, const Disc& disc) {
  const cv::Mat1f &picture = *args.picture, &model = *args.model;
  const int width = picture.cols - kSpareColumns;
  const double outer = disc.radius + args.ring, inner = std::max(0.0, disc.radius - args.ring);
  if (disc.x < outer || disc.y < outer || disc.x > width - 1 - outer || disc.y > picture.rows - 1 - outer)
    return std::nullopt;
  // A path widens the edge, on average over the directions by half of its variance L^2/12.
  const std::array<double, 2>& path = args.blur.path;
  const double variance = args.blur.variance + (path[0] * path[0] + path[1] * path[1]) / 24;
  const double half_level = disc.radius - 0.5 * variance / disc.radius;
  RimHarmonics rim;
  for (int y = cvCeil(disc.y - outer); y <= cvFloor(disc.y + outer); ++y) {
    if (y % args.row_step != 0) continue;
    const double dy = y - disc.y, half = std::sqrt(std::max(0.0, outer * outer - dy * dy));
    const float *seen = picture[y], *expected = model[y];
    for (int x = cvCeil(disc.x - half); x <= cvFloor(disc.x + half); ++x) {
      const double dx = x - disc.x, r2 = dx * dx + dy * dy;
      if (r2 <= inner * inner || r2 == 0) continue;
      if (seen[x] == kUnseen) return std::nullopt;
      const double r = std::sqrt(r2), u = r - half_level, t = static_cast<double>(expected[x]);
      const double residual = std::clamp(static_cast<double>(seen[x]) - t, -args.huber, args.huber);
      const double v = args.dark_variance + args.light_variance * std::clamp(1 - t, 0.0, 1.0);
      rim.add(dx / r, dy / r, disc.darkness * std::exp(-0.5 * u * u / variance), 1 / v, residual);
    }
  }
  return rim;
}

/// Estimate of the mean of exponentially distributed values from the smallest 95 % of them: a disc that lies
/// on a letter does not count.
double trimmed_mean(std::vector<double> values) {
  constexpr double kTrimmed = 0.05;
  const auto kept =
      static_cast<std::ptrdiff_t>(std::ceil((1 - kTrimmed) * static_cast<double>(values.size())));
  std::nth_element(values.begin(), values.begin() + kept - 1, values.end());
  const double expected = 1 + kTrimmed * std::log(kTrimmed) / (1 - kTrimmed);  // for a mean of 1
  return std::accumulate(values.begin(), values.begin() + kept, 0.0) / (static_cast<double>(kept) * expected);
}

}  // namespace

std::vector<RimHarmonics> rim_harmonics(const RingArgs& args, std::span<const Disc> discs,
                                        std::span<const double> excesses) {
  constexpr std::size_t kMaxDiscs = 256;  // a standard error of 6 % of rho
  std::vector<RimHarmonics> rims;
  const std::size_t stride = (discs.size() + kMaxDiscs - 1) / kMaxDiscs;
  for (std::size_t k = 0; k < discs.size(); k += stride)
    if (std::optional<RimHarmonics> rim = harmonics_of(args, discs[k])) {
      rim->excess = excesses[k];
      rims.push_back(*rim);
    }
  return rims;
}

double residual_correlation(const std::vector<RimHarmonics>& rims) {
  constexpr std::size_t kMinDiscs = 12;
  constexpr double kMaxSteepness = 4, kClearly = 3;  // standard errors
  if (rims.size() < kMinDiscs) return 1;
  RimHarmonics common;
  for (const RimHarmonics& rim : rims)
    for (std::size_t m = 0; m < RimHarmonics::kWaves; ++m)
      common.sums[m] += rim.sums[m], common.expected[m] += rim.expected[m];
  std::array<double, RimHarmonics::kOrders> p{};
  for (std::size_t order = 0; order < p.size(); ++order) {
    std::vector<double> powers;
    for (const RimHarmonics& rim : rims) {
      double power = 0;
      for (const std::size_t m : {2 * order, 2 * order + 1}) {
        if (rim.expected[m] <= 0) continue;
        const double own = rim.sums[m] - common.sums[m] / common.expected[m] * rim.expected[m];
        power += 0.5 * own * own / rim.expected[m];
      }
      powers.push_back(power / rim.excess);
    }
    p[order] = trimmed_mean(std::move(powers));
  }
  const double error = 1 / std::sqrt(static_cast<double>(rims.size()));  // relative, of p
  const double steepness = p[1] > 0 ? p[0] / p[1] / (1 + std::numbers::sqrt2 * error) : 1;
  const double rho = steepness > 1 ? p[0] * std::min(kMaxSteepness, steepness) : 0.5 * (p[0] + p[1]);
  // In units of the noise. Beads that touch have a second harmonic, but no third one, of their contacts.
  double typical = 0;
  for (const RimHarmonics& rim : rims) typical += rim.excess / static_cast<double>(rims.size());
  const bool seen = p[1] * typical > 1 + kClearly * error;
  return seen && rho > 1 + kClearly * error ? rho : 1;
}

}  // namespace twincell::imaging
