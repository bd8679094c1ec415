#include "imaging/refine/profile_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "core/cancellation.hpp"
#include "core/median.hpp"
#include "imaging/refine/disc_measures.hpp"
#include "imaging/refine/highlight_spot.hpp"
#include "imaging/refine/profile_likeness.hpp"
#include "imaging/refine/residual_correlation.hpp"
#include "imaging/refine/sparse_gauss_newton.hpp"

namespace twincell::imaging {

namespace {

constexpr double kReach = 3;            // px outside the radius at which the outer rim has ended
constexpr int kLearningRounds = 2;      // rounds of learning the profile and searching for similar discs
constexpr int kRounds = 3;              // rounds of fitting and learning
constexpr int kSweeps = 4;              // sweeps in a round
constexpr double kSettled = 2e-3;       // displacement at which a round ends, px
constexpr double kMinScore = 0.5;       // as the judge requires
constexpr double kMinLevel = 0.4;       // smallest a, as the opaque fit requires
constexpr double kRadiusSpread = 0.04;  // prior scatter of R_k, as a fraction of R
constexpr double kLevelSpread = 0.1;    // prior scatter of a_k
constexpr double kDoubled = 0.5;        // in R: centres closer than that belong to one disc
constexpr double kLike = 0.4;           // smallest correlation of a proposed disc with the profile
constexpr double kApart = 1.6;          // in R: no disc is proposed closer to another, as in the vote

/// The fit of one frame: discs, profile and model picture.
class ProfileFit {
 public:
  ProfileFit(const Prepared& image, double radius)
      : image_(image), radius_(radius), noise_(noise_of(image.darkness)) {
    const double deviation = std::sqrt(noise_.dark + noise_.light);
    huber_ = std::max(0.1, 4 * deviation);
    shared_.radius_px = radius;
    shared_.levels.assign(static_cast<std::size_t>(std::ceil((radius + kReach) * DiscProfile::kPerPixel)) + 1,
                          0.0F);
    model_ = cv::Mat1f::zeros(image.darkness.size());
    taken_.create(image.darkness.rows + 2 * reach(), image.darkness.cols + 2 * reach());
  }

  void start(const std::vector<Proposal>& proposals) {
    for (const Proposal& p : proposals) {
      Detection b;
      b.x = p.x, b.y = p.y, b.radius = radius_, b.darkness = 1, b.score = p.score;
      if (in_wall(image_, b)) {
        b.verdict = Verdict::in_wall;
        dropped_.push_back(b);
      } else {
        beads_.push_back(b);
      }
    }
  }

  /// Learns f and g from the discs with a score of at least `least` and renders the model.
  void learn(double least) {
    const auto n = static_cast<Eigen::Index>(shared_.levels.size());  // unknowns; the last is g
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    // Terms: the coefficient of each level in each pixel, over all discs that reach it. They are collected
    // disc by disc, then sorted by pixel.
    struct Term {
      std::size_t row;
      int level;
      double share;
    };
    std::vector<Term> seen;
    cv::Mat1i of_pixel(image_.darkness.size(), -1);
    std::vector<cv::Point> pixels;
    const int last = static_cast<int>(n) - 1;
    for (const Detection& b : beads_) {
      if (b.score < least) continue;
      over(b, [&](int x, int y, double r) {
        const double t = r * radius_ / b.radius * DiscProfile::kPerPixel;
        const auto k = static_cast<int>(t);
        if (k >= last) return;
        int& row = of_pixel(y, x);
        if (row < 0) {
          row = static_cast<int>(pixels.size());
          pixels.emplace_back(x, y);
        }
        const double part = t - k;
        seen.push_back({static_cast<std::size_t>(row), k, b.darkness * (1 - part)});
        if (k + 1 < last) seen.push_back({static_cast<std::size_t>(row), k + 1, b.darkness * part});
      });
    }
    std::vector<std::size_t> first(pixels.size() + 1, 0);
    for (const Term& t : seen) ++first[t.row + 1];
    for (std::size_t row = 0; row < pixels.size(); ++row) first[row + 1] += first[row];
    std::vector<Term> terms(seen.size());
    std::vector<std::size_t> at(first.begin(), first.end());
    for (const Term& t : seen) terms[at[t.row]++] = t;
    const cv::Mat1f spots = picture_of_spots();
    // Normal equations, with Huber weights once a profile is known.
    std::vector<Term> of_one;
    for (std::size_t row = 0; row < pixels.size(); ++row) {
      of_one.assign(terms.begin() + static_cast<std::ptrdiff_t>(first[row]),
                    terms.begin() + static_cast<std::ptrdiff_t>(first[row + 1]));
      of_one.push_back({row, last, 1});
      double d = static_cast<double>(image_.darkness(pixels[row]));
      if (!spots.empty()) d -= static_cast<double>(spots(pixels[row]));
      double weight = 1;
      if (learnt_) {
        double now = 0;
        for (const Term& t : of_one)
          now += t.share * (t.level == last
                                ? shared_.ground
                                : static_cast<double>(shared_.levels[static_cast<std::size_t>(t.level)]));
        weight = std::min(1.0, huber_ / std::max(1e-9, std::abs(d - now)));
      }
      for (const Term& t : of_one) {
        right[t.level] += weight * t.share * d;
        for (const Term& u : of_one) a(t.level, u.level) += weight * t.share * u.share;
      }
    }
    // Regularisation: levels in few pixels, as at the centre, follow their neighbours.
    const double smooth = 0.02 * static_cast<double>(pixels.size()) / static_cast<double>(n);
    for (Eigen::Index k = 1; k + 2 < n; ++k) {
      a(k - 1, k - 1) += smooth, a(k, k) += smooth;
      a(k - 1, k) -= smooth, a(k, k - 1) -= smooth;
    }
    a(n - 2, n - 2) += 100 * smooth;  // 0 where the disc has ended
    a.diagonal().array() += 1e-9 * static_cast<double>(pixels.size() + 1);
    const Eigen::VectorXd solved = a.ldlt().solve(right);
    for (Eigen::Index k = 0; k + 1 < n; ++k)
      shared_.levels[static_cast<std::size_t>(k)] = static_cast<float>(solved[k]);
    shared_.levels.back() = 0;
    shared_.ground = solved[n - 1];
    learnt_ = true;
    render();
  }

  /// One step of each disc, with all others fixed.
  /// \returns the largest displacement, px, without the worst 2 % of the discs
  double sweep() {
    throw_if_cancelled();
    std::vector<double> far;
    far.reserve(beads_.size());
    covariance_.resize(beads_.size());
    for (std::size_t k = 0; k < beads_.size(); ++k) far.push_back(step(beads_[k], covariance_[k]));
    if (far.empty()) return 0;
    const auto most = static_cast<std::ptrdiff_t>(far.size() - 1 - far.size() / 50);
    std::nth_element(far.begin(), far.begin() + most, far.end());
    return far[static_cast<std::size_t>(most)];
  }

  /// Drops discs that the profile does not explain and, of two centres in one disc, the worse one.
  void prune() {
    std::vector<Disc> discs;
    std::vector<bool> stays(beads_.size(), true);
    for (std::size_t k = 0; k < beads_.size(); ++k) {
      Detection& b = beads_[k];
      b.score = explained(b);
      discs.push_back({b.x, b.y, b.radius, 1});
      const bool inside = b.x > -radius_ && b.y > -radius_ && b.x < image_.darkness.cols - 1 + radius_ &&
                          b.y < image_.darkness.rows - 1 + radius_;
      if (b.darkness < kMinLevel) stays[k] = false, b.verdict = Verdict::pale;
      if (b.score < kMinScore) stays[k] = false, b.verdict = Verdict::unexplained;
      if (!inside) stays[k] = false, b.verdict = Verdict::outside;
    }
    for (const auto& [i, j] : near_pairs(discs, 0)) {
      const auto p = static_cast<std::size_t>(i), q = static_cast<std::size_t>(j);
      if (!stays[p] || !stays[q] ||
          std::hypot(discs[p].x - discs[q].x, discs[p].y - discs[q].y) > 2 * radius_ * (1 - kDoubled / 2))
        continue;
      const std::size_t lesser = beads_[p].score < beads_[q].score ? p : q;
      stays[lesser] = false;
      beads_[lesser].verdict = Verdict::overlaps;
    }
    std::vector<Detection> kept;
    for (std::size_t k = 0; k < beads_.size(); ++k) (stays[k] ? kept : dropped_).push_back(beads_[k]);
    if (kept.size() == beads_.size()) return;
    beads_ = std::move(kept);
    render();
  }

  /// Replaces the discs by the positions that resemble the profile. In a packing, votes are off by a pixel or
  /// two, which no step corrects, and they miss discs that are surrounded by the rims of their neighbours.
  /// The correlation with the profile uses all pixels of a disc instead. A voted disc without a similar
  /// position nearby, for example outside the frame, is kept but not used for learning.
  void propose_similar() {
    std::vector<Detection> voted;
    std::swap(voted, beads_);
    taken_.setTo(0);
    add_similar(image_.darkness);
    for (Detection& b : voted) {
      if (taken(b)) continue;
      b.score = 0;
      beads_.push_back(b);
    }
    render();
  }

  /// Adds the positions where the residual picture resembles the profile.
  void add_missed() {
    taken_.setTo(0);
    for (const Detection& b : beads_) take(b);
    const std::size_t before = beads_.size();
    add_similar(image_.darkness - model_);
    if (beads_.size() > before) render();
  }

  [[nodiscard]] double typical_score() const {
    std::vector<double> scores;
    for (const Detection& b : beads_) scores.push_back(b.score);
    return scores.empty() ? 0 : upper_median(std::move(scores));
  }

  /// Moves the centres of all discs by the same vector, to the middle of their rims, if a highlight beside
  /// the middle attracted them. The vector is measured on kSome of the discs. Then the spot is learnt, so
  /// that no disc is drawn to it by more than the others.
  void centre_at_rims() {
    constexpr int kSpotRounds = 2, kSpotSweeps = 2;
    const cv::Rect area = area_of_some();
    Prepared image;
    image.darkness = image_.darkness(area).clone();
    const std::optional<cv::Point2d> shift = ProfileFit(image, *this, area).shift_to_rims();
    if (!shift) return;
    move_and_learn(*shift);
    for (int round = 0; round < kSpotRounds; ++round) {
      learn_spot();
      for (int k = 0; k < kSpotSweeps; ++k) sweep();
      learn(kMinScore);
      move_and_learn(ProfileFit(image, *this, area).vertex_at({}));
    }
  }

  Refined result(int sweeps) {
    const double rho = correlation();
    for (std::size_t k = 0; k < beads_.size(); ++k) {
      Detection& b = beads_[k];
      const Normal& c = covariance_[k];
      b.sigma_x = std::sqrt(rho * c(0, 0));
      b.sigma_y = std::sqrt(rho * c(1, 1));
      b.sigma_radius = std::sqrt(c(2, 2));
      measure_disc(image_, b);
    }
    return {std::move(beads_), std::move(dropped_), 0, {}, sweeps};
  }
  [[nodiscard]] const DiscProfile& profile() const { return shared_; }
  [[nodiscard]] bool empty() const { return beads_.empty(); }

 private:
  /// The fit of the discs that reach an area of the frame.
  /// \param image the area of the frame
  ProfileFit(const Prepared& image, const ProfileFit& whole, const cv::Rect& area)
      : image_(image),
        radius_(whole.radius_),
        noise_(whole.noise_),
        huber_(whole.huber_),
        shared_(whole.shared_),
        learnt_(whole.learnt_),
        model_(area.size()),
        spot_(whole.spot_) {
    for (Detection b : whole.beads_) {
      b.x -= area.x, b.y -= area.y;
      const double reach = b.radius + kReach;
      if (b.x > -reach && b.y > -reach && b.x < area.width - 1 + reach && b.y < area.height - 1 + reach)
        beads_.push_back(b);
    }
  }

  /// A part of the frame, about the middle of the discs, in which lie kSome of them; the frame if there are
  /// fewer.
  [[nodiscard]] cv::Rect area_of_some() const {
    constexpr std::size_t kSome = 100;  // the common vector is ten times as accurate as the centre of a disc
    const cv::Rect frame({}, image_.darkness.size());
    if (beads_.size() <= kSome) return frame;
    std::vector<double> across, along, far;
    for (const Detection& b : beads_) across.push_back(b.x), along.push_back(b.y);
    const double x = upper_median(across), y = upper_median(along);
    for (const Detection& b : beads_)
      far.push_back(std::max(std::abs(b.x - x) / frame.width, std::abs(b.y - y) / frame.height));
    std::nth_element(far.begin(), far.begin() + kSome, far.end());
    const double half = far[kSome];
    const cv::Point first(cvFloor(x - half * frame.width), cvFloor(y - half * frame.height)),
        last(cvCeil(x + half * frame.width), cvCeil(y + half * frame.height));
    return cv::Rect(first, last + cv::Point(1, 1)) & frame;
  }

  void move_and_learn(const cv::Point2d& shift) {
    for (Detection& b : beads_) b.x += shift.x, b.y += shift.y;
    learn(kMinScore);
  }

  /// Mean square of the residuals at the rims with all centres moved.
  double squares_at(const cv::Point2d& shift) {
    const std::vector<Detection> before = beads_;
    move_and_learn(shift);
    const double squares = squares_at_rims();
    beads_ = before;
    return squares;
  }

  static constexpr double kLastStep = 0.06;  // R: last step of the search for the middle of the rims

  /// The place of the least mean square at the rims: the vertex of the paraboloid through its values at a
  /// shift and at eight around it, at most a step away along x and y.
  cv::Point2d vertex_at(const cv::Point2d& shift) {
    const double step = kLastStep * radius_;
    double gx = 0, gy = 0, xx = 0, yy = 0, xy = 0;
    for (const int i : {-1, 0, 1})
      for (const int j : {-1, 0, 1}) {
        const double v = squares_at(shift + cv::Point2d(i * step, j * step));
        gx += i * v / 6, gy += j * v / 6, xy += i * j * v / 4;
        xx += (i == 0 ? -2 : 1) * v / 3, yy += (j == 0 ? -2 : 1) * v / 3;
      }
    const double det = xx * yy - xy * xy;
    if (!(det > 0 && xx > 0)) return shift;
    return shift + step * cv::Point2d(std::clamp((xy * gy - yy * gx) / det, -1.0, 1.0),
                                      std::clamp((xy * gx - xx * gy) / det, -1.0, 1.0));
  }

  /// From the centres of the discs to the middle of their rims. If a highlight attracted the centres, f is
  /// that of a smeared rim, which the residuals at the rims show: they are least where the rims are
  /// concentric. A compass search, because a smeared rim has no gradient towards the centre.
  /// \returns nothing if no highlight attracted the centres
  std::optional<cv::Point2d> shift_to_rims() {
    constexpr double kFirstStep = 0.125;                 // R
    constexpr double kMinShift = 0.04, kMaxShift = 0.5;  // R: less is no highlight, more another disc
    constexpr double kBetter = 0.75;                     // of the squares of the residuals at the rims
    constexpr double kMinMisfit = 1e-3;                  // mean square at the rims; highlights leave 4e-3
    const double first = squares_at({});
    if (first < kMinMisfit) return {};
    double least = first;
    cv::Point2d shift;
    for (double step = kFirstStep * radius_; step > kLastStep * radius_; step *= 0.5)
      for (bool moves = true; moves;) {
        moves = false;
        for (const cv::Point2d way : {cv::Point2d(0, 1), {0, -1}, {1, 0}, {-1, 0}}) {
          const cv::Point2d next = shift + step * way;
          if (cv::norm(next) > kMaxShift * radius_) continue;
          const double squares = squares_at(next);
          if (!(squares < least)) continue;
          least = squares;
          shift = next;
          moves = true;
        }
      }
    if (!(least < kBetter * first) || cv::norm(shift) < kMinShift * radius_) return {};
    return vertex_at(shift);
  }

  /// Number of pixels to each side of a disc's centre that show the disc.
  [[nodiscard]] int reach() const { return cvCeil(radius_) + 1; }
  [[nodiscard]] cv::Point pixel_of(const Detection& b) const {
    return {std::clamp(cvRound(b.x) + reach(), 0, taken_.cols - 1),
            std::clamp(cvRound(b.y) + reach(), 0, taken_.rows - 1)};
  }
  [[nodiscard]] bool taken(const Detection& b) const { return taken_(pixel_of(b)) != 0; }
  void take(const Detection& b) {
    cv::circle(taken_, pixel_of(b), cvRound(kApart * radius_), 255, cv::FILLED);
  }

  /// Adds discs where the picture resembles the profile and there is room, in the order of correlation.
  void add_similar(const cv::Mat1f& picture) {
    const cv::Mat1f like = likeness(picture, shared_, kMinLevel);
    std::vector<Detection> tops;
    for (int y = 0; y < like.rows; ++y)
      for (int x = 0; x < like.cols; ++x) {
        const float v = like(y, x);
        if (static_cast<double>(v) < kLike) continue;
        const cv::Rect around = cv::Rect(x - 1, y - 1, 3, 3) & cv::Rect({}, like.size());
        double most = 0;
        cv::minMaxLoc(like(around), nullptr, &most);
        if (static_cast<double>(v) < most) continue;
        Detection b;
        b.x = x, b.y = y, b.radius = radius_, b.darkness = 1, b.score = static_cast<double>(v);
        tops.push_back(b);
      }
    std::stable_sort(tops.begin(), tops.end(),
                     [](const Detection& a, const Detection& b) { return a.score > b.score; });
    for (const Detection& b : tops) {
      if (taken(b) || in_wall(image_, b)) continue;
      beads_.push_back(b);
      take(b);
    }
  }

  /// Calls use(x, y, r) for the pixels of the frame that a disc reaches.
  template <class Use>
  void over(const Detection& b, Use&& use, double beyond = kReach) const {
    const double reach = b.radius + beyond;
    const int last_row = std::min(image_.darkness.rows - 1, cvFloor(b.y + reach));
    for (int y = std::max(0, cvCeil(b.y - reach)); y <= last_row; ++y) {
      const double dy = y - b.y, half = std::sqrt(std::max(0.0, reach * reach - dy * dy));
      const int last = std::min(image_.darkness.cols - 1, cvFloor(b.x + half));
      for (int x = std::max(0, cvCeil(b.x - half)); x <= last; ++x)
        use(x, y, std::sqrt((x - b.x) * (x - b.x) + dy * dy));
    }
  }

  void add(const Detection& b, double sign) {
    over(b, [&](int x, int y, double r) {
      const double level = level_at(shared_, r * radius_ / b.radius).value + spot_.at(b, x, y).value;
      model_(y, x) += static_cast<float>(sign * b.darkness * level);
    });
  }
  void render() {
    model_.setTo(static_cast<float>(shared_.ground));
    for (const Detection& b : beads_) add(b, 1);
  }

  double step(Detection& b, Normal& covariance) {
    Normal a = Normal::Zero();
    Step right = Step::Zero();
    double squares = 0, pixels = 0;
    over(b, [&](int x, int y, double r) {
      const double scale = radius_ / b.radius;
      const ProfileLevel f = level_at(shared_, r * scale);
      const double slope = b.darkness * f.slope * scale, far = std::max(r, 1e-6);
      const double t = static_cast<double>(model_(y, x)),
                   left = static_cast<double>(image_.darkness(y, x)) - t;
      const HighlightSpot::Level spot = spot_.at(b, x, y);
      const Step j(-slope * (x - b.x) / far - b.darkness * spot.along_x,
                   -slope * (y - b.y) / far - b.darkness * spot.along_y, -slope * r / b.radius,
                   f.value + spot.value);
      const double v = noise_.dark + noise_.light * std::clamp(1 - t, 0.0, 1.0);
      const double w = std::min(1.0, huber_ / std::max(1e-9, std::abs(left))) / v;
      a += w * j * j.transpose();
      right += w * left * j;
      squares += w * left * left;
      ++pixels;
    });
    const double by_radius = 1 / std::pow(kRadiusSpread * radius_, 2), by_level = std::pow(kLevelSpread, -2);
    a(2, 2) += by_radius, right[2] += by_radius * (radius_ - b.radius);
    a(3, 3) += by_level, right[3] += by_level * (1 - b.darkness);
    a(0, 0) += 0.25, a(1, 1) += 0.25;
    const Normal inverse = a.inverse();
    covariance = std::max(1.0, squares / std::max(1.0, pixels - kFitted)) * inverse;
    const Step step = inverse * right;
    add(b, -1);
    const double dx = std::clamp(step[0], -1.0, 1.0), dy = std::clamp(step[1], -1.0, 1.0);
    b.x += dx, b.y += dy;
    b.radius = std::clamp(b.radius + std::clamp(step[2], -0.5, 0.5), 0.7 * radius_, 1.4 * radius_);
    b.darkness = std::clamp(b.darkness + step[3], 0.0, 2.0);
    add(b, 1);
    return std::hypot(dx, dy);
  }

  /// The spots of all discs; empty without a spot.
  [[nodiscard]] cv::Mat1f picture_of_spots() const {
    if (spot_.empty()) return {};
    cv::Mat1f picture = cv::Mat1f::zeros(model_.size());
    for (const Detection& b : beads_)
      over(b, [&](int x, int y, double) {
        picture(y, x) += static_cast<float>(b.darkness * spot_.at(b, x, y).value);
      });
    return picture;
  }

  /// Learns the spot: what the discs have in common inside their rims in addition to f.
  void learn_spot() {
    HighlightSpot::Estimate estimate(radius_);
    for (const Detection& b : beads_) {
      if (b.score < kMinScore) continue;
      over(b, [&](int x, int y, double) {
        const double left = static_cast<double>(image_.darkness(y, x)) - static_cast<double>(model_(y, x));
        estimate.add(b, x, y, left + b.darkness * spot_.at(b, x, y).value);
      });
    }
    spot_ = estimate.spot();
    render();
  }

  /// Mean square of the residuals at the rims, outside of any highlight.
  [[nodiscard]] double squares_at_rims() const {
    constexpr double kInner = 0.85;  // R
    double squares = 0, n = 0;
    for (const Detection& b : beads_) {
      if (b.score < kMinScore) continue;
      over(b, [&](int x, int y, double r) {
        if (r * radius_ < kInner * radius_ * b.radius) return;
        ++n;
        const double left = std::clamp(
            static_cast<double>(image_.darkness(y, x)) - static_cast<double>(model_(y, x)), -huber_, huber_);
        squares += left * left;
      });
    }
    return n > 0 ? squares / n : 0;
  }

  /// By what the correlation of the residuals enlarges the variances of the centres. Only discs that lie in
  /// the frame count.
  [[nodiscard]] double correlation() const {
    std::vector<RimHarmonics> rims;
    for (const Detection& b : beads_) {
      const double reach = b.radius + kReach;
      if (b.x < reach || b.y < reach || b.x > image_.darkness.cols - 1 - reach ||
          b.y > image_.darkness.rows - 1 - reach)
        continue;
      RimHarmonics rim;
      double squares = 0, pixels = 0;
      over(b, [&](int x, int y, double r) {
        if (r == 0) return;
        const double scale = radius_ / b.radius, t = static_cast<double>(model_(y, x));
        const double slope = b.darkness * level_at(shared_, r * scale).slope * scale;
        const double left = std::clamp(static_cast<double>(image_.darkness(y, x)) - t, -huber_, huber_);
        const double w = 1 / (noise_.dark + noise_.light * std::clamp(1 - t, 0.0, 1.0));
        rim.add((x - b.x) / r, (y - b.y) / r, slope, w, left);
        squares += w * left * left, ++pixels;
      });
      rim.excess = std::max(1.0, squares / std::max(1.0, pixels - kFitted));
      rims.push_back(rim);
    }
    return residual_correlation(rims);
  }

  /// Fraction of the variance of its own pixels that a disc explains, with neighbours subtracted.
  [[nodiscard]] double explained(const Detection& b) const {
    double n = 0, sum = 0, squares = 0, left_squares = 0;
    const double bound = 3 * huber_;
    over(
        b,
        [&](int x, int y, double r) {
          const double left = std::clamp(
              static_cast<double>(image_.darkness(y, x)) - static_cast<double>(model_(y, x)), -bound, bound);
          const double own =
              left + b.darkness * (level_at(shared_, r * radius_ / b.radius).value + spot_.at(b, x, y).value);
          ++n, sum += own, squares += own * own, left_squares += left * left;
        },
        1.0);
    const double total = n > 0 ? squares - sum * sum / n : 0;
    return total > 0 ? std::clamp(1 - left_squares / total, 0.0, 1.0) : 0;
  }

  const Prepared& image_;
  double radius_;
  Noise noise_;
  double huber_ = 0.1;
  DiscProfile shared_;
  bool learnt_ = false;
  cv::Mat1f model_;
  HighlightSpot spot_;
  cv::Mat1b taken_;  // pixels too close to a known disc for another centre
  std::vector<Detection> beads_, dropped_;
  std::vector<Normal> covariance_;
};

}  // namespace

Refined refine_by_profile(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
                          const RefineOptions& options) {
  // Learning: from the better half of the proposals, then from similar discs.
  const int most_sweeps = options.sweeps;
  ProfileFit fit(image, radius_px);
  fit.start(proposals);
  fit.learn(fit.typical_score());
  for (int k = 0; k < kLearningRounds && !fit.empty(); ++k) {
    fit.propose_similar();
    fit.learn(kLike);
  }
  // Fitting and learning in turn.
  int sweeps = 0;
  for (int round = 0; round < kRounds && !fit.empty(); ++round) {
    const int most = round + 1 == kRounds ? most_sweeps : std::min(kSweeps, most_sweeps);
    for (int k = 0; k < most; ++k, ++sweeps)
      if (fit.sweep() < kSettled) break;
    fit.prune();
    if (round + 1 < kRounds) fit.learn(kMinScore);
    if (round == 0) fit.add_missed();
  }
  if (!fit.empty()) fit.sweep();
  if (!fit.empty()) fit.centre_at_rims();
  Refined refined = fit.result(sweeps);
  refined.profile = fit.profile();
  return refined;
}

}  // namespace twincell::imaging
