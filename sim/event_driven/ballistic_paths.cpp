#include "sim/event_driven/ballistic_paths.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/event_driven/ballistic_paths.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef TWINCELL_FLIGHT_LINES_ONCE
#define TWINCELL_FLIGHT_LINES_ONCE
namespace twincell::sim::flight {
inline constexpr std::size_t kSpare = 8;  // padding after the end, for the last vector load

/// Data that the SIMD loops read.
struct View {
  std::size_t n;
  int dimension;
  const double *a[3], *b[3], *radius, *from;
  double period[3], per[3];  ///< per: 1/period
};
/// A body on a ballistic path, between two times.
struct Body {
  const double *a, *b;  // of the path, three components each
  double radius, begin, end;
};
}  // namespace twincell::sim::flight
#endif

HWY_BEFORE_NAMESPACE();
namespace twincell::sim::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using flight::Body;
using flight::View;

// No fused multiply-add, so that every instruction set gives the same bits.
using Tag = hn::CappedTag<double, flight::kSpare>;
using V = hn::Vec<Tag>;
using M = hn::Mask<Tag>;

HWY_INLINE V set(double x) {
  return hn::Set(Tag(), x);
}
/// x minus the nearest multiple of a period. \param per 1/period
HWY_INLINE V nearest(V x, double period, double per) {
  const V rounding_constant = set(6755399441055744.0);  // 1.5 2^52: its addition rounds to an integer
  return hn::Sub(
      x, hn::Mul(hn::Sub(hn::Add(hn::Mul(x, set(per)), rounding_constant), rounding_constant), set(period)));
}
HWY_INLINE V places(std::size_t first) {
  return hn::Add(hn::Iota(Tag(), 0), set(static_cast<double>(first)));
}

BallisticPaths::Hit first_hit(const View& f, std::size_t i, double now) {
  const Tag tag;
  const V infinite = set(HUGE_VAL), zero = hn::Zero(tag);
  const V start = set(std::max(now, f.from[i])), own_radius = set(f.radius[i]);
  V best = infinite, partner = set(-1), until = infinite;
  M overlap = hn::FirstN(tag, 0);
  for (std::size_t j = 0; j < f.n; j += hn::Lanes(tag)) {
    const V place = places(j);
    const M counts =
        hn::And(hn::Lt(place, set(static_cast<double>(f.n))), hn::Ne(place, set(static_cast<double>(i))));
    // Relative motion: bead i against a vector of beads j, from the time at which both paths are valid.
    const V reach = hn::Add(own_radius, hn::LoadU(tag, f.radius + j));
    const V from = hn::Max(start, hn::LoadU(tag, f.from + j));
    V square = zero, closing = zero, speed = zero;
    V fast[3] = {set(1), set(1), set(1)}, along[3] = {zero, zero, zero};
    for (int k = 0; k < 3; ++k) {
      if (k == 1 && f.dimension == 2) continue;
      const V w = hn::Sub(set(f.b[k][i]), hn::LoadU(tag, f.b[k] + j));
      V d = hn::Add(hn::Sub(set(f.a[k][i]), hn::LoadU(tag, f.a[k] + j)), hn::Mul(w, from));
      if (f.period[k] > 0) d = nearest(d, f.period[k], f.per[k]);
      fast[k] = hn::Max(hn::Abs(w), set(1e-100));
      along[k] = hn::Mul(d, hn::CopySign(set(1), w));
      square = hn::Add(square, hn::Mul(d, d));
      closing = hn::Add(closing, hn::Mul(d, w));
      speed = hn::Add(speed, hn::Mul(w, w));
    }
    // In directions without periodic images, the two beads can touch only between `enter` and `leave`,
    // counted from `from`. Outside this interval further images do not matter.
    V enter = zero, leave = infinite, image = infinite;
    // One division instead of three: 1/speed is the product of the other two speeds over the product of all.
    const V all = hn::Div(set(1), hn::Mul(hn::Mul(fast[0], fast[1]), fast[2]));
    for (int k = 0; k < 3; ++k) {
      if (k == 1 && f.dimension == 2) continue;
      const V slowness = hn::Mul(hn::Mul(fast[(k + 1) % 3], fast[(k + 2) % 3]), all);
      if (f.period[k] > 0) {
        // The next image is one period away and touches at the distance `reach`.
        image = hn::Min(image, hn::Mul(hn::Sub(hn::Sub(set(f.period[k]), reach), along[k]), slowness));
      } else {
        enter = hn::Max(enter, hn::Mul(hn::Neg(hn::Add(along[k], reach)), slowness));
        leave = hn::Min(leave, hn::Mul(hn::Sub(reach, along[k]), slowness));
      }
    }
    const M matters = hn::And(counts, hn::Lt(image, leave));
    until = hn::Min(until, hn::IfThenElse(matters, hn::Add(from, hn::Max(image, enter)), infinite));
    const V c = hn::Sub(square, hn::Mul(reach, reach));
    // Root of the quadratic: first touch if the beads approach and the discriminant is positive.
    const V inside = hn::Sub(hn::Mul(closing, closing), hn::Mul(speed, c));
    // Beads that have just parted are at the distance `reach` up to rounding.
    overlap = hn::Or(overlap, hn::And(counts, hn::Lt(c, hn::Mul(set(-1e-12), hn::Mul(reach, reach)))));
    const M hits = hn::And(counts, hn::And(hn::Lt(closing, zero), hn::Gt(inside, zero)));
    if (hn::AllFalse(tag, hits)) continue;
    const V after = hn::Div(c, hn::Sub(hn::Sqrt(hn::Max(inside, zero)), closing));
    const V time = hn::IfThenElse(hits, hn::Add(from, hn::Max(after, zero)), infinite);
    const M sooner = hn::Lt(time, best);
    best = hn::IfThenElse(sooner, time, best);
    partner = hn::IfThenElse(sooner, place, partner);
  }
  // Reduction over the lanes. Of equal times the lowest index is taken, so the result does not depend on the
  // vector width.
  BallisticPaths::Hit hit{HUGE_VAL, -1, HUGE_VAL, !hn::AllFalse(tag, overlap)};
  alignas(64) double times[flight::kSpare], partners[flight::kSpare], untils[flight::kSpare];
  hn::Store(best, tag, times);
  hn::Store(partner, tag, partners);
  hn::Store(until, tag, untils);
  for (std::size_t k = 0; k < hn::Lanes(tag); ++k) {
    hit.until = std::min(hit.until, untils[k]);
    const auto with = static_cast<std::int32_t>(partners[k]);
    if (times[k] < hit.time || (times[k] == hit.time && with < hit.partner)) {
      hit.time = times[k];
      hit.partner = with;
    }
  }
  return hit;
}

void find_near(const View& f, const Body& body, std::vector<std::int32_t>& found) {
  const Tag tag;
  const V zero = hn::Zero(tag), begin = set(body.begin), span = set(body.end - body.begin);
  for (std::size_t j = 0; j < f.n; j += hn::Lanes(tag)) {
    const V reach = hn::Add(set(body.radius), hn::LoadU(tag, f.radius + j));
    V square = zero, closing = zero, speed = zero;
    for (int k = 0; k < 3; ++k) {
      if (k == 1 && f.dimension == 2) continue;
      const V w = hn::Sub(set(body.b[k]), hn::LoadU(tag, f.b[k] + j));
      V d = hn::Add(hn::Sub(set(body.a[k]), hn::LoadU(tag, f.a[k] + j)), hn::Mul(w, begin));
      if (f.period[k] > 0) d = nearest(d, f.period[k], f.per[k]);
      square = hn::Add(square, hn::Mul(d, d));
      closing = hn::Add(closing, hn::Mul(d, w));
      speed = hn::Add(speed, hn::Mul(w, w));
    }
    // In touch at the beginning, at the end, or in between.
    const V c = hn::Sub(square, hn::Mul(reach, reach)), change = hn::Mul(speed, span);
    const M at_end = hn::Lt(hn::Add(hn::Mul(hn::Add(hn::Add(closing, closing), change), span), c), zero);
    const M between = hn::And(hn::And(hn::Lt(closing, zero), hn::Gt(hn::Add(closing, change), zero)),
                              hn::Gt(hn::Mul(closing, closing), hn::Mul(speed, c)));
    const M near = hn::And(hn::Lt(places(j), set(static_cast<double>(f.n))),
                           hn::Or(hn::Lt(c, zero), hn::Or(at_end, between)));
    if (hn::AllFalse(tag, near)) continue;
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(tag, near, bits);
    for (std::size_t k = 0; k < hn::Lanes(tag); ++k)
      if ((bits[0] >> k & 1U) != 0) found.push_back(static_cast<std::int32_t>(j + k));
  }
}

}  // namespace twincell::sim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace twincell::sim {

HWY_EXPORT(first_hit);
HWY_EXPORT(find_near);

namespace {

flight::View view(std::size_t n, int dimension, const std::array<std::vector<double>, 3>& a,
                  const std::array<std::vector<double>, 3>& b, const std::vector<double>& radius,
                  const std::vector<double>& from, const std::array<double, 3>& period,
                  const std::array<double, 3>& per) {
  return {n,
          dimension,
          {a[0].data(), a[1].data(), a[2].data()},
          {b[0].data(), b[1].data(), b[2].data()},
          radius.data(),
          from.data(),
          {period[0], period[1], period[2]},
          {per[0], per[1], per[2]}};
}

}  // namespace

BallisticPaths::BallisticPaths(const std::vector<double>& radii, int dimension,
                               const std::array<double, 3>& period)
    : n_(radii.size()), dimension_(dimension), period_(period), radius_(radii) {
  for (std::size_t k = 0; k < 3; ++k) per_[k] = period[k] > 0 ? 1 / period[k] : 0;
  const std::size_t with_spare = n_ + flight::kSpare;
  for (std::size_t k = 0; k < 3; ++k) a_[k].resize(with_spare), b_[k].resize(with_spare);
  radius_.resize(with_spare);
  from_.resize(with_spare);
}

BallisticPaths::Hit BallisticPaths::first_hit(std::size_t i, double now) const {
  return HWY_DYNAMIC_DISPATCH(first_hit)(view(n_, dimension_, a_, b_, radius_, from_, period_, per_), i, now);
}

void BallisticPaths::find_near(const BallisticPath& line, double radius, double begin, double end,
                               std::vector<std::int32_t>& found) const {
  HWY_DYNAMIC_DISPATCH(find_near)
  (view(n_, dimension_, a_, b_, radius_, from_, period_, per_),
   {line.a.data(), line.b.data(), radius, begin, end}, found);
}

}  // namespace twincell::sim
#endif
