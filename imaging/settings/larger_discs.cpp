#include "imaging/settings/larger_discs.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "core/cancellation.hpp"
#include "core/median.hpp"
#include "imaging/refine/picture_evidence.hpp"

namespace twincell::imaging {

namespace {

constexpr double kLarger = 1.4, kLargest = 0.9;  // diameters: in those of the beads; in the shorter side
constexpr double kBesideBead_px = 1.5;           // from its rim outwards, where an edge is that of the bead

/// A circle around a region that is brighter (sign 1) or darker (-1) than its surroundings.
struct Circle {
  double x, y, radius, sign;
  double votes = 0;
};

/// 255 where a bead explains the edges. \param beyond its rim, px
cv::Mat1b explained_by(const std::vector<Detection>& beads, cv::Size size, double scale, double beyond) {
  constexpr int kShift = 4;
  const auto fixed = [](double v) { return cvRound(v * (1 << kShift)); };
  cv::Mat1b mask = cv::Mat1b::zeros(size);
  for (const Detection& b : beads)
    cv::circle(mask, {fixed((b.x + 0.5) / scale - 0.5), fixed((b.y + 0.5) / scale - 0.5)},
               fixed(b.radius / scale + beyond), 255, cv::FILLED, cv::LINE_8, kShift);
  return mask;
}

/// Edges of a reduced picture: where, and the direction of the gradient.
class Edges {
 public:
  Edges(const cv::Mat1f& grey, const cv::Mat1b& explained, double noise) : size_(grey.size()) {
    constexpr double kNoises = 4, kLeast = 0.02;  // per px; the latter in the range of the grey levels
    cv::Mat1f across, down;
    cv::Sobel(grey, across, CV_32F, 1, 0, 3, 1.0 / 8);
    cv::Sobel(grey, down, CV_32F, 0, 1, 3, 1.0 / 8);
    double low = 0, high = 0;
    cv::minMaxLoc(grey, &low, &high);
    const auto least = static_cast<float>(std::max(kNoises * noise, kLeast * (high - low)));
    for (int y = 0; y < grey.rows; ++y)
      for (int x = 0; x < grey.cols; ++x) {
        const float gx = across(y, x), gy = down(y, x), length = std::hypot(gx, gy);
        if (explained(y, x) == 0 && length >= least) edges_.push_back({x, y, gx / length, gy / length});
      }
  }

  /// The best circles of a radius.
  ///
  /// \param centres distance of each place from the nearest centre of a bead
  [[nodiscard]] std::vector<Circle> circles(double radius, double sign, const cv::Mat1f& centres) const {
    constexpr int kMost = 3;
    constexpr double kSpread = 0.03;  // of the votes, in radii
    const double smoothing = 1 + kSpread * radius;
    cv::Mat1f votes = cv::Mat1f::zeros(size_);
    for (const Edge& e : edges_) {
      const int x = cvRound(e.x + sign * radius * static_cast<double>(e.along_x)),
                y = cvRound(e.y + sign * radius * static_cast<double>(e.along_y));
      if (x >= 0 && y >= 0 && x < size_.width && y < size_.height) ++votes(y, x);
    }
    cv::GaussianBlur(votes, votes, {0, 0}, smoothing);
    votes.setTo(0, centres < radius);  // the rims of beads that are larger than they were found
    std::vector<Circle> best;
    for (int k = 0; k < kMost; ++k) {
      double most = 0;
      cv::Point at;
      cv::minMaxLoc(votes, nullptr, &most, nullptr, &at);
      if (most <= 0) break;
      best.push_back({static_cast<double>(at.x), static_cast<double>(at.y), radius, sign,
                      most * smoothing * smoothing / radius});
      cv::circle(votes, at, cvCeil(radius), 0, cv::FILLED);
    }
    return best;
  }

 private:
  struct Edge {
    int x, y;
    float along_x, along_y;
  };
  cv::Size size_;
  std::vector<Edge> edges_;
};

/// The rims of circles in the picture itself.
class Rims {
 public:
  Rims(const cv::Mat1f& grey, const std::vector<Detection>& beads, double noise)
      : grey_(grey),
        beads_(beads),
        hidden_(explained_by(beads, grey.size(), 1, kBesideBead_px)),
        noise_(noise) {}

  /// The circle fitted to the edges within a distance from it; nothing if it is not the rim of a region.
  [[nodiscard]] std::optional<Circle> fitted(Circle c, double within_px) const {
    constexpr int kRounds = 4;
    constexpr double kMinShown = 0.75;  // of the directions in which the rim may be seen
    constexpr double kMinSeen = 0.25;   // of all directions
    constexpr double kNarrower = 0.5;
    for (int round = 0; round < kRounds;
         ++round, within_px = std::max(kTolerances * tolerance(c), kNarrower * within_px)) {
      const Seen seen = look(c, within_px);
      if (static_cast<double>(seen.directions) < kMinSeen * kDirections) return std::nullopt;
      if (round + 1 == kRounds)
        return static_cast<double>(near(c, seen.edges)) >= kMinShown * static_cast<double>(seen.directions)
                   ? std::optional(c)
                   : std::nullopt;
      if (!refit(c, seen.edges)) return std::nullopt;
    }
    return std::nullopt;
  }

  /// Whether a bead overlaps the circle, as the neighbours of a missed bead do whose rims are not its own.
  [[nodiscard]] bool has_beads(const Circle& c) const {
    constexpr double kApart = 0.5;  // of the radius of a bead
    return std::any_of(beads_.begin(), beads_.end(), [&](const Detection& b) {
      return std::hypot(b.x - c.x, b.y - c.y) < c.radius + kApart * b.radius;
    });
  }

  /// Whether the inside of a circle is full of edges, as a group of beads is that were not located: nearly
  /// all of it is within a fifth of a bead from a change of grey level half as steep as the rim is. The
  /// glare of a single disc covers a part of it.
  [[nodiscard]] bool is_full_of_edges(const Circle& c, double bead_px) const {
    constexpr double kOfRim = 0.5, kReach = 0.2, kFull = 0.92;
    constexpr double kRim = 0.125, kRim_px = 1.5;  // which is not the inside; in beads; at least
    const double steep = kOfRim * typical_step(c), inside = c.radius - std::max(kRim_px, kRim * bead_px);
    const int half = cvCeil(c.radius), reach = std::max(1, cvRound(kReach * bead_px));
    cv::Mat1b edges = cv::Mat1b::zeros(2 * half + 1, 2 * half + 1), within = edges.clone();
    for (int y = -half; y <= half; ++y)
      for (int x = -half; x <= half; ++x) {
        if (std::hypot(x, y) > inside) continue;
        within(y + half, x + half) = 255;
        if (gradient(c.x + x, c.y + y) > steep) edges(y + half, x + half) = 255;
      }
    cv::dilate(edges, edges, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * reach + 1, 2 * reach + 1}));
    return cv::countNonZero(edges & within) > kFull * cv::countNonZero(within);
  }
  [[nodiscard]] bool has_centre_of(const Circle& c) const {
    return c.x >= 0 && c.y >= 0 && c.x <= grey_.cols - 1 && c.y <= grey_.rows - 1;
  }

 private:
  static constexpr int kDirections = 96;
  static constexpr double kHalf_px = 1;     // of the distance over which a step is taken
  static constexpr double kTolerances = 3;  // from the circle, to which edges are looked for in the end

  struct Edge {
    double along_x, along_y;  ///< direction from the centre
    double r, step;           ///< distance from the centre, px; grey levels
  };
  struct Seen {
    std::size_t directions = 0;  ///< in which no bead hides the rim
    std::vector<Edge> edges;
  };

  [[nodiscard]] double level(double x, double y) const {
    const int i = std::clamp(cvFloor(x), 0, grey_.cols - 2), j = std::clamp(cvFloor(y), 0, grey_.rows - 2);
    const double u = x - i, v = y - j;
    return (1 - v) * ((1 - u) * static_cast<double>(grey_(j, i)) + u * static_cast<double>(grey_(j, i + 1))) +
           v * ((1 - u) * static_cast<double>(grey_(j + 1, i)) +
                u * static_cast<double>(grey_(j + 1, i + 1)));
  }
  [[nodiscard]] bool is_seen(double x, double y) const {
    return x >= 0 && y >= 0 && x <= grey_.cols - 1 && y <= grey_.rows - 1 &&
           hidden_(cvRound(y), cvRound(x)) == 0;
  }

  /// The steepest edge in each direction, unless most others are much steeper.
  [[nodiscard]] Seen look(const Circle& c, double within_px) const {
    constexpr double kSample_px = 0.5, kNoises = 3, kPart = 0.05;
    Seen seen;
    std::vector<double> steps;
    for (int k = 0; k < kDirections; ++k) {
      const double turn = 2 * std::numbers::pi * k / kDirections, ux = std::cos(turn), uy = std::sin(turn);
      if (!is_seen(c.x + c.radius * ux, c.y + c.radius * uy)) continue;
      ++seen.directions;
      Edge best{ux, uy, c.radius, 0};
      for (double r = c.radius - within_px; r <= c.radius + within_px; r += kSample_px) {
        if (!is_seen(c.x + r * ux, c.y + r * uy)) continue;
        const double step = c.sign * (level(c.x + (r - kHalf_px) * ux, c.y + (r - kHalf_px) * uy) -
                                      level(c.x + (r + kHalf_px) * ux, c.y + (r + kHalf_px) * uy));
        if (step > best.step) best.r = r, best.step = step;
      }
      if (best.step < kNoises * noise_) continue;
      seen.edges.push_back(best);
      steps.push_back(best.step);
    }
    if (steps.empty()) return seen;
    const double least = kPart * upper_median(std::move(steps));
    std::erase_if(seen.edges, [&](const Edge& e) { return e.step < least; });
    return seen;
  }

  /// Median step across a rim.
  [[nodiscard]] double typical_step(const Circle& c) const {
    std::vector<double> steps;
    for (const Edge& e : look(c, kTolerances * tolerance(c)).edges) steps.push_back(e.step);
    return steps.empty() ? 0 : upper_median(std::move(steps));
  }
  /// Change of the grey level over the two pixels across which a rim is seen.
  [[nodiscard]] double gradient(double x, double y) const {
    return std::hypot(level(x + kHalf_px, y) - level(x - kHalf_px, y),
                      level(x, y + kHalf_px) - level(x, y - kHalf_px));
  }

  /// Distance from a circle at which an edge is on it, px.
  [[nodiscard]] static double tolerance(const Circle& c) {
    constexpr double kLeast_px = 1, kOfRadius = 0.02;
    return std::max(kLeast_px, kOfRadius * c.radius);
  }
  [[nodiscard]] static std::size_t near(const Circle& c, const std::vector<Edge>& edges) {
    return static_cast<std::size_t>(std::count_if(
        edges.begin(), edges.end(), [&](const Edge& e) { return std::abs(e.r - c.radius) <= tolerance(c); }));
  }

  /// Moves the circle to the edges, those farther from it with less weight. \returns false: there are too few
  static bool refit(Circle& c, const std::vector<Edge>& edges) {
    constexpr std::size_t kMinEdges = 8;
    if (edges.size() < kMinEdges) return false;
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    std::vector<double> off;
    for (const Edge& e : edges) off.push_back(e.r - c.radius);
    const double middle = upper_median(std::move(off)), scale = tolerance(c);
    for (const Edge& e : edges) {
      const double out = e.r - c.radius, from = (out - middle) / scale, weight = 1 / (1 + from * from);
      const Eigen::Vector3d f(1, e.along_x, e.along_y);
      a += weight * f * f.transpose();
      right += weight * out * f;
    }
    const Eigen::Vector3d step = a.ldlt().solve(right);
    if (!step.allFinite()) return false;
    c.radius += step[0], c.x += step[1], c.y += step[2];
    return true;
  }

  const cv::Mat1f& grey_;
  const std::vector<Detection>& beads_;
  cv::Mat1b hidden_;
  double noise_;
};

/// The circles with most votes, in the picture itself.
std::vector<Circle> most_voted(const cv::Mat1f& grey, const std::vector<Detection>& beads, double diameter_px,
                               double scale, double noise) {
  constexpr double kRatio = 1.06;
  constexpr std::size_t kMost = 100;
  cv::Mat1f small = grey;
  if (scale > 1)
    cv::resize(grey, small, {cvRound(grey.cols / scale), cvRound(grey.rows / scale)}, 0, 0, cv::INTER_AREA);
  const Edges edges(small, explained_by(beads, small.size(), scale, kBesideBead_px), noise / scale);
  cv::Mat1b free(small.size(), 255);
  for (const Detection& b : beads)
    free(std::clamp(cvRound((b.y + 0.5) / scale - 0.5), 0, free.rows - 1),
         std::clamp(cvRound((b.x + 0.5) / scale - 0.5), 0, free.cols - 1)) = 0;
  cv::Mat1f centres;
  cv::distanceTransform(free, centres, cv::DIST_L2, cv::DIST_MASK_5);
  std::vector<Circle> all;
  const double largest = 0.5 * kLargest * std::min(small.cols, small.rows);
  for (double radius = 0.5 * kLarger * diameter_px / scale; radius < largest; radius *= kRatio) {
    throw_if_cancelled();
    for (const double sign : {-1.0, 1.0})
      for (const Circle& c : edges.circles(radius, sign, centres)) all.push_back(c);
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Circle& a, const Circle& b) { return a.votes > b.votes; });
  if (all.size() > kMost) all.resize(kMost);
  for (Circle& c : all) c = {(c.x + 0.5) * scale - 0.5, (c.y + 0.5) * scale - 0.5, c.radius * scale, c.sign};
  return all;
}

}  // namespace

std::vector<LargerDisc> larger_discs(const cv::Mat& grey, const std::vector<Detection>& beads,
                                     double diameter_px) {
  constexpr double kBead_px = 8, kSide_px = 500;       // in the reduced picture
  constexpr double kWithin = 0.08, kWithinPixels = 2;  // of the radius; of the reduced picture
  if (beads.empty() || std::min(grey.cols, grey.rows) < kLarger * diameter_px) return {};
  cv::Mat1f levels;
  grey.convertTo(levels, CV_32F);
  const double noise = noise_level(levels),
               scale = std::max({1.0, diameter_px / kBead_px, std::max(grey.cols, grey.rows) / kSide_px});
  const Rims rims(levels, beads, noise);
  std::vector<Circle> found;
  for (const Circle& c : most_voted(levels, beads, diameter_px, scale, noise))
    if (const auto rim = rims.fitted(c, kWithin * c.radius + kWithinPixels * scale);
        rim && 2 * rim->radius >= kLarger * diameter_px && rims.has_centre_of(*rim) &&
        !rims.has_beads(*rim) && !rims.is_full_of_edges(*rim, diameter_px))
      found.push_back(*rim);
  std::stable_sort(found.begin(), found.end(),
                   [](const Circle& a, const Circle& b) { return a.radius > b.radius; });
  std::vector<LargerDisc> discs;
  for (const Circle& c : found)
    if (std::none_of(discs.begin(), discs.end(), [&](const LargerDisc& d) {
          return std::hypot(d.x - c.x, d.y - c.y) < 0.5 * d.diameter_px + 0.5 * c.radius;
        }))
      discs.push_back({c.x, c.y, 2 * c.radius, c.sign > 0});
  return discs;
}

}  // namespace twincell::imaging
