#include "imaging/refine.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace twincell {

namespace {

using Normal = Eigen::Matrix<double, 5, 5>;  // x, y, R, a, l
using Step = Eigen::Matrix<double, 5, 1>;

constexpr double kHuber =
    0.1;  // darkness; the noise of a usable frame is below it, rims of clear beads above
constexpr double kMinInterior = 0.3;  // median darkness inside R/2 that a proposal must show
constexpr double kMissedDarkness =
    0.35;                     // mean residual of a disc that nobody proposed; half that of the palest tracer
constexpr double kReach = 4;  // beyond this many pixels from the rim P is 0 or 1
constexpr double kTypicalNoise = 0.03;  // darkness: weight of the priors against the data

struct Edge {
  double p;  // P
  double g;  // -dP/dr
};

Edge edge(double r, double radius, double s) {
  const double u = r - radius + 0.5 * s * s / radius;
  return {0.5 * std::erfc(u / (std::numbers::sqrt2 * s)),
          std::exp(-0.5 * u * u / (s * s)) / (std::sqrt(2 * std::numbers::pi) * s)};
}

// A bead's own contribution a P on its window, kept so that it can be taken out of the sum.
struct Patch {
  cv::Rect window;
  std::vector<float> values;
};

class PictureFit {
 public:
  PictureFit(const Prepared& image, double radius, const RefineOptions& options)
      : d_(image.darkness),
        background_(image.background),
        radius_(radius),
        options_(options),
        blur_(options.blur_px > 0 ? options.blur_px : 0.8),
        model_(cv::Mat1f::zeros(image.darkness.size())) {
    cv::dilate(image.opaque, excluded_, cv::Mat(), cv::Point(-1, -1), 2);
  }

  // A proposal that is bright inside is a void or a clear bead, one with its centre in a wall is the wall's
  // edge; fitted along, they would spoil their neighbours.
  void add(const Proposal& p) {
    Detection b;
    b.x = p.x;
    b.y = p.y;
    b.radius = radius_;
    b.darkness = 1;
    if (interior(b) < kMinInterior || in_wall(b)) return;
    beads_.push_back(b);
    patches_.push_back(draw(b));
    apply(patches_.back(), 1);
  }

  int sweep_until_still(int most) {
    for (int sweep = 1; sweep <= most; ++sweep) {
      const double moved = sweep_once();
      if (moved < options_.tolerance_px) return sweep;
    }
    return most;
  }

  // A disc that nobody proposed leaves a dark disc in the residual picture.
  std::size_t add_missed() {
    cv::Mat1f residual = d_ - model_;
    residual.setTo(0, excluded_);
    const int n = 2 * cvFloor(0.8 * radius_) + 1;
    cv::Mat1f disc = cv::Mat1f::zeros(n, n);
    cv::circle(disc, {n / 2, n / 2}, n / 2, 1, cv::FILLED);
    disc /= cv::sum(disc)[0];
    cv::Mat1f filled;
    cv::filter2D(residual, filled, CV_32F, disc, {-1, -1}, 0, cv::BORDER_REPLICATE);
    // Opaque discs do not overlap: a centre within 1.3 R of a known one is that one's own misfit.
    for (const Detection& b : beads_)
      cv::circle(filled, cv::Point(cvRound(b.x), cvRound(b.y)), cvRound(1.3 * radius_), 0, cv::FILLED);
    std::size_t added = 0;
    while (added < beads_.size() + 100) {
      double top = 0;
      cv::Point at;
      cv::minMaxLoc(filled, nullptr, &top, nullptr, &at);
      if (top < kMissedDarkness) break;
      cv::circle(filled, at, cvCeil(radius_), 0, cv::FILLED);
      add({static_cast<double>(at.x), static_cast<double>(at.y), 0});
      ++added;
    }
    return added;
  }

  std::vector<Detection> result() {
    for (std::size_t k = 0; k < beads_.size(); ++k) measure(k);
    return beads_;
  }
  [[nodiscard]] double blur() const { return blur_; }

 private:
  [[nodiscard]] cv::Rect window_of(const Detection& b) const {
    const double reach = b.radius + kReach;
    const cv::Rect r(cvFloor(b.x - reach), cvFloor(b.y - reach), 2 * cvCeil(reach) + 1,
                     2 * cvCeil(reach) + 1);
    return r & cv::Rect(0, 0, d_.cols, d_.rows);
  }
  [[nodiscard]] Patch draw(const Detection& b) const {
    Patch patch{window_of(b), {}};
    patch.values.reserve(static_cast<std::size_t>(patch.window.area()));
    for (int y = patch.window.y; y < patch.window.br().y; ++y)
      for (int x = patch.window.x; x < patch.window.br().x; ++x) {
        const double r = std::hypot(x - b.x, y - b.y);
        const double p = r < b.radius - kReach ? 1 : r > b.radius + kReach ? 0 : edge(r, b.radius, blur_).p;
        patch.values.push_back(static_cast<float>(b.darkness * p));
      }
    return patch;
  }
  void apply(const Patch& patch, float sign) {
    std::size_t i = 0;
    for (int y = patch.window.y; y < patch.window.br().y; ++y)
      for (int x = patch.window.x; x < patch.window.br().x; ++x) model_(y, x) += sign * patch.values[i++];
  }

  // Runs `use(residual, jacobian, dP/ds term, weight)` over the free pixels of bead k's ring; its own patch
  // must have been taken out of the model. Returns the share of the ring that was free.
  template <class Use>
  double over_ring(const Detection& b, Use&& use) const {
    const cv::Rect window = window_of(b);
    int free = 0;
    for (int y = window.y; y < window.br().y; ++y)
      for (int x = window.x; x < window.br().x; ++x) {
        const double dx = x - b.x, dy = y - b.y, r = std::hypot(dx, dy);
        if (std::abs(r - b.radius) > options_.ring_px || r == 0) continue;
        const double others = static_cast<double>(model_(y, x));
        if (excluded_(y, x) != 0 || others > 0.9) continue;  // hidden: tells nothing of this bead
        ++free;
        const Edge e = edge(r, b.radius, blur_);
        const double residual = static_cast<double>(d_(y, x)) - others - b.light - b.darkness * e.p;
        const double weight = std::abs(residual) <= kHuber ? 1 : kHuber / std::abs(residual);
        Step j;
        j << b.darkness * e.g * dx / r, b.darkness * e.g * dy / r, b.darkness * e.g, e.p, 1;
        use(residual, j, b.darkness * e.g * (r - b.radius) / blur_, weight);
      }
    return free / (2 * std::numbers::pi * b.radius * 2 * options_.ring_px);
  }

  [[nodiscard]] Normal prior() const {
    auto precision = [](double spread) { return std::pow(kTypicalNoise / spread, 2); };
    Step p;
    p << precision(2), precision(2), precision(options_.radius_spread * radius_), precision(0.3),
        precision(0.05);
    return p.asDiagonal();
  }

  double sweep_once() {
    double moved = 0, blur_gradient = 0, blur_curvature = 1e-9;
    for (std::size_t k = 0; k < beads_.size(); ++k) {
      Detection& b = beads_[k];
      apply(patches_[k], -1);
      Normal a = prior();
      Step g = Step::Zero();
      g[2] = a(2, 2) * (radius_ - b.radius);
      g[3] = a(3, 3) * (1 - b.darkness);
      g[4] = -a(4, 4) * b.light;
      over_ring(b, [&](double residual, const Step& j, double js, double w) {
        a.noalias() += w * j * j.transpose();
        g.noalias() += w * residual * j;
        blur_gradient += w * js * residual;
        blur_curvature += w * js * js;
      });
      const Step step = a.ldlt().solve(g);
      const double dx = std::clamp(step[0], -1.0, 1.0), dy = std::clamp(step[1], -1.0, 1.0);
      b.x += dx;
      b.y += dy;
      b.radius = std::clamp(b.radius + std::clamp(step[2], -0.5, 0.5), 0.6 * radius_, 1.4 * radius_);
      b.darkness = std::clamp(b.darkness + step[3], 0.0, 1.5);
      b.light = std::clamp(b.light + step[4], -0.5, 0.5);
      moved = std::max({moved, std::abs(dx), std::abs(dy)});
      patches_[k] = draw(b);
      apply(patches_[k], 1);
    }
    if (options_.blur_px <= 0 && !beads_.empty())
      blur_ = std::clamp(blur_ + std::clamp(blur_gradient / blur_curvature, -0.2, 0.2), 0.3, 3.0);
    return moved;
  }

  // Uncertainty, score and interior of bead k.
  void measure(std::size_t k) {
    Detection& b = beads_[k];
    apply(patches_[k], -1);
    Normal a = prior();
    double squares = 0, weights = 0, mean = 0, mean_square = 0;
    int n = 0;
    b.ring_share = over_ring(b, [&](double residual, const Step& j, double, double w) {
      a.noalias() += w * j * j.transpose();
      squares += w * residual * residual;
      weights += w;
      const double seen = residual + b.darkness * j[3];
      mean += seen;
      mean_square += seen * seen;
      ++n;
    });
    const double variance = n > 5 ? squares / (n - 5) : std::numeric_limits<double>::infinity();
    const Normal covariance = variance * a.inverse();
    b.sigma_x = std::sqrt(covariance(0, 0));
    b.sigma_y = std::sqrt(covariance(1, 1));
    b.sigma_radius = std::sqrt(covariance(2, 2));
    b.residual = n > 0 ? std::sqrt(squares / weights) : std::numeric_limits<double>::infinity();
    const double total = n > 0 ? mean_square - mean * mean / n : 0;
    b.score = total > 0 ? std::clamp(1 - squares / total, 0.0, 1.0) : 0;
    b.interior = interior(b);
    take_moments(b);
    apply(patches_[k], 1);
  }
  // Brightness and shape as trackpy's users know them, over the disc about its fitted centre.
  void take_moments(Detection& b) const {
    double xx = 0, xy = 0, yy = 0;
    const cv::Rect window = window_of(b);
    for (int y = window.y; y < window.br().y; ++y)
      for (int x = window.x; x < window.br().x; ++x) {
        const double dx = x - b.x, dy = y - b.y;
        if (dx * dx + dy * dy > b.radius * b.radius) continue;
        const double d = std::max(0.0, static_cast<double>(d_(y, x) - model_(y, x)));
        b.mass += d;
        b.raw_mass += d * static_cast<double>(background_(y, x));
        b.signal = std::max(b.signal, d);
        xx += d * dx * dx;
        xy += d * dx * dy;
        yy += d * dy * dy;
      }
    if (b.mass <= 0) return;
    b.size = std::sqrt((xx + yy) / b.mass);
    const double spread = std::hypot(xx - yy, 2 * xy), sum = xx + yy;
    b.ecc = sum + spread > 0 ? std::sqrt(2 * spread / (sum + spread)) : 0;
  }
  [[nodiscard]] bool in_wall(const Detection& b) const {
    const cv::Point at(cvRound(b.x), cvRound(b.y));
    return cv::Rect(0, 0, d_.cols, d_.rows).contains(at) && excluded_(at) != 0;
  }
  [[nodiscard]] double interior(const Detection& b) const {
    std::vector<float> inside;
    const cv::Rect window = window_of(b);
    for (int y = window.y; y < window.br().y; ++y)
      for (int x = window.x; x < window.br().x; ++x)
        if (std::hypot(x - b.x, y - b.y) <= std::max(0.5 * b.radius, 1.0)) inside.push_back(d_(y, x));
    if (inside.empty()) return b.darkness;  // centre outside the frame: the rim speaks for it
    const auto middle = inside.begin() + static_cast<std::ptrdiff_t>(inside.size() / 2);
    std::nth_element(inside.begin(), middle, inside.end());
    return static_cast<double>(*middle);
  }

  cv::Mat1f d_;
  cv::Mat1f background_;
  double radius_;
  RefineOptions options_;
  double blur_;
  cv::Mat1f model_;  // sum of all a P
  cv::Mat1b excluded_;
  std::vector<Detection> beads_;
  std::vector<Patch> patches_;
};

}  // namespace

Refined refine(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
               const RefineOptions& options) {
  PictureFit fit(image, radius_px, options);
  for (const Proposal& p : proposals) fit.add(p);
  int sweeps = fit.sweep_until_still(std::min(4, options.sweeps));
  fit.add_missed();
  sweeps += fit.sweep_until_still(std::max(0, options.sweeps - sweeps));
  return {fit.result(), fit.blur(), sweeps};
}

}  // namespace twincell
