#include "imaging/refine/picture_fit.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/cancellation.hpp"
#include "imaging/refine/frame_model.hpp"
#include "imaging/refine/light_correction.hpp"
#include "imaging/refine/missed_discs.hpp"
#include "imaging/refine/ring_fit.hpp"

namespace twincell::imaging {

namespace {

constexpr int kMinSweeps = 2;  // before the fit can have converged
// Smallest mean residual of a pale disc that was not proposed, seen once its neighbours are in place.
constexpr double kMissedPale = 0.22;
constexpr double kBlurSettled = 0.03;  // of s^2: displaces no touching bead by more than its error

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

/// Number of sweeps of "fast": one, but two where the votes are poor. The votes of the smallest discs merge,
/// and those of discs out of focus do not meet in a point. The second sweep fits the discs that were found
/// missing after the first.
int sweeps_of_fast(const FrameModel& frame) {
  constexpr double kMinRadius_px = 4.5;
  constexpr double kMaxBlurVariance = 1.7;  // px^2
  return frame.priors.smallest() < kMinRadius_px || frame.blur.variance > kMaxBlurVariance ? 2 : 1;
}

/// The blur parameters that a sweep fits.
class BlurSchedule {
 public:
  explicit BlurSchedule(const RefineOptions& options)
      : fit_(options.blur_px > 0 ? BlurFit::none : BlurFit::uneven) {}
  /// Wrong positions look like blur, so the first sweep does not fit the blur.
  [[nodiscard]] BlurFit of_sweep(int sweep) const { return settled_ || sweep == 1 ? BlurFit::none : fit_; }
  /// A motion of the bed during the exposure is visible only when the discs are in place; then it is fitted.
  void follow(int sweep, const SweepResult& moved, const FrameModel& frame) {
    settled_ = settled_ || (sweep > kMinSweeps + 1 && !moved.damped && moved.blur < kBlurSettled);
    if (fit_ == BlurFit::uneven && frame.blur_has_direction)
      fit_ = *frame.blur_has_direction ? BlurFit::path : BlurFit::round;
  }

 private:
  BlurFit fit_;
  bool settled_ = false;
};

/// Judges from one sweep after the other whether the next would still move the beads.
class Convergence {
 public:
  /// Takes the result of a sweep. The second sweep reads all rows, which alone moves each bead by about its
  /// uncertainty.
  void take(int sweep, const SweepResult& moved) {
    const double noise = sweep == 2 ? std::sqrt(kFirstRows - 1.0) * moved.sigma : 0;
    left_ = std::sqrt(std::max(0.0, moved.rms * moved.rms - noise * noise));
    shrinks_ = left_ < before_ ? left_ / before_ : 1;
    before_ = moved.rms;
    const double next = shrinks_ * left_, next_most = shrinks_ * moved.most;
    reached_ = sweep >= kMinSweeps && !moved.damped && !moved.pruned && moved.blur < kBlurSettled &&
               next < kMaxRmsStep * moved.sigma &&
               next_most < std::max(kRefineTolerance_px, kMaxStep * moved.sigma);
  }
  [[nodiscard]] bool reached() const { return reached_; }
  /// Ratio of the next step to this one: about that of this step to the last.
  [[nodiscard]] double shrinks() const { return shrinks_; }

 private:
  static constexpr double kMaxRmsStep = 0.5;  // at convergence, in uncertainties of a position
  static constexpr double kMaxStep = 3;       // the same for the largest step
  double before_ = HUGE_VAL, left_ = 0, shrinks_ = 1;
  bool reached_ = false;
};

/// Decides after which sweeps the light is corrected. Residuals of rims with a wrong blur look like light.
/// Each correction made while the blur is unknown is therefore repeated once it is known.
class LightSchedule {
 public:
  bool is_due(int sweep, const SweepResult& moved) {
    constexpr double kUnknown = 0.2, kKnown = 0.05;  // change of s^2
    if (sweep <= 3) {
      owed_ += moved.blur > kUnknown ? 1 : 0;
      return true;
    }
    if (owed_ == 0 || !(moved.blur < kKnown)) return false;
    --owed_;
    return true;
  }

 private:
  int owed_ = 0;
};

/// Adds discs that were not proposed; they need a further sweep. Discs outside the frame come first, because
/// a block of pixels at the border would place such a disc inside.
void complete(FrameModel& frame, RingFit& fit, int sweep, const SweepResult& moved) {
  if (sweep <= 3 && add_out_of_frame(frame, sweep > 1 && moved.blur < kBlurSettled)) fit.beads_changed();
  // Where a disc of the wrong size was dropped, there may be one of another size.
  const bool gap = moved.pruned && frame.priors.several_sizes() && sweep <= kSweepsBeforeTrimming;
  if ((sweep <= 2 || gap) &&
      add_missed(frame, sweep == 1 || !frame.options.pale ? kMissedDarkness : kMissedPale))
    fit.beads_changed();
}

/// Sweeps until convergence, with corrections of the light and searches for missed discs between them.
Refined fit_picture(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
                    const RefineOptions& options, bool fast) {
  FrameModel frame(image, radius_px, options);
  int most_sweeps = fast ? sweeps_of_fast(frame) : options.sweeps;
  for (const Proposal& p : by_place(proposals, 2 * radius_px)) frame.add(p);
  frame.expect_as_dark_as_seen();
  RingFit fit(frame);
  BlurSchedule blur(options);
  Convergence convergence;
  LightSchedule light;
  int ripples_left = 2;  // so often a ripple of the light is corrected
  for (int sweep = 1; sweep <= most_sweeps; ++sweep) {
    throw_if_cancelled();
    const SweepResult moved = fit.sweep(blur.of_sweep(sweep));
    blur.follow(sweep, moved, frame);
    convergence.take(sweep, moved);
    if (sweep == 1) frame.priors.expect_alike(frame.beads);
    const bool ripple =
        convergence.reached() && ripples_left > 0 && sweep < most_sweeps && level_ripple(frame);
    if (ripple) {
      --ripples_left;
      fit.picture_changed();
      continue;
    }
    // "fast" takes a second sweep if discs were not proposed, such as pale ones that touch dark ones.
    if (fast && sweep == most_sweeps && sweep == 1 && add_missed(frame, kMissedDarkness)) {
      fit.beads_changed();
      most_sweeps = 2;
      continue;
    }
    if (convergence.reached() || sweep == most_sweeps) {
      if (sweep > 1) fit.leave(convergence.shrinks());
      break;
    }
    if (light.is_due(sweep, moved) && level(frame)) fit.picture_changed();
    complete(frame, fit, sweep, moved);
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

}  // namespace twincell::imaging
