#include "imaging/cell/cell_edges.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "core/median.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/preprocess/straight_bars.hpp"

namespace twincell::imaging {
namespace {

constexpr int kBorder = 3;      // px; width of the dark border that makes a wall
constexpr int kWallMargin = 6;  // px; distance from its edges at which a wall shows its own level
constexpr double kUsualBlur_px = 0.9;
constexpr double kEdge = 3.2;  // half width of an edge, standard deviations of the blur
// A bead that transmits less than this share of the light hides the edge behind it. With 0.75 the edges of an
// agitated bed filmed with an exposure were off by 0.01 px: each bead is smeared along its own path, and its
// fitted disc is not.
constexpr float kMinTransmission = 0.97F;

/// A line of pixels from the border inwards.
struct Line {
  Border from;
  int number;     // row or column
  int wall = 0;   // index of the first pixel of the wall or plate
  int light;      // index of the first light pixel behind it
  int own, end;   // indices between which the wall shows its own level
  int inner = 0;  // index of the first pixel behind a bar, whether light or a bead that touches it
};

/// 0: side wall, 1: plate. The plate is another part and moves, so that level and blur differ.
int kind_of(const Line& line) {
  return line.from == Border::bottom ? 1 : 0;
}

std::optional<Line> line_from_border(const cv::Mat1f& d, Border from, int number) {
  const int n = line_length(from, d.size());
  if (n < 2 * kBorder) return std::nullopt;
  for (int i = 0; i < n; ++i)
    if (d(pixel_from(from, d.size(), number, i)) < 0.5F)
      return i < kBorder ? std::nullopt
                         : std::optional(Line{
                               .from = from, .number = number, .light = i, .own = 0, .end = i - kWallMargin});
  return std::nullopt;
}

/// Lines at which a straight bar begins.
std::vector<Line> lines_from_bars(const cv::Mat1f& d, Border from, double diameter_px) {
  std::vector<Line> lines;
  for (const StraightBar& bar : straight_bars(d, from, diameter_px)) {
    const int margin = std::clamp(bar.width / 3, 1, kWallMargin);
    for (const BarLine& line : bar.lines)
      lines.push_back({.from = from,
                       .number = line.number,
                       .wall = line.first,
                       .light = line.light,
                       .own = line.first + margin,
                       .end = line.first + bar.width - margin,
                       .inner = line.first + bar.width});
  }
  return lines;
}

/// Columns between the side bars. Those within a bar show its end, not the plate.
std::pair<int, int> columns_between(const std::vector<Line>& side_bars, int columns) {
  std::pair<int, int> between{0, columns};
  for (const Line& line : side_bars)
    if (line.from == Border::left)
      between.first = std::max(between.first, line.inner);
    else
      between.second = std::min(between.second, columns - line.inner);
  return between;
}

/// Every row and column at which a wall or the plate may begin.
std::vector<Line> lines_of(const cv::Mat1f& d, double diameter_px) {
  std::vector<Line> lines, bars;
  for (const Border from : {Border::left, Border::right, Border::bottom}) {
    const std::pair<int, int> between =
        from == Border::bottom ? columns_between(bars, d.cols) : std::pair{0, line_count(from, d.size())};
    std::vector<Line> found = lines_from_bars(d, from, diameter_px);
    bars.insert(bars.end(), found.begin(), found.end());
    for (int number = 0; number < line_count(from, d.size()); ++number)
      if (const auto line = line_from_border(d, from, number)) found.push_back(*line);
    for (const Line& line : found)
      if (line.number >= between.first && line.number < between.second) lines.push_back(line);
  }
  return lines;
}

double normal_cdf(double x) {
  return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}
double normal_density(double x) {
  return std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi);
}

/// Share of the light that the beads transmit, from their fitted discs (ring_normal_equations.hpp).
cv::Mat1f light_past_beads(const Located& located, cv::Size size) {
  constexpr double kReach = 4;  // beyond the rim, standard deviations of the blur
  cv::Mat1f share(size, 1.0F);
  const double s = located.blur_px > 0 ? located.blur_px : kUsualBlur_px;  // a shared profile has none
  for (const Detection& bead : located.beads) {
    const double reach = bead.radius + kReach * s, edge = bead.radius - s * s / (2 * bead.radius);
    const int left = std::max(0, cvCeil(bead.x - reach)),
              right = std::min(size.width - 1, cvFloor(bead.x + reach)),
              top = std::max(0, cvCeil(bead.y - reach)),
              bottom = std::min(size.height - 1, cvFloor(bead.y + reach));
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x)
        share(y, x) -=
            static_cast<float>(bead.darkness * normal_cdf((edge - std::hypot(x - bead.x, y - bead.y)) / s));
  }
  return share;
}

/// Quadratic surface through grey levels, by least squares from `start`. share(x, y) is the share of the
/// surface that a pixel shows; 0 excludes the pixel.
template <class Share>
Surface surface_through(const Prepared& image, Surface start, const Share& share) {
  constexpr double kMaxDeviation = 0.1;                // of a pixel from the surface, fraction of the light
  constexpr double kMinPixels = 60, kSamples = 30000;  // pixels
  const cv::Mat1f& d = image.darkness;
  const int stride = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(d.total()) / kSamples)));
  for (int round = 0; round < 3; ++round) {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Surface right = Surface::Zero();
    double n = 0;
    for (int y = 0; y < d.rows; y += stride)
      for (int x = 0; x < d.cols; x += stride) {
        const auto t = static_cast<double>(share(x, y));
        if (t <= 0) continue;
        const Surface at = surface_basis(x, y, d.size());
        const double light = image.light.dot(at), seen = (1 - static_cast<double>(d(y, x))) * light;
        if (std::abs(seen - start.dot(at) * t) > kMaxDeviation * light) continue;
        normal.noalias() += t * t * at * at.transpose();
        right += t * seen * at;
        ++n;
      }
    if (n < kMinPixels) return start;
    normal.diagonal().tail<5>().array() += 1e-4 * n;
    start = normal.ldlt().solve(right);
  }
  return start;
}

/// The local light. prepare() fits it to the brightest pixels, which the shadows of beads darken where beads
/// are dense. Here it is fitted to the pixels visible past the beads, `inside` all edges.
Surface light_inside(const Prepared& image, const cv::Mat1f& share, const cv::Mat1b& inside) {
  return surface_through(image, image.light, [&](int x, int y) {
    return inside(y, x) == 0 || share(y, x) < kMinTransmission ? 0 : share(y, x);
  });
}

/// Light from the walls themselves, from the border to 6 px before the edges, in a bar from a third of its
/// width to two thirds. Under front light the walls are not equally bright. A line that begins at a bead
/// beside the wall reaches into the bead, whose pixels do not count. \param share light past the beads
Surface light_of_walls(const Prepared& image, const std::vector<Line>& lines, const cv::Mat1f& share) {
  const cv::Mat1f& d = image.darkness;
  cv::Mat1b wall(d.size(), uchar{0});
  double sum = 0, n = 0;
  for (const Line& line : lines)
    for (int i = line.own; i < line.end; ++i) {
      const cv::Point at = pixel_from(line.from, d.size(), line.number, i);
      if (share(at) < kMinTransmission) continue;
      wall(at) = 1;
      sum += (1 - static_cast<double>(d(at))) * image.light.dot(surface_basis(at.x, at.y, d.size()));
      ++n;
    }
  Surface start = Surface::Zero();
  start[0] = n > 0 ? sum / n : 0;
  return surface_through(image, start, [&](int x, int y) { return static_cast<float>(wall(y, x)); });
}

/// Whether the noise around black is clipped at zero. The mean of the walls is then too bright by a fraction
/// of the noise, so that zero is used as their level.
bool clipped_black(const cv::Mat1f& d, const std::vector<Line>& lines) {
  constexpr double kMinZeroShare = 0.2;  // of the pixels at the border of the walls
  double zeros = 0, n = 0;
  for (const Line& line : lines)
    for (int i = line.own; i < line.own + std::min(kBorder, line.light - line.own); ++i, ++n)
      if (d(pixel_from(line.from, d.size(), line.number, i)) >= 1) ++zeros;
  return zeros > kMinZeroShare * n;
}

/// Pixels at least 4 px behind the first light pixel, seen from every side.
cv::Mat1b inside_of(const std::vector<Line>& lines, const cv::Size& size) {
  constexpr int kMargin = 4;  // px
  cv::Mat1b inside(size, uchar{1});
  for (const Line& line : lines)
    for (int i = 0; i < std::min(line_length(line.from, size), line.light + kMargin); ++i)
      inside(pixel_from(line.from, size, line.number, i)) = 0;
  return inside;
}

/// Removes points close to a corner, where each edge takes light from the other.
void leave_corners_out(CellEdges& edges, double reach) {
  constexpr std::size_t kCornerPoints = 25;  // nearest points of the other edge, which locate it
  const auto median = [](std::vector<double> v) {
    return v.empty() ? std::nan("") : upper_median(std::move(v));
  };
  const auto lowest = [&](const std::vector<EdgePoint>& wall) {  // column of a wall's foot
    std::vector<double> x;
    for (std::size_t i = wall.size() - std::min(kCornerPoints, wall.size()); i < wall.size(); ++i)
      x.push_back(wall[i].at.x_px);
    return median(std::move(x));
  };
  const auto row_beside = [&](bool left) {
    std::vector<double> y;
    const std::size_t n = std::min(kCornerPoints, edges.plate.size());
    for (std::size_t i = 0; i < n; ++i)
      y.push_back(edges.plate[left ? i : edges.plate.size() - 1 - i].at.y_px);
    return median(std::move(y));
  };
  // The median of an absent edge is NaN, and comparisons with NaN are false: no point is removed.
  // The walls first: where a plate joins both, the rows of the plate show the far side of the other wall.
  const double row_left = row_beside(true), row_right = row_beside(false);
  std::erase_if(edges.left, [&](const EdgePoint& p) { return p.at.y_px > row_left - reach; });
  std::erase_if(edges.right, [&](const EdgePoint& p) { return p.at.y_px > row_right - reach; });
  const double left = lowest(edges.left), right = lowest(edges.right);
  std::erase_if(edges.plate,
                [&](const EdgePoint& p) { return p.at.x_px < left + reach || p.at.x_px > right - reach; });
}

/// Level of the background under front light, if it is black and clipped at zero: it is then exactly zero.
/// Grey levels are counted from the brightest down, as prepare() inverts them.
std::optional<Surface> clipped_background(const cv::Mat& grey, const cv::Mat1f& d) {
  constexpr double kMinZeroShare = 0.2;  // of the pixels of the background
  constexpr float kMaxBackgroundDarkness = 0.15F;
  const cv::Mat1b clear = d < kMaxBackgroundDarkness, zero = clear & (grey <= 0);
  const double n = cv::countNonZero(clear);
  if (cv::countNonZero(zero) <= kMinZeroShare * n) return std::nullopt;
  double top = 0;
  cv::minMaxLoc(grey, nullptr, &top);
  Surface light = Surface::Zero();
  light[0] = top;
  return light;
}

/// Bright frames without text, glare and hot pixels. Levels far above those of beads and walls would
/// otherwise set the unit of darkness; they are cut a little above the brightest parts of these. \param image
/// the frame, prepared
cv::Mat without_highlights(const cv::Mat& grey, const Prepared& image) {
  constexpr double kMinObjectLevel = 0.6;  // of beads and walls, fraction of the contrast
  constexpr double kQuantile = 0.9;        // of these levels
  constexpr double kCutLevel = 1.15;       // multiple of the quantile
  const double contrast = contrast_of(image.darkness);
  if (contrast == 1) return grey;
  std::vector<float> levels;
  for (const float d : cv::Mat1f(image.darkness.clone()))
    if (static_cast<double>(d) > kMinObjectLevel * contrast) levels.push_back(d);
  if (levels.empty()) return grey;
  const auto at =
      levels.begin() + static_cast<std::ptrdiff_t>(kQuantile * static_cast<double>(levels.size()));
  std::nth_element(levels.begin(), at, levels.end());
  double top = 0;
  cv::minMaxLoc(grey, nullptr, &top);
  const cv::Size size = grey.size();
  const double light = image.light.dot(surface_basis(0.5 * size.width, 0.5 * size.height, size));
  cv::Mat cut;
  cv::min(grey, top - (1 - kCutLevel * static_cast<double>(*at)) * light, cut);
  return cut;
}

/// A fitted step. `at` is the distance from the centre of the border's first pixel, px; `error` is the
/// standard deviation of `at` for pixel noise 1.
struct Step {
  double at = 0, blur = 0, error = 0;
};

/// The pixels of a step, i = first ...: light relative to the local light, and share that beads block.
struct Window {
  int first = 0;
  std::vector<double> light, blocked;
};

/// Fits l_i = Phi((i - e)/s) - D_i by Gauss-Newton steps in e, and in s if free_blur.
std::optional<Step> fit_step(const Window& w, double start, double s, bool free_blur, double noise) {
  constexpr double kMaxMisfit = 3.5;     // standard deviations of the noise
  constexpr double kModelError = 0.015;  // fraction of the step
  double e = start;
  Eigen::Matrix2d normal;
  double squares = 0;
  for (int step = 0; step < 20; ++step) {
    normal.setZero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    squares = 0;
    for (std::size_t k = 0; k < w.light.size(); ++k) {
      const double near = (w.first + static_cast<int>(k) - e) / s, rise = normal_density(near) / s;
      const double r = w.light[k] - (normal_cdf(near) - w.blocked[k]);
      const Eigen::Vector2d slope(-rise, free_blur ? -rise * near : 0.0);
      normal += slope * slope.transpose();
      right += r * slope;
      squares += r * r;
    }
    if (!free_blur) normal(1, 1) = 1;
    if (!(normal.determinant() > 1e-9)) return std::nullopt;
    const Eigen::Vector2d delta = normal.ldlt().solve(right);
    e += std::clamp(delta[0], -1.0, 1.0);
    s = std::clamp(s + delta[1], 0.5 * s, 2 * s);
    if (!(e > w.first && e < w.first + static_cast<double>(w.light.size()))) return std::nullopt;
    if (delta.cwiseAbs().maxCoeff() < 1e-6) break;
  }
  const double freedom = static_cast<double>(w.light.size()) - (free_blur ? 2 : 1);
  if (freedom < 2 || std::sqrt(squares / freedom) > kMaxMisfit * noise + kModelError) return std::nullopt;
  return Step{e, s, std::sqrt(normal.inverse()(0, 0))};
}

}  // namespace

CellEdges find_cell_edges(const cv::Mat& picture, const BeadsAtEdges& beads) {
  const auto& [bright, diameter_px, refine] = beads;
  constexpr double kCornerReach = 4.5;              // blurs
  constexpr double kMaxBlur = 5, kMaxError = 0.12;  // px
  cv::Mat grey = picture;
  Prepared image = prepare(grey, {.bright = bright}, 0.5 * diameter_px);
  if (bright) {
    grey = without_highlights(picture, image);
    if (grey.data != picture.data) image = prepare(grey, {.bright = bright}, 0.5 * diameter_px);
  }
  const cv::Mat1f& d = image.darkness;
  const Noise variance = noise_of(d);
  const double noise = std::sqrt(variance.dark + variance.light);
  CellEdges edges;
  std::vector<Line> lines = lines_of(d, diameter_px);
  if (lines.empty()) return edges;
  // Light: levels of the background and of the walls, and the light that the located beads block.
  LocatorOptions locator;
  locator.diameter_px = diameter_px;
  locator.preprocess.bright = bright;
  locator.refine.method = refine;
  const Located located = locate(grey, locator);
  const cv::Mat1f share = light_past_beads(located, d.size());
  const auto background = bright ? clipped_background(grey, d) : std::nullopt;
  const Surface light = background ? *background : light_inside(image, share, inside_of(lines, d.size()));
  // Bars are narrow and may differ in level. Walls up to the border are one dark region, whose level more
  // pixels give better.
  std::vector<Line> parts[2] = {lines, lines};
  if (std::any_of(lines.begin(), lines.end(), [](const Line& line) { return line.wall > 0; }))
    for (int kind = 0; kind < 2; ++kind)
      std::erase_if(parts[kind], [&](const Line& line) { return kind_of(line) != kind; });
  const Surface walls[2] = {light_of_walls(image, parts[0], share), light_of_walls(image, parts[1], share)};
  const bool black_is_clipped = clipped_black(d, lines);

  // Windows: pixels around the step of a line, scaled so that the wall is 0 and the background is 1.
  const auto window_of = [&](const Line& line, double s) {
    const int reach = static_cast<int>(std::ceil(kEdge * s)) + 1, n = line_length(line.from, d.size());
    Window w{.first = std::max({1, line.own, line.light - reach}), .light = {}, .blocked = {}};
    for (int i = w.first; i < std::min(n, line.light + reach); ++i) {
      const cv::Point at = pixel_from(line.from, d.size(), line.number, i);
      if (share(at) < kMinTransmission) break;
      const Surface basis = surface_basis(at.x, at.y, d.size());
      const double b = image.light.dot(basis), level = 1 - light.dot(basis) / b,
                   dark = black_is_clipped ? 1 : 1 - walls[kind_of(line)].dot(basis) / b;
      if (dark - level < 0.5) return Window{};
      w.light.push_back((dark - static_cast<double>(d(at))) / (dark - level));
      w.blocked.push_back(1 - static_cast<double>(share(at)));
    }
    return w;
  };
  // Blur: the side walls share one blur, and the plate has its own.
  double blur[2] = {kUsualBlur_px, kUsualBlur_px};
  for (int round = 0; round < 2; ++round) {
    std::vector<double> found[2];
    for (const Line& line : lines) {
      const int kind = kind_of(line);
      const auto step = fit_step(window_of(line, blur[kind]), line.light - 0.5, blur[kind], true, noise);
      if (step && step->blur < kMaxBlur) found[kind].push_back(step->blur);
    }
    for (int kind = 0; kind < 2; ++kind)
      if (!found[kind].empty()) blur[kind] = upper_median(std::move(found[kind]));
  }
  // Positions: with the blur fixed, each line has a single unknown.
  edges.blur_px = blur[1];
  for (const Line& line : lines) {
    const double s = blur[kind_of(line)];
    const auto step = fit_step(window_of(line, s), line.light - 0.5, s, false, noise);
    if (!step) continue;
    const double sigma = step->error * noise;
    if (sigma > kMaxError) continue;
    if (line.from == Border::left)
      edges.left.push_back({{step->at, double(line.number)}, sigma});
    else if (line.from == Border::right)
      edges.right.push_back({{d.cols - 1 - step->at, double(line.number)}, sigma});
    else
      edges.plate.push_back({{double(line.number), d.rows - 1 - step->at}, sigma});
  }
  leave_corners_out(edges, kCornerReach * std::max(blur[0], blur[1]));
  return edges;
}

}  // namespace twincell::imaging
