#include "imaging/refine/overlapping_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <queue>
#include <utility>

#include "core/cancellation.hpp"
#include "core/median.hpp"
#include "imaging/refine/disc_measures.hpp"
#include "imaging/refine/residual_correlation.hpp"
#include "imaging/refine/sparse_gauss_newton.hpp"

namespace twincell::imaging {

namespace {

constexpr double kEdgeReach = 3.5;    // blurs beyond R at which a disc ends
constexpr double kMinGain = 0.1;      // fraction of the squared darkness of a whole disc
constexpr double kMisplaced = 0.3;    // the same, lost by a disc that is not in its place yet
constexpr double kMinSeen = 1.0 / 6;  // of the rim

double square(double a) {
  return a * a;
}

/// The blurred edge P at a distance from the centre, and its derivative.
struct Edge {
  double value, slope;
};
Edge edge_at(double r, double radius, double blur) {
  const double u = r - radius + blur * blur / (2 * radius), z = u / blur;
  return {0.5 * std::erfc(z / std::numbers::sqrt2),
          -std::exp(-0.5 * z * z) / (blur * std::sqrt(2 * std::numbers::pi))};
}

/// The discs of a frame and the picture they are fitted to.
class Layers {
 public:
  Layers(const Prepared& image, double radius_px, const RefineOptions& options)
      : d_(image.darkness),
        opaque_(image.opaque),
        unit_(image.unit),
        radius_(radius_px),
        spread_(kRadiusSpread),
        noise_(noise_of(image.darkness)),
        blur_(options.blur_px > 0 ? options.blur_px : blur_of(image.darkness)),
        blur_is_fixed_(options.blur_px > 0) {
    huber_ = std::max(0.1, 4 * std::sqrt(noise_.dark + noise_.light));
  }

  void expect_darkness(double a) { darkness_ = a; }
  [[nodiscard]] const std::vector<Disc>& discs() const { return discs_; }
  [[nodiscard]] double blur() const { return blur_; }

  /// Takes proposals, the one that explains most first. \returns how many
  std::size_t take(const std::vector<Proposal>& proposals) {
    render();
    std::priority_queue<std::pair<double, std::size_t>> open;
    std::vector<Disc> wanted;
    for (const Proposal& p : proposals) {
      wanted.push_back({p.x, p.y, p.radius > 0 ? p.radius : radius_, darkness_});
      open.push({HUGE_VAL, wanted.size() - 1});
    }
    std::vector<bool> settled(wanted.size(), false);
    std::size_t taken = 0;
    while (!open.empty()) {
      const auto [before, k] = open.top();
      open.pop();
      Disc& disc = wanted[k];
      const double gain = gain_of(disc);
      const double least = kMinGain * whole(disc);
      // Before it is placed, a disc may seem to explain nothing.
      if (gain < (settled[k] ? least : -kMisplaced * whole(disc))) continue;
      if (!open.empty() && gain < open.top().first) {
        open.push({gain, k});
        continue;
      }
      if (!settled[k]) {
        place(disc);
        settled[k] = true;
        open.push({gain_of(disc), k});
        continue;
      }
      discs_.push_back(disc);
      darken(disc);
      ++taken;
    }
    return taken;
  }

  /// Places of discs around what the discs do not explain: votes of discs behind others are few, and those of
  /// small discs merge. The centre of a crescent is not that of its disc, so that all places within a radius
  /// are proposed.
  [[nodiscard]] std::vector<Proposal> unexplained() {
    constexpr double kDark = 0.25;                 // of a disc
    constexpr double kWindow = 0.3, kStep = 0.25;  // radii
    render();
    cv::Mat1f left(d_.size(), 0.0F);
    for (int y = 0; y < left.rows; ++y)
      for (int x = 0; x < left.cols; ++x)
        if (opaque_.empty() || opaque_(y, x) == 0)
          left(y, x) = d_(y, x) - (1 - clear_(y, x)) / static_cast<float>(unit_);
    const int half = std::max(1, cvRound(kWindow * radius_));
    cv::Mat1f mean, highest;
    cv::boxFilter(left, mean, CV_32F, {2 * half + 1, 2 * half + 1}, {-1, -1}, true, cv::BORDER_CONSTANT);
    cv::dilate(mean, highest, cv::Mat1b(2 * half + 1, 2 * half + 1, uchar{1}));
    const double step = std::max(1.0, kStep * radius_);
    std::vector<Proposal> all;
    for (int y = 0; y < mean.rows; ++y)
      for (int x = 0; x < mean.cols; ++x) {
        if (mean(y, x) < highest(y, x) || static_cast<double>(mean(y, x)) < kDark * darkness_) continue;
        const int reach = cvFloor(radius_ / step);
        for (int j = -reach; j <= reach; ++j)
          for (int i = -reach; i <= reach; ++i)
            if (i * i + j * j <= reach * reach) all.push_back({x + i * step, y + j * step, 0, radius_});
      }
    return all;
  }

  /// One Gauss-Newton step of each disc in turn, and of the blur. \param common radius and darkness are those
  /// of all discs. Two discs whose centres are near would otherwise become a single large one. \returns the
  /// largest displacement, px
  double sweep(bool common) {
    const std::vector<std::vector<std::size_t>> near = neighbours();
    double largest = 0, blur_right = 0, blur_normal = 0;
    sums_.assign(discs_.size(), {});
    for (std::size_t k = 0; k < discs_.size(); ++k) {
      Sums s = sums_of(discs_[k], near[k], blur_);
      blur_right += s.blur_right, blur_normal += s.blur_normal;
      Normal a = s.normal;
      Step g = s.right;
      a(kR, kR) += 1 / square(spread_ * radius_);
      g[kR] -= (discs_[k].radius - mean_radius()) / square(spread_ * radius_);
      a(kA, kA) += 1 / square(darkness_spread_);
      g[kA] -= (discs_[k].darkness - darkness_) / square(darkness_spread_);
      constexpr double kFixed = 1e15;
      if (common) a(kR, kR) += kFixed, a(kA, kA) += kFixed;
      a.diagonal().array() += 1e-9 * (1 + a.diagonal().array());
      const Step step = a.ldlt().solve(g);
      const double most = std::max(0.5, 0.15 * radius_);
      Disc& disc = discs_[k];
      const double dx = std::clamp(step[kX], -most, most), dy = std::clamp(step[kY], -most, most);
      disc.x += dx, disc.y += dy;
      disc.radius = std::clamp(disc.radius + std::clamp(step[kR], -most, most), 0.6 * radius_, 1.5 * radius_);
      disc.darkness = std::clamp(disc.darkness + step[kA], 0.2 * darkness_, 1.5 * darkness_);
      s.normal = a;
      sums_[k] = s;
      largest = std::max(largest, std::hypot(dx, dy));
    }
    if (!blur_is_fixed_ && blur_normal > 0)
      blur_ = std::clamp(blur_ + std::clamp(blur_right / blur_normal, -0.2, 0.2), 0.4, 5.0);
    return largest;
  }

  /// Narrows the priors to the scatter of the discs of which most is seen.
  void learn() {
    constexpr double kMinSeenToLearn = 0.8;  // of the rim
    constexpr std::size_t kMinDiscs = 6;
    constexpr double kMinRadiusSpread = 0.003, kMinDarknessSpread = 0.01;  // fraction of R; darkness
    std::vector<double> radii, levels;
    for (std::size_t k = 0; k < discs_.size(); ++k)
      if (sums_[k].seen > kMinSeenToLearn)
        radii.push_back(discs_[k].radius), levels.push_back(discs_[k].darkness);
    if (radii.size() < kMinDiscs) return;
    found_radius_ = upper_median(radii);
    spread_ = std::max(kMinRadiusSpread, robust_spread(radii, found_radius_) / radius_);
    darkness_ = upper_median(levels);
    darkness_spread_ = std::max(kMinDarknessSpread, robust_spread(levels, darkness_));
  }

  /// Removes the discs that explain too little, the least first. \returns how many
  std::size_t prune() {
    std::size_t pruned = 0;
    for (;;) {
      const std::vector<std::vector<std::size_t>> near = neighbours();
      std::vector<std::pair<double, std::size_t>> weak;
      for (std::size_t k = 0; k < discs_.size(); ++k)
        if (const double share = own_gain(k, near[k]) / whole(discs_[k]); share < kMinGain)
          weak.emplace_back(share, k);
      if (weak.empty()) return pruned;
      std::sort(weak.begin(), weak.end());
      // A disc that goes gives its pixels to those it overlaps, which are then judged anew.
      std::vector<bool> gone(discs_.size(), false), kept(discs_.size(), false);
      for (const auto& [share, k] : weak) {
        if (kept[k]) continue;
        gone[k] = true;
        for (const std::size_t j : near[k]) kept[j] = true;
      }
      std::vector<Disc> left;
      for (std::size_t k = 0; k < discs_.size(); ++k)
        if (!gone[k]) left.push_back(discs_[k]);
      pruned += discs_.size() - left.size();
      discs_ = std::move(left);
    }
  }

  /// Replaces discs that are clearly larger than the others by two, where those describe the picture better.
  /// \returns whether any was
  bool split() {
    constexpr double kMinRadiusRatio = 1.06;  // of a disc to be split to the mean radius
    constexpr double kMinImprovement = 0.01;  // fraction of the squared darkness of a whole disc
    constexpr int kDirections = 16;
    const double r = mean_radius();
    const std::vector<std::vector<std::size_t>> near = neighbours();
    const std::size_t n = discs_.size();
    bool any = false;
    for (std::size_t k = 0; k < n; ++k) {
      const Disc large = discs_[k];
      if (large.radius < kMinRadiusRatio * r) continue;
      // Two discs at this distance cover the area of the large one.
      const double apart = std::numbers::pi * (square(large.radius) - square(r)) / (2 * r);
      const auto left = [&](const std::vector<Disc>& own) {
        double squares = 0;
        over(large, large.radius + apart + kEdgeReach * blur_, [&](int x, int y, double) {
          double clear = clear_of(near[k], x, y);
          for (const Disc& o : own)
            clear *= 1 - unit_ * o.darkness * edge_at(std::hypot(x - o.x, y - o.y), o.radius, blur_).value;
          squares += square(static_cast<double>(d_(y, x)) - (1 - clear) / unit_);
        });
        return squares;
      };
      double least = left({large}) - kMinImprovement * whole(large);
      std::vector<Disc> best;
      for (int direction = 0; direction < kDirections; ++direction) {
        const double turn = std::numbers::pi * direction / kDirections;
        const double dx = 0.5 * apart * std::cos(turn), dy = 0.5 * apart * std::sin(turn);
        std::vector<Disc> two{{large.x + dx, large.y + dy, r, darkness_},
                              {large.x - dx, large.y - dy, r, darkness_}};
        if (const double squares = left(two); squares < least) least = squares, best = std::move(two);
      }
      if (best.empty()) continue;
      discs_[k] = best[0];
      discs_.push_back(best[1]);
      any = true;
    }
    return any;
  }

  /// The fitted discs with their uncertainties. \pre a sweep since the last change
  [[nodiscard]] std::vector<Detection> detections() const {
    constexpr double kWhole = 0.95;  // of the rim
    std::vector<RimHarmonics> rims;
    for (const Sums& s : sums_)
      if (s.seen > kWhole) rims.push_back(s.rim), rims.back().excess = s.excess();
    const double rho = residual_correlation(rims);
    std::vector<Detection> found;
    for (std::size_t k = 0; k < discs_.size(); ++k) {
      const Sums& s = sums_[k];
      Detection b;
      b.x = discs_[k].x, b.y = discs_[k].y, b.radius = discs_[k].radius, b.darkness = discs_[k].darkness;
      const Normal covariance = s.normal.inverse() * s.excess();
      b.sigma_x = std::sqrt(rho * covariance(kX, kX)), b.sigma_y = std::sqrt(rho * covariance(kY, kY));
      b.sigma_radius = std::sqrt(covariance(kR, kR));
      b.residual = s.shown > 0 ? std::sqrt(s.squares / s.shown) : 0;
      b.ring_share = s.seen;
      const double spread = s.shown > 0 ? s.own_squares - square(s.own) / s.shown : 0;
      b.score = spread > 0 ? std::clamp(1 - s.squares / spread, 0.0, 1.0) : 0;
      found.push_back(b);
    }
    return found;
  }

 private:
  struct Sums {
    Normal normal = Normal::Zero();
    Step right = Step::Zero();
    double blur_right = 0, blur_normal = 0;
    double pixels = 0, weighted = 0;  // of the ring; residuals over their variance
    double shown = 0, squares = 0;    // by what the others transmit
    double own = 0, own_squares = 0;  // the picture less the other discs
    double seen = 0;                  // part of the rim that is not hidden
    RimHarmonics rim;

    /// Where the model does not describe the picture, the residual is more than the noise.
    [[nodiscard]] double excess() const {
      return std::max(1.0, pixels > kFitted + 1 ? weighted / (pixels - kFitted) : 1.0);
    }
  };

  [[nodiscard]] double mean_radius() const { return found_radius_ > 0 ? found_radius_ : radius_; }
  /// Squared darkness, summed over its area, of a disc that no other overlaps, px^2.
  [[nodiscard]] double whole(const Disc& disc) const {
    return std::numbers::pi * square(disc.radius * darkness_);
  }
  [[nodiscard]] double ring() const { return std::max(2.5, 3 * blur_); }

  /// Calls use(x, y, r) for the visible pixels within a reach of a centre.
  template <class Use>
  void over(const Disc& disc, double reach, Use&& use) const {
    for (int y = std::max(0, cvCeil(disc.y - reach)); y <= std::min(d_.rows - 1, cvFloor(disc.y + reach));
         ++y) {
      const double dy = y - disc.y, half = std::sqrt(std::max(0.0, reach * reach - dy * dy));
      for (int x = std::max(0, cvCeil(disc.x - half)); x <= std::min(d_.cols - 1, cvFloor(disc.x + half));
           ++x)
        if (opaque_.empty() || opaque_(y, x) == 0) use(x, y, std::hypot(x - disc.x, dy));
    }
  }

  void darken(const Disc& disc) {
    over(disc, disc.radius + kEdgeReach * blur_, [&](int x, int y, double r) {
      clear_(y, x) *= static_cast<float>(1 - unit_ * disc.darkness * edge_at(r, disc.radius, blur_).value);
    });
  }
  void render() {
    clear_ = cv::Mat1f(d_.size(), 1.0F);
    for (const Disc& disc : discs_) darken(disc);
  }

  /// By how much a further disc lessens the squares of the residuals.
  [[nodiscard]] double gain_of(const Disc& disc) const {
    double gain = 0;
    over(disc, disc.radius + kEdgeReach * blur_, [&](int x, int y, double r) {
      const auto clear = static_cast<double>(clear_(y, x)), d = static_cast<double>(d_(y, x));
      const double shaded = clear * (1 - unit_ * disc.darkness * edge_at(r, disc.radius, blur_).value);
      gain += square(d - (1 - clear) / unit_) - square(d - (1 - shaded) / unit_);
    });
    return gain;
  }
  /// The same of a disc of the frame.
  [[nodiscard]] double own_gain(std::size_t k, const std::vector<std::size_t>& near) const {
    const Disc& disc = discs_[k];
    double gain = 0;
    over(disc, disc.radius + kEdgeReach * blur_, [&](int x, int y, double r) {
      const double clear = clear_of(near, x, y), d = static_cast<double>(d_(y, x));
      const double shaded = clear * (1 - unit_ * disc.darkness * edge_at(r, disc.radius, blur_).value);
      gain += square(d - (1 - clear) / unit_) - square(d - (1 - shaded) / unit_);
    });
    return gain;
  }

  /// Share of the light that other discs transmit to a pixel.
  [[nodiscard]] double clear_of(const std::vector<std::size_t>& near, int x, int y) const {
    double clear = 1;
    for (const std::size_t j : near) {
      const Disc& o = discs_[j];
      const double reach = o.radius + kEdgeReach * blur_, r2 = square(x - o.x) + square(y - o.y);
      if (r2 < reach * reach) clear *= 1 - unit_ * o.darkness * edge_at(std::sqrt(r2), o.radius, blur_).value;
    }
    return clear;
  }

  [[nodiscard]] std::vector<std::vector<std::size_t>> neighbours() const {
    std::vector<std::vector<std::size_t>> near(discs_.size());
    for (const auto& [i, j] : near_pairs(discs_, 2 * (kEdgeReach * blur_ + 1))) {
      near[static_cast<std::size_t>(i)].push_back(static_cast<std::size_t>(j));
      near[static_cast<std::size_t>(j)].push_back(static_cast<std::size_t>(i));
    }
    return near;
  }

  /// Sums over the ring of a disc. \param clear(x, y) what other discs transmit
  template <class Clear>
  [[nodiscard]] Sums ring_sums_of(const Disc& disc, double blur, double half, Clear&& clear) const {
    Sums s;
    double full = 0;
    over(disc, disc.radius + half, [&](int x, int y, double r) {
      if (r < disc.radius - half) return;
      const double others = clear(x, y), d = static_cast<double>(d_(y, x));
      const Edge edge = edge_at(r, disc.radius, blur);
      const double shaded = others * (1 - unit_ * disc.darkness * edge.value);
      const double residual = d - (1 - shaded) / unit_;
      // Where two rims cross or touch, the blurred union is not the product of blurred discs.
      const double hidden = (1 - others) / unit_,
                   model = edge.value * (1 - edge.value) * hidden * (1 - hidden);
      const double variance = noise_.dark + noise_.light * std::clamp(1 - (1 - shaded) / unit_, 0.0, 1.0) +
                              square(disc.darkness) * std::max(0.0, model);
      const double weight = std::min(1.0, huber_ / std::max(std::abs(residual), 1e-12)) / variance;
      const double by_edge = disc.darkness * others * edge.slope, from = std::max(r, 1e-6);
      Step j;
      j[kX] = -by_edge * (x - disc.x) / from;
      j[kY] = -by_edge * (y - disc.y) / from;
      j[kR] = -by_edge;
      j[kA] = others * edge.value;
      s.normal.noalias() += weight * j * j.transpose();
      s.right += weight * residual * j;
      const double by_blur = -by_edge * (r - disc.radius) / blur;
      s.blur_right += weight * by_blur * residual, s.blur_normal += weight * by_blur * by_blur;
      if (r > 0)
        s.rim.add((x - disc.x) / r, (y - disc.y) / r, by_edge, 1 / variance,
                  std::clamp(residual, -huber_, huber_));
      ++s.pixels;
      s.weighted += weight * residual * residual;
      const double shown = others * others, own = d - (1 - others) / unit_;
      s.shown += shown;
      s.squares += shown * residual * residual;
      s.own += shown * own, s.own_squares += shown * own * own;
      full += square(edge.slope), s.seen += square(others * edge.slope);
    });
    s.seen = full > 0 ? s.seen / full : 0;
    return s;
  }
  [[nodiscard]] Sums sums_of(const Disc& disc, const std::vector<std::size_t>& near, double blur) const {
    return ring_sums_of(disc, blur, ring(), [&](int x, int y) { return clear_of(near, x, y); });
  }

  /// Moves a disc that is not taken yet to where the picture shows it. A wide blur lets it come from afar.
  void place(Disc& disc) const {
    for (const double wide : {0.12, 0.06, 0.0}) {
      const double blur = std::max(blur_, wide * disc.radius);
      for (int step = 0; step < 3; ++step) {
        const Sums s = ring_sums_of(disc, blur, std::max(2.5, 3 * blur),
                                    [&](int x, int y) { return static_cast<double>(clear_(y, x)); });
        Eigen::Matrix2d a = s.normal.topLeftCorner<2, 2>();
        a.diagonal().array() += 1e-3 * a.trace() + 1e-9;
        const Eigen::Vector2d move = a.ldlt().solve(s.right.head<2>());
        const double most = 0.1 * disc.radius;
        disc.x += std::clamp(move[0], -most, most), disc.y += std::clamp(move[1], -most, most);
      }
    }
  }

  const cv::Mat1f& d_;
  const cv::Mat1b& opaque_;
  double unit_;  // c
  double radius_, spread_, found_radius_ = 0;
  double darkness_ = 1, darkness_spread_ = 0.1;
  Noise noise_;
  double blur_, huber_;
  bool blur_is_fixed_;
  std::vector<Disc> discs_;
  std::vector<Sums> sums_;
  cv::Mat1f clear_;  // share of the light that the discs transmit
};

/// Darkness of a disc: that of most proposals' insides, which lie in a disc or in two.
double darkness_of(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px) {
  constexpr double kMinDarkness = 0.1;
  std::vector<double> inside;
  for (const Proposal& p : proposals) {
    Detection b;
    b.x = p.x, b.y = p.y, b.radius = p.radius > 0 ? p.radius : radius_px;
    if (const double v = rough_interior(image, b); v >= kMinDarkness && !in_wall(image, b))
      inside.push_back(v);
  }
  if (inside.empty()) return 0;
  // The lower quarter: a disc that does not overlap.
  const auto at = inside.begin() + static_cast<std::ptrdiff_t>(inside.size() / 4);
  std::nth_element(inside.begin(), at, inside.end());
  return *at;
}

}  // namespace

Refined refine_overlapping(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
                           const RefineOptions& options) {
  constexpr int kRounds = 4, kFirstSweeps = 4;
  Refined result;
  const double darkness = darkness_of(image, proposals, radius_px);
  if (darkness <= 0) return result;
  Layers layers(image, radius_px, options);
  layers.expect_darkness(darkness);
  for (int round = 0; round < kRounds; ++round) {
    throw_if_cancelled();
    const std::size_t taken = layers.take(round == 0 ? proposals : layers.unexplained());
    if (taken == 0 && round > 0) break;
    for (int sweep = 0; sweep < kFirstSweeps; ++sweep) layers.sweep(true);
    layers.prune();
  }
  const auto fit = [&] {
    for (result.sweeps = 0; result.sweeps < options.sweeps; ++result.sweeps) {
      throw_if_cancelled();
      if (layers.sweep(false) < kRefineTolerance_px && result.sweeps > 0) break;
      layers.learn();
    }
  };
  fit();
  if (layers.split()) {
    for (int sweep = 0; sweep < kFirstSweeps; ++sweep) layers.sweep(true);
    layers.prune();
    fit();
  }
  for (Detection& b : layers.detections()) {
    measure_disc(image, b);
    if (b.ring_share < kMinSeen) {
      b.verdict = Verdict::unseen;
      result.dropped.push_back(b);
    } else {
      result.beads.push_back(b);
    }
  }
  result.blur_px = layers.blur();
  return result;
}

}  // namespace twincell::imaging
