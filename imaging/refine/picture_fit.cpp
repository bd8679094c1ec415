#include "imaging/refine/picture_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <tuple>

#include "core/cancellation.hpp"
#include "core/median.hpp"
#include "imaging/disc/ring_normal_equations.hpp"
#include "imaging/preprocess/residual_illumination.hpp"
#include "imaging/refine/disc_measures.hpp"
#include "imaging/refine/out_of_frame_discs.hpp"
#include "imaging/refine/sparse_gauss_newton.hpp"

namespace twincell {

namespace {

enum Fitted : std::uint8_t { kX, kY, kR, kA };

constexpr double kMinInterior = 0.3;  // median darkness inside R/2 that a proposal must show
constexpr double kMinDarkness = 0.4;  // a fitted disc paler than that is rejected
// Smallest mean residual of a disc that was not proposed; half that of the palest tracer.
constexpr double kMissedDarkness = 0.35;
// A disc whose radius differs from all sizes by this much, relative, is several discs fitted as one.
constexpr double kSizeTolerance = 0.2;
// A missed disc has a given size if the residual inside kInner R averages kFilled of the usual darkness.
constexpr double kInner = 0.85, kFilled = 0.7;
// After so many sweeps the 2 % of the discs that move most are ignored: they are not beads.
constexpr int kSweepsBeforeTrimming = 12;
// Number of sweeps that estimate the scatter of R and a from disc to disc.
constexpr int kPriorSweeps = 8;
// A disc may move this far, px or darkness, before its couplings to its neighbours are recomputed.
constexpr double kCouplingMove = 0.1;
// The same for the blur, as a fraction of s^2.
constexpr double kCouplingBlurChange = 0.05;
// Fraction of the first step that remains after it, in a packing: edges are not linear in position and blur.
constexpr double kLeftByFirst = 0.08;
// The first sweep reads every kFirstRows-th row: half the pixels suffice while the positions are rough.
constexpr int kFirstRows = 2;
// Relative addition to the diagonal; it is increased only while steps make the fit worse.
constexpr double kDamping = 0.002;

Normal normal_of(const RingSums& s) {
  Normal a;
  std::size_t at = 0;
  for (int m = 0; m < kFitted; ++m)
    for (int k = 0; k <= m; ++k, ++at) a(m, k) = a(k, m) = s.jj[at];
  return a;
}
Step right_side(const RingSums& s) {
  Step g;
  for (int m = 0; m < kFitted; ++m) g[m] = s.jr[static_cast<std::size_t>(m)];
  return g;
}

/// Prior of R or a: a Gaussian with wide shoulders, so that a bead that clearly differs is not pulled to the
/// mean.
struct Prior {
  double mean, spread;
  [[nodiscard]] double precision(double value) const {
    const double off = (value - mean) / (4 * spread);
    return 1 / (spread * spread * (1 + off * off));
  }
};

/// Values of a quantity for many beads, and the variances due to the fit alone for some of them.
struct Scatter {
  std::vector<double> values, variances;
  /// Sets the prior to the median and the true spread of the beads; unchanged if there are too few.
  /// \param least lower bound of the spread
  /// \param rows row step of the fit that gave the values
  void learn(Prior& prior, double least, int rows) {
    constexpr std::size_t kEnough = 20;
    if (values.size() < kEnough) return;
    const double middle = upper_median(values);
    for (double& v : values) v = std::abs(v - middle);
    const double scatter = 1.4826 * upper_median(values);
    const double own = scatter * scatter - rows * upper_median(variances);
    prior = {middle, std::max(least, std::sqrt(std::max(0.0, own)))};
  }
};

/// The fit of one frame: discs, blur, light, and the model picture.
class PictureFit {
 public:
  PictureFit(const Prepared& image, double radius, const RefineOptions& options)
      : image_(image), options_(options), size_(image.darkness.size()), noise_(noise_of(image.darkness)) {
    size_priors_.push_back({radius, options.radius_spread * radius});
    for (const double other : options.other_radii_px)
      size_priors_.push_back({other, options.radius_spread * other});
    for (const Prior& s : size_priors_) nominal_radii_.push_back(s.mean);
    constexpr double kLens = 0.8, kPixel = 1.0 / 12;  // a sharp lens, px; the width of a pixel, px^2
    blur_.variance = options.blur_px > 0 ? options.blur_px * options.blur_px : kLens * kLens + kPixel;
    // Out of focus: with a small starting blur the fit would first use sharp rims and estimate light and
    // sizes from their residuals. With the whole measured blur, centres that are a third of a radius off
    // would not converge.
    constexpr double kOutOfFocus = 1.3, kOfRadius = 0.2;  // px
    if (const double seen = blur_of(image.darkness); options.blur_px <= 0 && seen > kOutOfFocus) {
      const double begin = std::min(seen, kOfRadius * smallest());
      blur_.variance = std::max(blur_.variance, begin * begin);
    }
    picture_ = image.darkness;
    picture_.adjustROI(0, 0, 0, kSpareColumns);
    if (image.opaque.empty()) return;
    own_picture();
    picture_.colRange(0, size_.width).setTo(kUnseen, image.opaque);
  }

  void add(const Proposal& p) {
    Detection b;
    b.x = p.x;
    b.y = p.y;
    b.radius = size_priors_[size_of(p.radius)].mean;
    b.darkness = darkness_prior_.mean;
    // A proposal that is bright inside is a void or a clear bead; one with its centre in a wall is the edge
    // of the wall. Neither is fitted, because it would spoil the fit of its neighbours.
    const double inside = rough_interior(image_, b);
    if (in_wall(image_, b)) {
      drop(b, Verdict::in_wall);
    } else if (inside < kMinInterior) {
      drop(b, Verdict::bright_inside);
    } else {
      beads_.push_back(b);
      interiors_.push_back(inside);
    }
  }

  /// Before the first sweep: sets the darkness of all beads to the median interior of the proposals.
  void expect_as_dark_as_seen() {
    if (interiors_.empty()) return;
    darkness_prior_.mean = upper_median(std::move(interiors_));
    for (Detection& b : beads_) b.darkness = darkness_prior_.mean;
  }

  struct Moved {
    double most, rms, sigma;  ///< px; sigma: uncertainty of a typical bead's position
    bool damped;              ///< so its length is no measure of convergence
    bool pruned;              ///< beads were dropped before this step
    double blur = 0;          ///< change of s^2 relative to s^2, or to 0.7 px^2 if s^2 is larger
  };

  /// One Gauss-Newton step of all discs and of the blur. The order of the beads does not matter. If the
  /// previous step made the fit worse, it is undone and repeated with more damping.
  Moved sweep(BlurFit fit) {
    RingArgs args = ring_args();
    if (sweeps_ == 0) args.row_step = kFirstRows;
    std::swap(sums_, sums_before_);
    evaluate(args, fit);
    double squares = 0, pixels = 1;
    for (const RingSums& s : sums_) squares += s.residual_squares, pixels += s.pixels;
    const double misfit = squares / pixels;
    bool pruned = false;
    if (before_ && misfit > 1.1 * before_->misfit + 1e-7) {
      for (std::size_t k = 0; k < beads_.size(); ++k) put(beads_[k], before_->discs[k]);
      std::swap(sums_, sums_before_);
      blur_ = before_->blur;
      damping_ *= 20;
      couplings_.clear();
    } else {
      if (!before_) before_ = State{};
      before_->discs = discs();
      before_->blur = blur_;
      before_->misfit = misfit;
      damping_ = std::max(kDamping, damping_ / 4);
      if (sweeps_ >= 1) pruned = prune();
    }
    if (sweeps_ >= 1 && sweeps_ <= kPriorSweeps) learn_priors(sweeps_ == 1 ? kFirstRows : 1);
    ++sweeps_;
    Moved moved = step(args, fit);
    moved.pruned = pruned;
    return moved;
  }

  /// After the first sweep, in which every disc has a wide prior: narrows the priors, because most discs of a
  /// size are alike.
  void expect_alike() {
    if (beads_.empty()) return;
    std::vector<std::vector<double>> radii(size_priors_.size());
    std::vector<double> darkness;
    for (const Detection& b : beads_)
      radii[size_of(b.radius)].push_back(b.radius), darkness.push_back(b.darkness);
    for (std::size_t k = 0; k < size_priors_.size(); ++k)
      if (!radii[k].empty())
        size_priors_[k] = {upper_median(std::move(radii[k])), options_.radius_spread / 3 * nominal_radii_[k]};
    darkness_prior_ = {upper_median(std::move(darkness)), 0.02};
  }

  /// Divides the light by a quadratic surface, so that the residual in the gaps between the discs vanishes.
  void level() {
    if (stale_) render();
    const std::optional<Surface> q = quadratic_left();
    // A correction far below the noise displaces no bead.
    constexpr double kOfNoise = 0.02;
    if (q && q->cwiseAbs().sum() >= kOfNoise * std::sqrt(noise_.dark + noise_.light)) divide_light(*q, {});
  }
  /// Divides the light also by a smooth surface if the quadratic one leaves a ripple. Requires discs in
  /// place, because edges with a wrong blur look like a ripple. The model may lack the last step, which was
  /// small.
  /// \returns whether there was a ripple
  bool level_ripple() {
    const std::optional<Surface> q = quadratic_left();
    if (!q) return false;
    const cv::Mat1f ripple = ripple_beside(*q);
    if (!ripple.empty()) divide_light(*q, ripple);
    return !ripple.empty();
  }

  /// Adds discs that were not proposed. Such a disc leaves a dark disc in the residual picture. The search
  /// uses blocks of pixels; 3 x 3 blocks are about as wide as a disc.
  void add_missed() {
    if (stale_) render();
    // Blocks: sums of the residual picture, then means over 3 x 3 blocks.
    const int side = std::max(1, cvRound(0.4 * smallest()));
    cv::Mat1f blocks = cv::Mat1f::zeros(size_.height / side, size_.width / side);
    std::vector<float> columns(static_cast<std::size_t>(size_.width));
    for (int row = 0; row < blocks.rows; ++row) {
      std::fill(columns.begin(), columns.end(), 0.0F);
      float *left = columns.data(), *block = blocks[row];
      for (int y = row * side; y < (row + 1) * side; ++y) {
        const float *d = picture_[y], *t = model_[y];
        for (int x = 0; x < size_.width; ++x) left[x] += d[x] < kUnseen ? d[x] - t[x] : 0.0F;
      }
      for (int k = 0; k < side; ++k)
        for (int x = 0; x < blocks.cols; ++x) block[x] += left[x * side + k];
    }
    if (blocks.empty()) return;
    cv::boxFilter(blocks, blocks, CV_32F, {3, 3}, {-1, -1}, false, cv::BORDER_CONSTANT);
    std::vector<Proposal> missed;
    for (int y = 0; y < blocks.rows; ++y)
      for (int x = 0; x < blocks.cols; ++x)
        if (const double mean = static_cast<double>(blocks(y, x)) / (9 * side * side);
            mean >= kMissedDarkness)
          missed.push_back({side * (x + 0.5) - 0.5, side * (y + 0.5) - 0.5, mean});
    std::stable_sort(missed.begin(), missed.end(),
                     [](const Proposal& a, const Proposal& b) { return a.score > b.score; });
    const std::size_t before = beads_.size();
    // Known discs: opaque discs do not overlap, so a centre within R plus 0.3 of the smallest R of a known
    // disc is a misfit of that disc. They are marked on a map, because in noise there are tens of thousands
    // of candidates and of discs.
    cv::Mat1b known = cv::Mat1b::zeros(blocks.size());
    const auto block_of = [&](double at) { return (at + 0.5) / side - 0.5; };
    const auto mark = [&](const Detection& b) {
      const double reach = nominal_radii_[size_of(b.radius)] + 0.3 * smallest();
      const int last_y = std::min(known.rows - 1, cvFloor(block_of(b.y + reach))),
                last_x = std::min(known.cols - 1, cvFloor(block_of(b.x + reach)));
      for (int y = std::max(0, cvCeil(block_of(b.y - reach))); y <= last_y; ++y)
        for (int x = std::max(0, cvCeil(block_of(b.x - reach))); x <= last_x; ++x) {
          const double dx = side * (x + 0.5) - 0.5 - b.x, dy = side * (y + 0.5) - 0.5 - b.y;
          if (dx * dx + dy * dy < reach * reach) known(y, x) = 1;
        }
    };
    for (const Detection& b : beads_) mark(b);
    for (Proposal& p : missed) {
      if (known(cvRound(block_of(p.y)), cvRound(block_of(p.x))) != 0) continue;
      p.radius = missed_radius(p);
      const std::size_t had = beads_.size();
      add(p);
      if (beads_.size() > had) mark(beads_.back());
    }
    if (beads_.size() > before) stale_ = true, before_.reset(), couplings_.clear();
  }

  /// Adds discs outside the frame that disturb those inside. While the blur is unknown, a rim with more blur
  /// than assumed looks like such a disc of which only the blur is visible.
  void add_beyond(bool blur_known) {
    if (stale_) render();
    // A candidate too close to a known disc is a misfit of that disc.
    const double blur = std::sqrt(blur_.variance);
    const std::size_t before = beads_.size();
    std::vector<Proposal> beyond;
    for (const Prior& s : size_priors_)
      for (Proposal p : out_of_frame_discs(ring_args(), s.mean, blur_known ? s.mean + blur : s.mean - blur)) {
        p.radius = s.mean;
        beyond.push_back(p);
      }
    std::stable_sort(beyond.begin(), beyond.end(),
                     [](const Proposal& a, const Proposal& b) { return a.score > b.score; });
    for (const Proposal& p : beyond)
      if (std::none_of(beads_.begin(), beads_.end(), [&](const Detection& b) {
            const double reach = nominal_radii_[size_of(b.radius)] + 0.5 * smallest();
            return (b.x - p.x) * (b.x - p.x) + (b.y - p.y) * (b.y - p.y) < reach * reach;
          }))
        add(p);
    if (beads_.size() > before) stale_ = true, before_.reset(), couplings_.clear();
  }

  /// Number of sweeps of "fast": one, but two where the votes are poor. The votes of the smallest discs
  /// merge, and those of discs out of focus do not meet in a point. The second sweep fits the discs that were
  /// found missing after the first.
  [[nodiscard]] int sweeps_of_fast() const {
    constexpr double kSmall = 4.5;    // px
    constexpr double kBlurred = 1.7;  // px^2
    return smallest() < kSmall || blur_.variance > kBlurred ? 2 : 1;
  }

  /// Ends the fit, although another step would move each bead by this fraction of its last step.
  void leave(double share) {
    for (double& u : unsettled_) u *= share;
  }

  /// The beads with their uncertainties and measures. Call it once, at the end.
  Refined result() {
    unsettled_.resize(beads_.size());
    const std::vector<Normal> covariance = covariances();
    for (std::size_t k = 0; k < beads_.size(); ++k)
      measure(beads_[k], sums_[k], covariance[k], unsettled_[k] / std::numbers::sqrt2);
    return {std::move(beads_), std::move(dropped_), std::sqrt(blur_.variance), blur_.path, sweeps_};
  }

  /// Whether the blur depends on direction; absent while undecided.
  [[nodiscard]] std::optional<bool> moves() const { return moves_; }

 private:
  /// Calls use(x, y, light, left, weight) for about `samples` pixels in the gaps between the discs: the
  /// fraction of the light that the model leaves to the pixel, and its residual. A rim that is not yet in
  /// place also leaves a residual. When it counted as light, it displaced touching beads by 0.004 px; pixels
  /// are therefore weighted by the sixteenth power of the light.
  template <class Use>
  void over_gaps(double samples, Use&& use) const {
    const int stride = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(size_.area()) / samples)));
    const double far = ring_args().huber;
    for (int y = 0; y < size_.height; y += stride)
      for (int x = y / stride % 2; x < size_.width; x += stride) {
        const double t = static_cast<double>(model_(y, x)), left = static_cast<double>(picture_(y, x)) - t;
        if (t > 0.7 || std::abs(left) > far) continue;
        const double light = std::max(0.0, 1 - t), light4 = light * light * light * light;
        use(x, y, light, left, light4 * light4 * light4 * light4);
      }
  }

  /// Fits a quadratic surface to the residual in the gaps.
  [[nodiscard]] std::optional<Surface> quadratic_left() const {
    constexpr double kSamples = 10000;
    constexpr int kEnough = 200;
    Eigen::Matrix<double, 6, 6> a = Eigen::Matrix<double, 6, 6>::Zero();
    Surface right = Surface::Zero();
    int n = 0;
    double weights = 0;
    over_gaps(kSamples, [&](int x, int y, double light, double left, double weight) {
      const Surface f = light * surface_basis(x, y, size_);
      a += weight * f * f.transpose();
      right += weight * left * f;
      weights += weight;
      ++n;
    });
    if (n < kEnough) return std::nullopt;
    a.diagonal().tail<5>().array() += 1e-3 * weights;
    return a.ldlt().solve(right);
  }
  /// Divides the light of the picture by 1 - q - ripple.
  /// \param ripple correction in addition to the quadratic surface, for each pixel; empty: no ripple
  void divide_light(const Surface& q, const cv::Mat1f& ripple) {
    cv::Mat1f to = picture_;
    if (!owned_) {
      to = cv::Mat1f(picture_.size());
      to.colRange(size_.width, to.cols).setTo(kUnseen);
    }
    std::vector<float> levelled(static_cast<std::size_t>(size_.width));
    for (int y = 0; y < size_.height; ++y) {
      const float* from = picture_[y];
      float *d = to[y], *level = levelled.data();
      const SurfaceRow row = surface_row(q, y, size_);
      // Separate loops: the compiler does not vectorise a division and a selection in one loop.
      for (int x = 0; x < size_.width; ++x) level[x] = 1 - row.at(x);
      if (!ripple.empty())
        for (int x = 0; x < size_.width; ++x) level[x] -= ripple(y, x);
      for (int x = 0; x < size_.width; ++x) level[x] = 1 - (1 - from[x]) / level[x];
      for (int x = 0; x < size_.width; ++x) d[x] = from[x] < kUnseen ? level[x] : kUnseen;
    }
    picture_ = to;
    owned_ = true;
    before_.reset();
  }

  /// Residual light after a quadratic surface, tile by tile. One extra row of tiles on each side carries no
  /// data: the border of the frame is between them and their neighbours.
  struct Tiles {
    cv::Mat1d mean, variance;
  };
  [[nodiscard]] Tiles tiles_beside(const Surface& q, int side, double samples) const {
    const cv::Size count(size_.width / side + 3, size_.height / side + 3);
    cv::Mat1d sum = cv::Mat1d::zeros(count), weights = sum.clone(), squares = sum.clone();
    over_gaps(samples, [&](int x, int y, double light, double left, double weight) {
      const int at_x = x / side + 1, at_y = y / side + 1;
      sum(at_y, at_x) += weight * light * (left - light * q.dot(surface_basis(x, y, size_)));
      weights(at_y, at_x) += weight * light * light;
      squares(at_y, at_x) += weight * weight * light * light;
    });
    const double variance = noise_.dark + noise_.light;
    Tiles tiles{cv::Mat1d::zeros(count), cv::Mat1d(count, HUGE_VAL)};
    for (int y = 0; y < count.height; ++y)
      for (int x = 0; x < count.width; ++x)
        if (const double w = weights(y, x); w > 0) {
          tiles.mean(y, x) = sum(y, x) / w;
          tiles.variance(y, x) = variance * squares(y, x) / (w * w);
        }
    return tiles;
  }
  /// Ripple of the light after a quadratic surface, pixel by pixel; empty if no ripple is detected.
  [[nodiscard]] cv::Mat1f ripple_beside(const Surface& q) const {
    constexpr double kSeen = 10000, kFound = 400000;  // samples to detect a ripple, and to measure it
    constexpr int kMost = 32;                         // tiles
    const int side = std::max(cvCeil(6 * largest()), std::max(size_.width, size_.height) / kMost);
    if (const Tiles seen = tiles_beside(q, side, kSeen); !has_ripple(seen.mean, seen.variance)) return {};
    const Tiles found = tiles_beside(q, side, kFound);
    const cv::Mat1f map = smooth_ripple(found.mean, found.variance);
    cv::Mat1f wide;
    cv::resize(map, wide, map.size() * side, 0, 0, cv::INTER_CUBIC);
    return wide(cv::Rect({side, side}, size_));
  }

  /// Equations of the blur, with one unknown (s^2) or three, and their coupling to those of the discs.
  struct BlurEquations {
    std::vector<std::vector<Step>> shared;  // coupling of each unknown to each disc
    Eigen::MatrixXd normal;
    Eigen::VectorXd right;
  };
  [[nodiscard]] BlurEquations blur_equations(BlurFit fit) const {
    const int n = fit == BlurFit::round ? 1 : RingSums::kBlurs;
    BlurEquations e{std::vector(static_cast<std::size_t>(n), std::vector<Step>(sums_.size())),
                    Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
    for (std::size_t k = 0; k < sums_.size(); ++k) {
      const RingSums& s = sums_[k];
      std::size_t at = 0;
      for (int q = 0; q < n; ++q) {
        for (int p = 0; p <= q; ++p, ++at) e.normal(q, p) = e.normal(p, q) += s.bb[at];
        e.right[q] += s.br[static_cast<std::size_t>(q)];
        for (int m = 0; m < kFitted; ++m)
          e.shared[static_cast<std::size_t>(q)][k][m] =
              s.jb[std::size_t{RingSums::kBlurs} * static_cast<std::size_t>(m) + static_cast<std::size_t>(q)];
      }
    }
    return e;
  }
  /// The equations of a round blur, Q_xx = Q_yy.
  static BlurEquations rounded(const BlurEquations& e) {
    BlurEquations r{{e.shared[0]}, Eigen::MatrixXd::Zero(1, 1), Eigen::VectorXd::Zero(1)};
    for (std::size_t k = 0; k < r.shared[0].size(); ++k) r.shared[0][k] += e.shared[2][k];
    r.normal(0, 0) = e.normal(0, 0) + 2 * e.normal(0, 2) + e.normal(2, 2);
    r.right[0] = e.right[0] + e.right[2];
    return r;
  }

  /// Bounded step of the blur; also corrects the steps of the discs for it. Discs and blur are solved
  /// together, because a blur that followed one sweep behind would take twice as many sweeps.
  Eigen::VectorXd blur_step(const BlurEquations& e, const std::vector<Normal>& blocks,
                            const std::vector<Coupling>& couplings, std::vector<Step>& steps) const {
    const auto n = static_cast<Eigen::Index>(e.shared.size());
    std::vector<std::vector<Step>> follow;
    Eigen::MatrixXd normal = e.normal;
    Eigen::VectorXd right = e.right;
    for (Eigen::Index q = 0; q < n; ++q) {
      const std::vector<Step>& shared = e.shared[static_cast<std::size_t>(q)];
      follow.push_back(gauss_newton_step(blocks, couplings, shared));
      for (std::size_t k = 0; k < steps.size(); ++k) {
        right[q] -= shared[k].dot(steps[k]);
        for (Eigen::Index p = 0; p < n; ++p)
          normal(p, q) -= e.shared[static_cast<std::size_t>(p)][k].dot(follow.back()[k]);
      }
    }
    Eigen::VectorXd step = normal.ldlt().solve(right);
    if (!step.allFinite()) return Eigen::VectorXd::Zero(n);
    for (Eigen::Index q = 0; q < n; ++q) {
      step[q] = std::clamp(step[q], -0.5 * blur_.variance, blur_.variance);
      for (std::size_t k = 0; k < steps.size(); ++k)
        steps[k] -= step[q] * follow[static_cast<std::size_t>(q)][k];
    }
    return step;
  }

  /// A blur that is not round: mean variance, and the excess of variance along one direction over that across
  /// it.
  struct Uneven {
    double mean, more, angle;
    explicit Uneven(const Eigen::VectorXd& q)
        : mean(0.5 * (q[0] + q[2])),
          more(std::hypot(q[0] - q[2], 2 * q[1])),
          angle(0.5 * std::atan2(2 * q[1], q[0] - q[2])) {}
  };

  /// Fits the blur together with the discs. If the blur clearly depends on direction, the bed moved, and a
  /// path is fitted, starting from the path that corresponds to the measured variance.
  /// \returns the relative change of s^2
  double fit_blur(BlurFit fit, const std::vector<Normal>& blocks, std::vector<Step>& steps) {
    constexpr double kClear = 0.04, kNear = 0.1;              // of s^2
    constexpr double kLeast = 0.09, kMost = 36, kWide = 0.7;  // px^2
    if (fit == BlurFit::none) return 0;
    BlurEquations equations = blur_equations(fit);
    if (fit == BlurFit::uneven) {
      std::vector<Step> alone = steps;
      const Uneven seen(blur_step(equations, blocks, {}, alone));
      // A mean blur that is still wrong also appears to depend on direction.
      const bool moved = seen.more > std::max(kClear * blur_.variance, std::abs(seen.mean));
      if (moved || std::abs(seen.mean) < kNear * blur_.variance) moves_ = moved;
      if (!moved) equations = rounded(equations);
    }
    const double old = blur_.variance;
    const Eigen::VectorXd step = blur_step(equations, blocks, couplings_, steps);
    double widened = std::abs(step[0]);
    if (fit == BlurFit::path) {
      const Eigen::Vector2d path(blur_.path[0], blur_.path[1]), longer = path + step.tail<2>();
      widened += std::abs(longer.squaredNorm() - path.squaredNorm()) / 12;
      put_path(longer);
      blur_.variance = old + step[0];
    } else if (step.size() > 1) {
      const Uneven seen(step);
      // A uniform density over a length L has the variance L^2/12.
      put_path(std::sqrt(12 * seen.more) * Eigen::Vector2d(std::cos(seen.angle), std::sin(seen.angle)));
      blur_.variance = old + seen.mean - seen.more / 2;
      widened = std::abs(seen.mean) + seen.more / 2;
    } else {
      blur_.variance = old + step[0];
    }
    blur_.variance = std::clamp(blur_.variance, kLeast, kMost);
    // For a wide blur the same relative change moves the discs farther.
    return widened / std::min(old, kWide);
  }
  void put_path(const Eigen::Vector2d& path) {
    // With a longer path no point of a disc would stay dark throughout the exposure.
    const double most = smallest(), length = path.norm();
    const Eigen::Vector2d bounded = length > most ? Eigen::Vector2d(most / length * path) : path;
    blur_.path = {bounded.x(), bounded.y()};
  }

  /// Estimates the scatter of R and a from bead to bead: the observed scatter less that of the fit alone.
  /// \param rows row step of the fit that gave the values
  void learn_priors(int rows) {
    constexpr double kLeastRadius = 0.002, kLeastDarkness = 0.003;
    std::vector<Scatter> radii(size_priors_.size());
    Scatter darkness;
    for (std::size_t k = 0; k < beads_.size(); ++k) {
      const Detection& b = beads_[k];
      if (sums_[k].pixels < 0.8 * full_ring(b)) continue;
      Scatter& radius = radii[size_of(b.radius)];
      radius.values.push_back(b.radius);
      darkness.values.push_back(b.darkness);
      if (radius.variances.size() > 200) continue;
      const Normal covariance = normal_of(sums_[k]).inverse();
      radius.variances.push_back(covariance(kR, kR));
      darkness.variances.push_back(covariance(kA, kA));
    }
    for (std::size_t k = 0; k < size_priors_.size(); ++k)
      radii[k].learn(size_priors_[k], kLeastRadius * nominal_radii_[k], rows);
    darkness.learn(darkness_prior_, kLeastDarkness, rows);
  }

  /// Drops candidates that are not discs or are outside the frame. Left in, they would spoil the fit of their
  /// neighbours.
  /// \returns whether any was dropped
  bool prune() {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < beads_.size(); ++k) {
      const Detection& b = beads_[k];
      const double out = nominal_radii_[size_of(b.radius)] + std::sqrt(blur_.variance);
      const double size = nominal_radii_[size_of(b.radius)];
      if (b.darkness < kMinDarkness) {
        drop(b, Verdict::pale);
      } else if (nominal_radii_.size() > 1 && sweeps_ >= 3 &&
                 std::abs(b.radius - size) > kSizeTolerance * size) {
        drop(b, Verdict::wrong_radius);
      } else if (b.x < -out || b.y < -out || b.x > size_.width - 1 + out || b.y > size_.height - 1 + out) {
        drop(b, Verdict::outside);
      } else if (sums_[k].pixels < 0.05 * full_ring(b)) {
        drop(b, Verdict::unseen);
      } else {
        beads_[kept] = b;
        sums_[kept++] = sums_[k];
      }
    }
    if (kept == beads_.size()) return false;
    stale_ = true;
    before_.reset();
    couplings_.clear();
    beads_.resize(kept);
    sums_.resize(kept);
    return true;
  }

  [[nodiscard]] std::vector<Disc> discs() const {
    std::vector<Disc> all;
    all.reserve(beads_.size());
    for (const Detection& b : beads_) all.push_back(disc_of(b));
    return all;
  }
  /// Computes the sums of each disc and of its couplings in one pass, while its pixels are in the cache. A
  /// coupling is recomputed only when one of its two discs has moved.
  void evaluate(const RingArgs& args, BlurFit fit) {
    if (stale_) render(args.row_step);
    sums_.resize(beads_.size());
    const std::vector<Disc> all = discs();
    if (couplings_.empty()) begin_couplings(args, all);
    auto c = couplings_.begin();
    for (std::size_t k = 0; k < all.size(); ++k) {
      sums_[k] = ring_sums(args, all[k], fit);
      for (; c != couplings_.end() && static_cast<std::size_t>(c->i) == k; ++c)
        if (std::max(moved_since_coupling_[k], moved_since_coupling_[static_cast<std::size_t>(c->j)]) >
            kCouplingMove)
          renew(*c, args, all);
    }
    for (double& w : moved_since_coupling_) w = w > kCouplingMove ? 0 : w;
  }
  void begin_couplings(const RingArgs& args, const std::vector<Disc>& all) {
    couplings_ = couplings_of(args, all);
    moved_since_coupling_.assign(all.size(), HUGE_VAL);
  }

  Moved step(const RingArgs& args, BlurFit fit) {
    const std::size_t n = beads_.size();
    // Normal equations: sums over pixels, priors, damping.
    std::vector<Normal> blocks(n);
    std::vector<Step> right(n);
    for (std::size_t k = 0; k < n; ++k) {
      blocks[k] = normal_of(sums_[k]);
      right[k] = right_side(sums_[k]);
      add_priors(beads_[k], blocks[k], right[k]);
      blocks[k].diagonal() *= 1 + damping_;
    }
    if (couplings_.empty()) {  // the last step was undone, or beads were dropped
      const std::vector<Disc> all = discs();
      begin_couplings(args, all);
      for (Coupling& c : couplings_) renew(c, args, all);
      moved_since_coupling_.assign(n, 0.0);
    }
    std::vector<Step> steps = gauss_newton_step(blocks, couplings_, right);
    if (sweeps_ == 1) couplings_.clear();
    std::vector<double> far(n), sigma(n);
    Moved moved{0, 0, 0, damping_ > 0.1, false};
    moved.blur = fit_blur(fit, blocks, steps);
    if (moved.blur > kCouplingBlurChange) couplings_.clear();
    for (std::size_t k = 0; k < n; ++k) {
      far[k] = apply(beads_[k], steps[k]);
      if (sweeps_ > 1) moved_since_coupling_[k] += far[k] + std::abs(steps[k][kA]);
      sigma[k] = std::sqrt(excess(sums_[k]) / blocks[k](kX, kX));
    }
    unsettled_ = far;
    if (n > 0) {
      const std::size_t most = sweeps_ > kSweepsBeforeTrimming ? n - 1 - n / 50 : n - 1;
      std::nth_element(far.begin(), far.begin() + static_cast<std::ptrdiff_t>(most), far.end());
      for (std::size_t k = 0; k <= most; ++k) moved.rms += far[k] * far[k];
      moved.most = far[most];
      moved.rms = std::sqrt(moved.rms / static_cast<double>(2 * (most + 1)));
      moved.sigma = upper_median(std::move(sigma));
    }
    if (sweeps_ == 1)
      for (double& u : unsettled_) u = kLeftByFirst * std::sqrt(u * u + moved.rms * moved.rms);
    stale_ = true;
    return moved;
  }

  /// Covariance of each disc's x, y, R, a due to noise, including the uncertainty of its neighbours. It uses
  /// the first terms of the inverse of the matrix with blocks A and couplings C:
  /// A^-1 + sum_j A^-1 C_ij A_j^-1 C_ji A^-1.
  [[nodiscard]] std::vector<Normal> covariances() const {
    std::vector<Normal> alone;
    for (std::size_t k = 0; k < beads_.size(); ++k) {
      Normal a = normal_of(sums_[k]);
      Step g = Step::Zero();
      add_priors(beads_[k], a, g);
      alone.emplace_back(a.inverse());
    }
    std::vector<Normal> all = alone;
    for (const Coupling& c : couplings_) {
      const auto i = static_cast<std::size_t>(c.i), j = static_cast<std::size_t>(c.j);
      all[i] += alone[i] * c.sums * alone[j] * c.sums.transpose() * alone[i];
      all[j] += alone[j] * c.sums.transpose() * alone[i] * c.sums * alone[j];
    }
    return all;
  }

  void drop(const Detection& b, Verdict why) {
    dropped_.push_back(b);
    dropped_.back().verdict = why;
  }
  [[nodiscard]] static Disc disc_of(const Detection& b) { return {b.x, b.y, b.radius, b.darkness}; }
  static void put(Detection& b, const Disc& d) {
    b.x = d.x, b.y = d.y, b.radius = d.radius, b.darkness = d.darkness;
  }
  /// Half width of the ring: out to where the edge carries no more information on the position.
  [[nodiscard]] double ring() const {
    constexpr double kFar = 3, kLeast = 2.5, kMost = 6;
    if (options_.ring_px > 0) return options_.ring_px;
    return std::clamp(blur_.reach(kFar), kLeast, std::max(kMost, smallest()));
  }
  [[nodiscard]] double full_ring(const Detection& b) const {
    return 4 * std::numbers::pi * nominal_radii_[size_of(b.radius)] * ring();
  }
  /// Index of the size closest to a radius, by the logarithm of their ratio.
  [[nodiscard]] std::size_t size_of(double radius) const {
    const auto off = [&](double size) { return std::abs(std::log(radius / size)); };
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < nominal_radii_.size(); ++k)
      if (off(nominal_radii_[k]) < off(nominal_radii_[nearest])) nearest = k;
    return nearest;
  }
  [[nodiscard]] double smallest() const {
    return *std::min_element(nominal_radii_.begin(), nominal_radii_.end());
  }
  [[nodiscard]] double largest() const {
    return *std::max_element(nominal_radii_.begin(), nominal_radii_.end());
  }
  /// The largest size for which the residual picture is dark at that position; otherwise the smallest size.
  [[nodiscard]] double missed_radius(const Proposal& p) const {
    double radius = smallest();
    for (const double size : nominal_radii_) {
      if (size <= radius) continue;
      const int reach = cvFloor(kInner * size);
      double left = 0, pixels = 0;
      for (int y = std::max(0, cvRound(p.y) - reach); y <= std::min(size_.height - 1, cvRound(p.y) + reach);
           ++y)
        for (int x = std::max(0, cvRound(p.x) - reach); x <= std::min(size_.width - 1, cvRound(p.x) + reach);
             ++x)
          if (std::hypot(x - p.x, y - p.y) < kInner * size && picture_(y, x) < kUnseen)
            left += static_cast<double>(picture_(y, x) - model_(y, x)), ++pixels;
      if (left > kFilled * darkness_prior_.mean * pixels) radius = size;
    }
    return radius;
  }
  /// Copies the picture before its first change; until then it is shared with the frame.
  void own_picture() {
    if (!owned_) picture_ = picture_.clone();
    owned_ = true;
  }
  void render(int row_step = 1) {
    model_.create(picture_.size());
    for (int y = 0; y < model_.rows; y += row_step) std::fill_n(model_[y], model_.cols, 0.0F);
    for (const Detection& b : beads_) add_disc(model_, disc_of(b), blur_, row_step);
    stale_ = false;
  }
  [[nodiscard]] RingArgs ring_args() const {
    RingArgs args;
    args.picture = &picture_;
    args.model = &model_;
    args.blur = blur_;
    args.ring = ring();
    args.dark_variance = noise_.dark;
    args.light_variance = noise_.light;
    // Huber's bound is above the noise of a usable frame and below the rims of clear beads.
    args.huber = std::max(0.1, 4 * std::sqrt(noise_.dark + noise_.light));
    return args;
  }
  /// Adds the priors to the normal equations of a bead.
  void add_priors(const Detection& b, Normal& a, Step& g) const {
    const auto add = [&](int at, const Prior& prior, double value) {
      const double p = prior.precision(value);
      a(at, at) += p;
      g[at] += p * (prior.mean - value);
    };
    add(kR, size_priors_[size_of(b.radius)], b.radius);
    add(kA, darkness_prior_, b.darkness);
    a(kX, kX) += 0.25, a(kY, kY) += 0.25;  // a proposal is accurate to 2 px
  }
  /// Applies a bounded step to a bead.
  /// \returns the displacement of the centre, px; with several sizes the larger of it and the change of R,
  ///     because a disc with the wrong size converges last
  double apply(Detection& b, const Step& step) const {
    const double dx = std::clamp(step[kX], -1.0, 1.0), dy = std::clamp(step[kY], -1.0, 1.0);
    b.x += dx;
    b.y += dy;
    const double radius =
        std::clamp(b.radius + std::clamp(step[kR], -0.5, 0.5), 0.6 * smallest(), 1.4 * largest());
    const double wider = nominal_radii_.size() > 1 ? std::abs(radius - b.radius) : 0;
    b.radius = radius;
    b.darkness = std::clamp(b.darkness + step[kA], 0.0, 1.5);
    return std::max(std::sqrt(dx * dx + dy * dy), wider);
  }

  /// Residual variance relative to that of the noise, at least 1: uncertainties are enlarged by it.
  [[nodiscard]] static double excess(const RingSums& s) {
    return s.pixels > kFitted ? std::max(1.0, s.squares / (s.pixels - kFitted)) : HUGE_VAL;
  }

  /// Uncertainty, score, interior and moments of a bead.
  /// \param unsettled error of either coordinate from incomplete convergence, px
  void measure(Detection& b, const RingSums& s, const Normal& by_noise, double unsettled) const {
    const double n = s.pixels;
    const Normal covariance = excess(s) * by_noise;
    b.sigma_x = std::sqrt(covariance(kX, kX) + unsettled * unsettled);
    b.sigma_y = std::sqrt(covariance(kY, kY) + unsettled * unsettled);
    b.sigma_radius = std::sqrt(covariance(kR, kR));
    b.residual = n > 0 ? std::sqrt(s.residual_squares / n) : std::numeric_limits<double>::infinity();
    const double total = n > 0 ? s.seen_squares - s.seen * s.seen / n : 0;
    b.score = total > 0 ? std::clamp(1 - s.residual_squares / total, 0.0, 1.0) : 0;
    b.ring_share = n / (4 * std::numbers::pi * b.radius * ring());
    measure_disc(image_, b);
  }

  const Prepared& image_;
  RefineOptions options_;
  cv::Size size_;
  Noise noise_;
  EdgeBlur blur_;
  std::vector<double> nominal_radii_;  // radii of the sizes
  std::vector<Prior> size_priors_;     // prior of R for each size
  Prior darkness_prior_{1, 0.3};
  cv::Mat1f picture_, model_;  // darkness, and the sum of all a P; both with spare columns
  bool owned_ = false;         // the picture is a copy, not shared with the frame
  bool stale_ = true;          // the model does not match the beads
  std::vector<Detection> beads_, dropped_;
  std::vector<double> interiors_;      // of the proposals
  std::vector<RingSums> sums_;         // of the last sweep
  std::vector<RingSums> sums_before_;  // of the sweep before that
  struct State {
    std::vector<Disc> discs;
    EdgeBlur blur;
    double misfit;  // mean square of the residuals, darkness^2
  };
  std::optional<State>
      before_;  // before the last step; empty after a change of the picture or the set of beads
  double damping_ = kDamping;
  int sweeps_ = 0;
  std::vector<double> unsettled_;    // error of each bead from incomplete convergence, px
  std::vector<Coupling> couplings_;  // empty after a change of the set of beads
  std::optional<bool> moves_;        // whether the blur depends on direction
  std::vector<double>
      moved_since_coupling_;  // motion of each bead since its couplings were computed, px and darkness
};

/// Sorts proposals into bands as high as a disc, each from left to right, so that a disc's pixels are in the
/// cache from its neighbours. In the order of score, half of the time was spent waiting for memory.
std::vector<Proposal> by_place(const std::vector<Proposal>& proposals, double band) {
  std::vector<std::tuple<double, double, double, std::size_t>> order;
  order.reserve(proposals.size());
  for (std::size_t k = 0; k < proposals.size(); ++k) {
    const Proposal& p = proposals[k];
    order.emplace_back(std::floor(p.y / band), p.x, p.y, k);
  }
  std::sort(order.begin(), order.end());
  std::vector<Proposal> sorted;
  sorted.reserve(order.size());
  for (const auto& entry : order) sorted.push_back(proposals[std::get<3>(entry)]);
  return sorted;
}

}  // namespace

namespace {

/// The schedule of the fit: sweeps until convergence, with corrections of the light and searches for missed
/// discs between them.
Refined fit_picture(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
                    const RefineOptions& options, bool fast) {
  PictureFit fit(image, radius_px, options);
  const int most_sweeps = fast ? fit.sweeps_of_fast() : options.sweeps;
  for (const Proposal& p : by_place(proposals, 2 * radius_px)) fit.add(p);
  fit.expect_as_dark_as_seen();
  constexpr int kLeast = 2;
  constexpr double kEnough = 0.5;        // rms step at convergence, in uncertainties of a position
  constexpr double kWorst = 3;           // the same for the largest step
  constexpr double kBlurSettled = 0.03;  // of s^2: displaces no touching bead by more than its error
  // A motion of the bed during the exposure is visible only when the discs are in place.
  BlurFit blur = options.blur_px > 0 ? BlurFit::none : BlurFit::uneven;
  constexpr int kMostRipples = 2;                  // ripple corrections of the light
  constexpr double kUnknown = 0.2, kKnown = 0.05;  // change of s^2
  int sweeps = 0, ripples = 0, owed = 0;
  bool blurred = false;
  double before = HUGE_VAL;
  while (sweeps < most_sweeps) {
    throw_if_cancelled();
    // Wrong positions look like blur, so the first sweep does not fit the blur.
    const auto moved = fit.sweep(blurred || sweeps == 0 ? BlurFit::none : blur);
    ++sweeps;
    blurred = blurred || (sweeps > kLeast + 1 && !moved.damped && moved.blur < kBlurSettled);
    if (blur == BlurFit::uneven && fit.moves()) blur = *fit.moves() ? BlurFit::path : BlurFit::round;
    if (sweeps == 1) fit.expect_alike();
    // The second sweep reads all rows, which alone moves each bead by about its uncertainty.
    const double noise = sweeps == 2 ? std::sqrt(kFirstRows - 1.0) * moved.sigma : 0;
    const double left = std::sqrt(std::max(0.0, moved.rms * moved.rms - noise * noise));
    const double shrinks = left < before ? left / before : 1;
    before = moved.rms;
    // Convergence: the ratio of the next step to this one is about that of this step to the last.
    if (sweeps >= kLeast && !moved.damped && !moved.pruned && moved.blur < kBlurSettled &&
        shrinks * left < kEnough * moved.sigma &&
        shrinks * moved.most < std::max(options.tolerance_px, kWorst * moved.sigma)) {
      if (ripples < kMostRipples && sweeps < most_sweeps && fit.level_ripple()) {
        ++ripples;
        continue;
      }
      fit.leave(shrinks);
      break;
    }
    if (sweeps == most_sweeps) {
      if (sweeps > 1) fit.leave(shrinks);
      break;
    }
    // Light: residuals of rims with a wrong blur look like light. The correction is therefore repeated once
    // the blur is known.
    if (sweeps <= 3 && moved.blur > kUnknown) ++owed;
    const bool mend = sweeps > 3 && owed > 0 && moved.blur < kKnown;
    if (mend) --owed;
    if (sweeps <= 3 || mend) fit.level();
    // Missed discs: they need a further sweep. Discs outside the frame come first, because a block of pixels
    // at the border would place such a disc inside.
    if (sweeps <= 3) fit.add_beyond(sweeps > 1 && moved.blur < kBlurSettled);
    // Where a disc of the wrong size was dropped, there may be one of another size.
    if (sweeps <= 2 || (moved.pruned && !options.other_radii_px.empty() && sweeps <= kSweepsBeforeTrimming))
      fit.add_missed();
  }
  return fit.result();
}

}  // namespace

Refined refine(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
               const RefineOptions& options) {
  return fit_picture(image, proposals, radius_px, options, false);
}

Refined refine_fast(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
                    const RefineOptions& options) {
  return fit_picture(image, proposals, radius_px, options, true);
}

}  // namespace twincell
