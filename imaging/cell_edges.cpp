#include "imaging/cell_edges.hpp"

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <numbers>
#include <optional>

#include "analysis/trajectory/median.hpp"
#include "imaging/preprocess.hpp"

namespace twincell {
namespace {

constexpr int kBorder = 3;   // px of dark that make a wall
constexpr int kPlateau = 2;  // px of light that must follow a step
constexpr int kMostPlateau = 4;
constexpr int kFar = 8;  // px of light behind it where the step's own light says its place

using Profile = std::vector<double>;  // darkness from the border inwards

struct Step {
  double at = 0;           // px from the border's first pixel centre
  double slope = 0;        // error of `at` over that of a pixel
  double light_level = 0;  // behind the step
  double variance = 0;     // of the step's blur, pixels averaged; px^2
};

std::optional<int> first_light(const Profile& p) {
  if (p.size() < 2 * kBorder) return std::nullopt;
  for (int i = 0; i < kBorder; ++i)
    if (!(p[static_cast<std::size_t>(i)] > 0.5)) return std::nullopt;
  const auto found = std::find_if(p.begin(), p.end(), [](double d) { return d < 0.5; });
  if (found == p.end()) return std::nullopt;
  return static_cast<int>(found - p.begin());
}

// Half the distance between 84 % and 16 %: the standard deviation of a Gaussian blur.
std::optional<double> half_width(const Profile& p, int light) {
  const auto cross = [&](double level, int from, int step) -> std::optional<double> {
    for (int i = from; i > 0 && i + 1 < static_cast<int>(p.size()); i += step) {
      const double a = p[static_cast<std::size_t>(i - 1)], b = p[static_cast<std::size_t>(i)];
      if (a >= level && b < level) return i - 1 + (a - level) / (a - b);
      if (std::abs(i - light) > 15) break;
    }
    return std::nullopt;
  };
  const auto dark = cross(0.84, light, -1), bright = cross(0.16, light, 1);
  if (!dark || !bright) return std::nullopt;
  return 0.5 * (*bright - *dark);
}

double dark_level(const Profile& p, int before) {
  const int first = std::max(0, before - kMostPlateau), n = before - first;
  double dark = 0;
  for (int i = first; i < before; ++i) dark += p[static_cast<std::size_t>(i)] / n;
  return n > 0 ? dark : 1;
}

// By the light that the step lets through; needs both levels in sight.
std::optional<Step> step_by_area(const Profile& p, int light, int reach, double noise) {
  const int a = light - reach, b = light + reach - 1;
  const int n_light = std::min(kMostPlateau, static_cast<int>(p.size()) - 1 - b);
  if (a < 1 || n_light < kPlateau) return std::nullopt;
  const double dark = dark_level(p, a);
  double level = 0;
  int used = 0;
  // Light only as far as it lasts: the next bead may begin.
  for (int i = b + 1; i <= b + n_light && p[static_cast<std::size_t>(i)] < 0.1 + 3 * noise; ++i, ++used)
    level += p[static_cast<std::size_t>(i)];
  if (used < kPlateau) return std::nullopt;
  level /= used;
  if (dark - level < 0.5) return std::nullopt;
  // A bead somewhat further on still darkens the light that the sum counts.
  for (int i = b + 1; i <= b + kFar; ++i)
    if (i >= static_cast<int>(p.size()) || p[static_cast<std::size_t>(i)] > level + 0.01 + 3.5 * noise)
      return std::nullopt;
  double sum = 0;
  for (int i = a; i <= b; ++i) sum += (p[static_cast<std::size_t>(i)] - level) / (dark - level);
  const double r = reach, at = a - 0.5 + sum;
  // Differences of pixels spread by a pixel's 1/12 more than the pixels themselves.
  double variance = -1.0 / 12;
  for (int i = a - 1; i <= b; ++i)
    variance += (i + 0.5 - at) * (i + 0.5 - at) *
                (p[static_cast<std::size_t>(i)] - p[static_cast<std::size_t>(i) + 1]) / (dark - level);
  return Step{at, std::sqrt(r + r * r / used) / (dark - level), level, variance};
}

double normal_quantile(double p) {
  return -std::numbers::sqrt2 * boost::math::erfc_inv(2 * p);
}

// By the pixels on the step itself, d = Phi((e - i)/s): beside beads and in the narrow gaps under them, where
// hardly a pixel is in full light. The brighter half of the step, which the bead's own blur may darken, is
// left out.
std::optional<Step> step_by_slope(const Profile& p, int light, double s, double level, double noise) {
  const int last = std::min(static_cast<int>(p.size()) - 1, light + static_cast<int>(std::ceil(4 * s)) + 1);
  double brightest = 1;
  for (int i = light; i <= last && p[static_cast<std::size_t>(i)] < 0.5; ++i)
    brightest = std::min(brightest, p[static_cast<std::size_t>(i)]);
  if (brightest > level + 0.12 + 2 * noise) return std::nullopt;
  const double dark = dark_level(p, light - static_cast<int>(std::ceil(3 * s)));
  if (dark < 0.5) return std::nullopt;
  double sum = 0, weights = 0;
  for (int i = light - static_cast<int>(std::ceil(3 * s)); i <= last; ++i) {
    if (i < 0) continue;
    const double d = (p[static_cast<std::size_t>(i)] - level) / (dark - level);
    if (d < 0.4) break;
    if (d > 0.95) continue;
    const double q = normal_quantile(d), density = std::exp(-0.5 * q * q) / std::sqrt(2 * std::numbers::pi);
    sum += density * density * (i + s * q);
    weights += density * density;
  }
  if (weights <= 0) return std::nullopt;
  return Step{sum / weights, s / std::sqrt(weights) / dark, level, s * s};
}

}  // namespace

CellEdges find_cell_edges(const cv::Mat& grey, bool bright, double diameter_px) {
  const Prepared image = prepare(grey, {.bright = bright}, 0.5 * diameter_px);
  const cv::Mat1f& d = image.darkness;
  const Noise variance = noise_of(d);
  const double noise = std::sqrt(variance.dark + variance.light);

  enum class From { left, right, bottom };
  const auto profile = [&](From from, int line, Profile& p) {
    if (from == From::bottom) {
      p.resize(static_cast<std::size_t>(d.rows));
      for (int i = 0; i < d.rows; ++i) p[static_cast<std::size_t>(i)] = d(d.rows - 1 - i, line);
    } else {
      p.resize(static_cast<std::size_t>(d.cols));
      for (int i = 0; i < d.cols; ++i)
        p[static_cast<std::size_t>(i)] = d(line, from == From::left ? i : d.cols - 1 - i);
    }
  };
  const auto lines = [&](From from) { return from == From::bottom ? d.cols : d.rows; };

  CellEdges edges;
  Profile p;
  std::vector<double> widths;
  for (const From from : {From::left, From::right, From::bottom})
    for (int line = 0; line < lines(from); ++line) {
      profile(from, line, p);
      if (const auto light = first_light(p))
        if (const auto w = half_width(p, *light)) widths.push_back(*w);
    }
  if (widths.empty()) return edges;
  edges.blur_px = upper_median(widths);
  // Moving edges are wider than resting ones; 3.2 standard deviations leave 0.07 % of the step outside.
  const int reach = std::clamp(static_cast<int>(std::ceil(3.2 * edges.blur_px + 0.5)), 3, 15);
  struct Seen {
    From from;
    int line, light;
    Step step;
  };
  std::vector<Seen> seen, narrow;
  std::vector<double> levels, variances;
  for (const From from : {From::left, From::right, From::bottom})
    for (int line = 0; line < lines(from); ++line) {
      profile(from, line, p);
      const auto light = first_light(p);
      if (!light || *light < kBorder) continue;
      if (const auto step = step_by_area(p, *light, std::min(reach, *light - 1), noise)) {
        seen.push_back({from, line, *light, *step});
        levels.push_back(step->light_level);
        variances.push_back(step->variance);
      } else {
        narrow.push_back({from, line, *light, {}});
      }
    }
  // Light as it is where nothing stands in it; 0 but for what the fitted light B leaves.
  const double level = levels.empty() ? 0 : upper_median(levels);
  // Half widths read off between pixels are too large by a tenth.
  edges.blur_px =
      variances.empty() ? 0.89 * edges.blur_px : std::sqrt(std::max(0.05, upper_median(variances)));
  for (Seen& n : narrow) {
    profile(n.from, n.line, p);
    if (const auto step = step_by_slope(p, n.light, edges.blur_px, level, noise)) {
      n.step = *step;
      seen.push_back(n);
    }
  }
  for (const Seen& n : seen) {
    const double sigma = n.step.slope * noise;
    if (n.from == From::left)
      edges.left.push_back({{n.step.at, double(n.line)}, sigma});
    else if (n.from == From::right)
      edges.right.push_back({{d.cols - 1 - n.step.at, double(n.line)}, sigma});
    else
      edges.plate.push_back({{double(n.line), d.rows - 1 - n.step.at}, sigma});
  }
  return edges;
}

}  // namespace twincell
