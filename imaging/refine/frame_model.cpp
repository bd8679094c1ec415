#include "imaging/refine/frame_model.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/median.hpp"
#include "imaging/refine/disc_measures.hpp"

namespace twincell::imaging {

namespace {

/// Blur with which the fit begins, px^2. Out of focus: with a small starting blur the fit would first use
/// sharp rims and estimate light and sizes from their residuals. With the whole measured blur, centres that
/// are a third of a radius off would not converge.
double starting_variance(double seen, const RefineOptions& options, double smallest_px) {
  constexpr double kLens = 0.8, kPixel = 1.0 / 12;  // a sharp lens, px; the width of a pixel, px^2
  constexpr double kOutOfFocus = 1.3;               // px
  constexpr double kOfRadius = 0.2;
  if (options.blur_px > 0) return options.blur_px * options.blur_px;
  const double sharp = kLens * kLens + kPixel;
  if (seen <= kOutOfFocus) return sharp;
  const double begin = std::min(seen, kOfRadius * smallest_px);
  return std::max(sharp, begin * begin);
}

/// The pixels that a fit must not use: the walls, and out of focus what their blurred edges still darken. The
/// mask ends about two blurs from the edge of a wall, where 2 % of its darkness is left. Of a sharp wall the
/// next pixel is clear. Beads that touched a wall out of focus lay off by three of their errors. Where the
/// blur is wide for the beads, nothing is left out, because their rims at the wall would be lost.
cv::Mat1b walls_and_their_tails(const Prepared& image, double seen, double smallest_px) {
  constexpr double kSharp = 1.1;      // px
  constexpr double kOfRadius = 0.25;  // at most
  if (seen <= kSharp || seen > kOfRadius * smallest_px) return image.opaque;
  const int width = 2 * cvRound(seen) + 1;
  cv::Mat1b wider;
  cv::dilate(image.opaque, wider, cv::getStructuringElement(cv::MORPH_ELLIPSE, {width, width}));
  return wider;
}

}  // namespace

FrameModel::FrameModel(const Prepared& frame, double radius_px, const RefineOptions& fit_options)
    : image(frame),
      options(fit_options),
      size(frame.darkness.size()),
      noise(noise_of(frame.darkness)),
      priors(radius_px, fit_options),
      picture(frame.darkness) {
  const bool measures = options.blur_px <= 0 || !image.opaque.empty();
  const double seen = measures ? blur_of(image.darkness) : 0;  // px, of the picture
  blur.variance = starting_variance(seen, options, priors.smallest());
  picture.adjustROI(0, 0, 0, kSpareColumns);
  if (image.opaque.empty()) return;
  take_picture(picture.clone());
  picture.colRange(0, size.width).setTo(kUnseen, walls_and_their_tails(image, seen, priors.smallest()));
}

void FrameModel::add(const Proposal& p) {
  Detection b;
  b.x = p.x;
  b.y = p.y;
  b.radius = priors.radii()[priors.size_of(p.radius)].mean;
  b.darkness = priors.darkness().mean;
  const double inside = rough_interior(image, b);
  if (in_wall(image, b)) {
    drop(b, Verdict::in_wall);
  } else if (inside < (options.pale ? kMinPaleInterior : kMinInterior)) {
    drop(b, Verdict::bright_inside);
  } else {
    beads.push_back(b);
    interiors_.push_back(inside);
  }
}

void FrameModel::drop(const Detection& b, Verdict why) {
  dropped.push_back(b);
  dropped.back().verdict = why;
}

void FrameModel::expect_as_dark_as_seen() {
  if (interiors_.empty()) return;
  priors.expect_darkness(upper_median(std::move(interiors_)));
  for (Detection& b : beads) b.darkness = priors.darkness().mean;
}

void FrameModel::render(int row_step) {
  model.create(picture.size());
  for (int y = 0; y < model.rows; y += row_step) std::fill_n(model[y], model.cols, 0.0F);
  for (const Detection& b : beads) add_disc(model, disc_of(b), blur, row_step);
  stale = false;
}

void FrameModel::take_picture(const cv::Mat1f& levelled) {
  picture = levelled;
  owned_ = true;
}

std::vector<Disc> FrameModel::discs() const {
  std::vector<Disc> all;
  all.reserve(beads.size());
  for (const Detection& b : beads) all.push_back(disc_of(b));
  return all;
}

double FrameModel::ring() const {
  constexpr double kReach = 3;                    // widths of the blur
  constexpr double kMinRing = 2.5, kMaxRing = 6;  // px; the radius of the smallest disc if that is larger
  if (options.ring_px > 0) return options.ring_px;
  return std::clamp(blur.reach(kReach), kMinRing, std::max(kMaxRing, priors.smallest()));
}

double FrameModel::full_ring(const Detection& b) const {
  return ring_area(priors.nominal_radius(b.radius), ring());
}

RingArgs FrameModel::ring_args() const {
  RingArgs args;
  args.picture = &picture;
  args.model = &model;
  args.blur = blur;
  args.ring = ring();
  args.dark_variance = noise.dark;
  args.light_variance = noise.light;
  // Huber's bound is above the noise of a usable frame and below the rims of clear beads.
  args.huber = std::max(0.1, 4 * std::sqrt(noise.dark + noise.light));
  return args;
}

}  // namespace twincell::imaging
