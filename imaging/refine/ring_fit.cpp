#include "imaging/refine/ring_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/median.hpp"
#include "imaging/refine/disc_measures.hpp"
#include "imaging/refine/residual_correlation.hpp"
#include "imaging/refine/shared_blur.hpp"

namespace twincell::imaging {

namespace {

// A disc paler than kMinDarkness is rejected, unless pale ones are wanted and it explains its ring as well as
// the sharpest beads do, once positions and blur are known.
constexpr double kMinDarkness = 0.4, kMinPaleDarkness = 0.2;
constexpr double kMinPaleScore = 0.85;  // Detection::score
constexpr double kPaleSize = 0.06;      // largest relative difference of R
constexpr int kBlurIsKnown = 4;         // sweeps
// A disc whose radius differs from all sizes by this much, relative, is several discs fitted as one.
constexpr double kSizeTolerance = 0.2;
// Number of sweeps that estimate the scatter of R and a from disc to disc.
constexpr int kPriorSweeps = 8;
// A disc may move this far, px or darkness, before its couplings to its neighbours are recomputed.
constexpr double kCouplingMove = 0.1;
// The same for the blur, as a fraction of s^2.
constexpr double kCouplingBlurChange = 0.05;
// Fraction of the first step that remains after it, in a packing: edges are not linear in position and blur.
constexpr double kLeftByFirst = 0.08;

/// Residual variance relative to that of the noise, at least 1: uncertainties are enlarged by it.
double excess(const RingSums& s) {
  return s.pixels > kFitted ? std::max(1.0, s.squares / (s.pixels - kFitted)) : HUGE_VAL;
}

/// Share of the ring's variance that the disc explains.
double explained_share(const RingSums& s) {
  const double total = s.pixels > 0 ? s.seen_squares - s.seen * s.seen / s.pixels : 0;
  return total > 0 ? std::clamp(1 - s.residual_squares / total, 0.0, 1.0) : 0;
}

}  // namespace

SweepResult RingFit::sweep(BlurFit fit) {
  RingArgs args = frame_.ring_args();
  if (sweeps_ == 0) args.row_step = kFirstRows;
  std::swap(sums_, sums_before_);
  evaluate(args, fit);
  bool pruned = false;
  if (const double now = misfit(); before_ && now > 1.1 * before_->misfit + 1e-7) {
    undo_step();
  } else {
    accept_step(now);
    if (sweeps_ >= 1) pruned = prune();
  }
  if (sweeps_ >= 1 && sweeps_ <= kPriorSweeps)
    frame_.priors.learn(frame_.beads, sums_, frame_.ring(), sweeps_ == 1 ? kFirstRows : 1);
  ++sweeps_;
  SweepResult moved = step(args, fit);
  moved.pruned = pruned;
  return moved;
}

// Computes the sums of each disc and of its couplings in one pass, while its pixels are in the cache. A
// coupling is recomputed only when one of its two discs has moved.
void RingFit::evaluate(const RingArgs& args, BlurFit fit) {
  if (frame_.stale) frame_.render(args.row_step);
  sums_.resize(frame_.beads.size());
  const std::vector<Disc> all = frame_.discs();
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

double RingFit::misfit() const {
  double squares = 0, pixels = 1;
  for (const RingSums& s : sums_) squares += s.residual_squares, pixels += s.pixels;
  return squares / pixels;
}

void RingFit::undo_step() {
  for (std::size_t k = 0; k < frame_.beads.size(); ++k) put(frame_.beads[k], before_->discs[k]);
  std::swap(sums_, sums_before_);
  frame_.blur = before_->blur;
  damping_ *= 20;
  couplings_.clear();
}

void RingFit::accept_step(double misfit) {
  before_ = State{frame_.discs(), frame_.blur, misfit};
  damping_ = std::max(kDamping, damping_ / 4);
}

void RingFit::beads_changed() {
  frame_.stale = true;
  before_.reset();
  couplings_.clear();
}

// Drops candidates that are not discs or are outside the frame. Left in, they would spoil the fit of their
// neighbours. Returns whether any was dropped.
bool RingFit::prune() {
  std::vector<Detection>& beads = frame_.beads;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < beads.size(); ++k) {
    if (const std::optional<Verdict> why = objection_to(k)) {
      frame_.drop(beads[k], *why);
    } else {
      beads[kept] = beads[k];
      sums_[kept++] = sums_[k];
    }
  }
  if (kept == beads.size()) return false;
  beads_changed();
  beads.resize(kept);
  sums_.resize(kept);
  return true;
}

std::optional<Verdict> RingFit::objection_to(std::size_t bead) const {
  constexpr double kHardlySeen = 0.05;  // of the ring
  constexpr int kSizeSettles = 3;       // sweeps
  const Detection& b = frame_.beads[bead];
  const double size = frame_.priors.nominal_radius(b.radius);
  const double out = size + std::sqrt(frame_.blur.variance);
  const bool settled = sweeps_ >= kBlurIsKnown;
  if (b.darkness < kMinDarkness && (!frame_.options.pale || b.darkness < kMinPaleDarkness ||
                                    (settled && (std::abs(b.radius - size) > kPaleSize * size ||
                                                 explained_share(sums_[bead]) < kMinPaleScore))))
    return Verdict::pale;
  if (frame_.priors.several_sizes() && sweeps_ >= kSizeSettles &&
      std::abs(b.radius - size) > kSizeTolerance * size)
    return Verdict::wrong_radius;
  if (b.x < -out || b.y < -out || b.x > frame_.size.width - 1 + out || b.y > frame_.size.height - 1 + out)
    return Verdict::outside;
  if (sums_[bead].pixels < kHardlySeen * frame_.full_ring(b)) return Verdict::unseen;
  return std::nullopt;
}

void RingFit::begin_couplings(const RingArgs& args, const std::vector<Disc>& discs) {
  couplings_ = couplings_of(args, discs);
  moved_since_coupling_.assign(discs.size(), HUGE_VAL);
}

// Sums over pixels, priors, damping.
RingFit::Equations RingFit::equations() const {
  const std::size_t n = frame_.beads.size();
  Equations e{std::vector<Normal>(n), std::vector<Step>(n)};
  for (std::size_t k = 0; k < n; ++k) {
    e.blocks[k] = normal_of(sums_[k]);
    e.right[k] = right_side(sums_[k]);
    frame_.priors.add_to(e.blocks[k], e.right[k], frame_.beads[k]);
    e.blocks[k].diagonal() *= 1 + damping_;
  }
  return e;
}

SweepResult RingFit::step(const RingArgs& args, BlurFit fit) {
  const std::size_t n = frame_.beads.size();
  const Equations e = equations();
  if (couplings_.empty()) {  // the last step was undone, or beads were dropped
    const std::vector<Disc> all = frame_.discs();
    begin_couplings(args, all);
    for (Coupling& c : couplings_) renew(c, args, all);
    moved_since_coupling_.assign(n, 0.0);
  }
  std::vector<Step> steps = gauss_newton_step(e.blocks, couplings_, e.right);
  if (sweeps_ == 1) couplings_.clear();  // the first sums are of half the rows
  SweepResult moved;
  moved.damped = damping_ > 0.1;
  moved.blur = fit_blur(frame_, fit, {sums_, e.blocks, couplings_, steps});
  if (moved.blur > kCouplingBlurChange) couplings_.clear();
  std::vector<double> far(n), sigma(n);
  for (std::size_t k = 0; k < n; ++k) {
    far[k] = move(frame_.beads[k], steps[k]);
    if (sweeps_ > 1) moved_since_coupling_[k] += far[k] + std::abs(steps[k][kA]);
    sigma[k] = std::sqrt(excess(sums_[k]) / e.blocks[k](kX, kX));
  }
  unsettled_ = far;
  summarise(std::move(far), std::move(sigma), moved);
  if (sweeps_ == 1)
    for (double& u : unsettled_) u = kLeftByFirst * std::sqrt(u * u + moved.rms * moved.rms);
  frame_.stale = true;
  return moved;
}

// Applies a bounded step to a bead. Returns the displacement of the centre, px; with several sizes the larger
// of it and the change of R, because a disc with the wrong size converges last.
double RingFit::move(Detection& b, const Step& step) const {
  const PopulationPriors& priors = frame_.priors;
  const double dx = std::clamp(step[kX], -1.0, 1.0), dy = std::clamp(step[kY], -1.0, 1.0);
  b.x += dx;
  b.y += dy;
  const double radius =
      std::clamp(b.radius + std::clamp(step[kR], -0.5, 0.5), 0.6 * priors.smallest(), 1.4 * priors.largest());
  const double wider = priors.several_sizes() ? std::abs(radius - b.radius) : 0;
  b.radius = radius;
  b.darkness = std::clamp(b.darkness + step[kA], 0.0, 1.5);
  return std::max(std::sqrt(dx * dx + dy * dy), wider);
}

// Sets the largest step, the rms step and the typical uncertainty.
void RingFit::summarise(std::vector<double> far, std::vector<double> sigma, SweepResult& moved) const {
  const std::size_t n = far.size();
  if (n == 0) return;
  const std::size_t most = sweeps_ > kSweepsBeforeTrimming ? n - 1 - n / 50 : n - 1;
  std::nth_element(far.begin(), far.begin() + static_cast<std::ptrdiff_t>(most), far.end());
  for (std::size_t k = 0; k <= most; ++k) moved.rms += far[k] * far[k];
  moved.most = far[most];
  moved.rms = std::sqrt(moved.rms / static_cast<double>(2 * (most + 1)));
  moved.sigma = upper_median(std::move(sigma));
}

void RingFit::leave(double share) {
  for (double& u : unsettled_) u *= share;
}

Refined RingFit::result() {
  std::vector<Detection>& beads = frame_.beads;
  unsettled_.resize(beads.size());
  const std::vector<Normal> covariance = covariances();
  const double rho = beads.empty() ? 1 : correlation();
  for (std::size_t k = 0; k < beads.size(); ++k)
    measure(beads[k], sums_[k], covariance[k], rho, unsettled_[k] / std::numbers::sqrt2);
  return {std::move(beads), std::move(frame_.dropped), std::sqrt(frame_.blur.variance), frame_.blur.path,
          sweeps_};
}

// By what the correlation of the residuals enlarges the variances of the centres.
double RingFit::correlation() const {
  std::vector<double> excesses;
  for (const RingSums& s : sums_) excesses.push_back(excess(s));
  RingArgs args = frame_.ring_args();
  if (sweeps_ == 1) args.row_step = kFirstRows;
  return residual_correlation(rim_harmonics(args, frame_.discs(), excesses));
}

// Covariance of each disc's x, y, R, a due to noise, including the uncertainty of its neighbours. It uses the
// first terms of the inverse of the matrix with blocks A and couplings C:
// A^-1 + sum_j A^-1 C_ij A_j^-1 C_ji A^-1.
std::vector<Normal> RingFit::covariances() const {
  std::vector<Normal> alone;
  for (std::size_t k = 0; k < frame_.beads.size(); ++k) {
    Normal a = normal_of(sums_[k]);
    Step g = Step::Zero();
    frame_.priors.add_to(a, g, frame_.beads[k]);
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

// Sets uncertainty, score, interior and moments of a bead. `rho` is residual_correlation(); `unsettled` is
// the error of either coordinate from incomplete convergence, px.
void RingFit::measure(Detection& b, const RingSums& s, const Normal& by_noise, double rho,
                      double unsettled) const {
  const double n = s.pixels;
  const Normal covariance = excess(s) * by_noise;
  b.sigma_x = std::sqrt(rho * covariance(kX, kX) + unsettled * unsettled);
  b.sigma_y = std::sqrt(rho * covariance(kY, kY) + unsettled * unsettled);
  b.sigma_radius = std::sqrt(covariance(kR, kR));
  b.residual = n > 0 ? std::sqrt(s.residual_squares / n) : std::numeric_limits<double>::infinity();
  b.score = explained_share(s);
  b.ring_share = n / ring_area(b.radius, frame_.ring());
  measure_disc(frame_.image, b);
}

}  // namespace twincell::imaging
