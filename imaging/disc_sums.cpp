#include "imaging/disc_sums.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "imaging/disc_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace twincell::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Rows of a ring are some twenty pixels: with wider vectors more lanes would idle.
using Tag = hn::CappedTag<float, 8>;
using V = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

HWY_INLINE V set(double a) {
  return hn::Set(Tag(), static_cast<float>(a));
}

/// e^x for x in -80 .. 0, to 2e-7.
HWY_INLINE V exp_of(V x) {
  const hn::RebindToSigned<Tag> whole;
  const V k = hn::Round(hn::Mul(x, set(1.4426950408889634)));
  const V f = hn::NegMulAdd(k, set(-2.12194440e-4), hn::NegMulAdd(k, set(0.693359375), x));
  V p = set(1.9875691500e-4);
  p = hn::MulAdd(p, f, set(1.3981999507e-3));
  p = hn::MulAdd(p, f, set(8.3334519073e-3));
  p = hn::MulAdd(p, f, set(4.1665795894e-2));
  p = hn::MulAdd(p, f, set(1.6666665459e-1));
  p = hn::MulAdd(p, f, set(5.0000001201e-1));
  p = hn::MulAdd(p, hn::Mul(f, f), hn::Add(f, set(1)));
  const auto power = hn::ShiftLeft<23>(hn::Add(hn::ConvertTo(whole, k), hn::Set(whole, 127)));
  return hn::Mul(p, hn::BitCast(Tag(), power));
}

HWY_INLINE V inverse_sqrt(V a) {
  const V guess = hn::ApproximateReciprocalSqrt(a);
  return hn::Mul(guess, hn::NegMulAdd(hn::Mul(hn::Mul(a, guess), guess), set(0.5), set(1.5)));
}
HWY_INLINE V inverse(V a) {
  const V guess = hn::ApproximateReciprocal(a);
  return hn::Mul(guess, hn::NegMulAdd(a, guess, set(2)));
}

constexpr double kFar = 4;  // beyond so many s the edge is 0 or 1 to 3e-5

struct Edge {
  V p;        // P
  V density;  // e^(-z^2/2)
};

/// z: distance from the half level in units of s.
HWY_INLINE Edge edge_at(V z) {
  const V size = hn::Min(hn::Abs(z), set(8));
  const V density = exp_of(hn::Mul(hn::Mul(size, size), set(-0.5)));
  const V t = inverse(hn::MulAdd(size, set(0.3275911 / 1.4142135623730951), set(1)));
  V p = set(0.5 * 1.061405429);
  p = hn::MulAdd(p, t, set(0.5 * -1.453152027));
  p = hn::MulAdd(p, t, set(0.5 * 1.421413741));
  p = hn::MulAdd(p, t, set(0.5 * -0.284496736));
  p = hn::MulAdd(p, t, set(0.5 * 0.254829592));
  const V tail = hn::Mul(hn::Mul(p, t), density);
  return {hn::IfThenElse(hn::Lt(z, hn::Zero(Tag())), hn::Sub(set(1), tail), tail), density};
}

/// Without the spare columns.
HWY_INLINE cv::Size frame_of(const cv::Mat1f& picture) {
  return {picture.cols - kSpareColumns, picture.rows};
}

/// A disc in the coordinates of the bordered picture, with what the pixels of a ring need.
struct Ring {
  int base_x, base_y;
  float x, y;  // centre from the base pixel
  double radius;
  V radius_v, variance, qxx, qxy, qyy, half_over_radius;
  V round_inv_s, round_shift;  // 1/s and s^2/2R where nothing moved
  bool moved;

  Ring(const Disc& disc, const EdgeBlur& blur)
      : base_x(static_cast<int>(std::lround(disc.x))),
        base_y(static_cast<int>(std::lround(disc.y))),
        x(static_cast<float>(disc.x - base_x)),
        y(static_cast<float>(disc.y - base_y)),
        radius(disc.radius),
        radius_v(set(disc.radius)),
        variance(set(blur.variance)),
        qxx(set(blur.motion[0])),
        qxy(set(2 * blur.motion[1])),
        qyy(set(blur.motion[2])),
        half_over_radius(set(0.5 / disc.radius)),
        round_inv_s(set(1 / std::sqrt(blur.variance))),
        round_shift(set(0.5 * blur.variance / disc.radius - disc.radius)),
        moved(blur.motion != std::array<double, 3>{}) {}

  struct Point {
    V r, nx, ny, inv_s, z;
  };
  HWY_INLINE Point at(V dx, V dy) const {
    Point q;
    const V r2 = hn::Max(hn::MulAdd(dx, dx, hn::Mul(dy, dy)), set(1e-6));
    const V inv_r = inverse_sqrt(r2);
    q.r = hn::Mul(r2, inv_r);
    q.nx = hn::Mul(dx, inv_r);
    q.ny = hn::Mul(dy, inv_r);
    if (!moved) {
      q.inv_s = round_inv_s;
      q.z = hn::Mul(hn::Add(q.r, round_shift), round_inv_s);
      return q;
    }
    const V across = hn::MulAdd(hn::Mul(qxx, q.nx), q.nx,
                                hn::MulAdd(hn::Mul(qyy, q.ny), q.ny, hn::Mul(hn::Mul(qxy, q.nx), q.ny)));
    const V s2 = hn::Max(hn::Add(variance, across), set(0.02));
    q.inv_s = inverse_sqrt(s2);
    q.z = hn::Mul(hn::MulAdd(s2, half_over_radius, hn::Sub(q.r, radius_v)), q.inv_s);
    return q;
  }

  /// Calls use(row, column, dx, dy^2 or dy, inside) for runs of pixels that touch low < r < high; inside: all
  /// of them are nearer than low, and passed over unless kFill.
  template <bool kFill, class Use>
  HWY_INLINE void over(cv::Size frame, double low, double high, int row_step, Use&& use) const {
    constexpr int n = static_cast<int>(hn::MaxLanes(Tag()));
    const Tag tag;
    const auto far = static_cast<float>(high), near = static_cast<float>(low);
    // Whole numbers below, without a call; never below -kShift.
    constexpr int kShift = 1 << 12;
    const auto floor_of = [](float a) { return static_cast<int>(a + kShift) - kShift; };
    const int first_row = std::max(-base_y, floor_of(y - far) + 1);
    const int last_row = std::min(frame.height - 1 - base_y, floor_of(y + far));
    const int last_column = frame.width - 1 - base_x;
    const V from_centre = hn::Sub(hn::Iota(tag, 0.0F), hn::Set(tag, x));
    const int beside = (base_y + first_row) % row_step;
    for (int row = first_row + (beside > 0 ? row_step - beside : 0); row <= last_row; row += row_step) {
      const float dy = static_cast<float>(row) - y, half = std::sqrt(std::max(0.0F, far * far - dy * dy));
      const bool holed = near - std::abs(dy) > 0.5F * n;
      const float gap = holed ? std::sqrt(near * near - dy * dy) : -1.0F;
      const int first = std::max(-base_x, floor_of(x - half) + 1),
                last = std::min(last_column, floor_of(x + half));
      for (int column = first; column <= last; column += n) {
        const bool inside =
            holed && static_cast<float>(column) > x - gap && static_cast<float>(column + n - 1) < x + gap;
        if (inside && !kFill) continue;
        use(row, column, hn::Add(from_centre, hn::Set(tag, static_cast<float>(column))), hn::Set(tag, dy),
            inside);
      }
    }
  }
};

/// Pixels of a ring, side by side, and what they say.
struct RingPixels {
  static constexpr std::size_t kMost = 512;
  using Row = std::array<float, kMost + kSpareColumns>;
  alignas(64) Row dx, dy, d, t;  // from the centre; picture; model
  alignas(64) Row w, residual, nx, ny, slope, p, by_s2;
};

template <BlurFit kBlur>
struct Sums {
  static constexpr int kF = RingSums::kFitted, kB = kBlur == BlurFit::none    ? 0
                                                    : kBlur == BlurFit::round ? 1
                                                                              : 3;
  static constexpr int kSome = kB > 0 ? kB : 1;

  /// What each pixel says.
  static HWY_INLINE void read(RingPixels& q, std::size_t n, const Ring& ring, const RingArgs& args,
                              const Disc& disc, RingSums& s) {
    const Tag tag;
    const V zero = hn::Zero(tag), one = set(1);
    const V a = set(disc.darkness), huber = set(args.huber);
    const V scale = set(disc.darkness / std::sqrt(2 * 3.14159265358979323846));
    V squares = zero, seen = zero, seen_squares = zero, tamed_squares = zero;
    for (std::size_t k = 0; k < n; k += hn::MaxLanes(tag)) {
      const Mask counts = hn::FirstN(tag, n - k);
      const Ring::Point at = ring.at(hn::Load(tag, &q.dx[k]), hn::Load(tag, &q.dy[k]));
      const V d = hn::Load(tag, &q.d[k]), t = hn::Load(tag, &q.t[k]);
      const Edge e = edge_at(at.z);
      const V bright = hn::Max(hn::Sub(one, t), zero);
      const V residual = hn::Sub(d, t), size = hn::Abs(residual);
      // Huber's weight, min(1, k/|residual|).
      const V cut = hn::Min(one, hn::Mul(huber, inverse(hn::Max(size, set(1e-6)))));
      const V variance = hn::MulAdd(set(args.light_variance), hn::Min(bright, one), set(args.dark_variance));
      const V w = hn::IfThenElseZero(counts, hn::Mul(cut, inverse(variance)));
      const V slope = hn::Mul(hn::Mul(scale, e.density), at.inv_s);  // a times -dP/dr
      hn::Store(w, tag, &q.w[k]);
      hn::Store(residual, tag, &q.residual[k]);
      hn::Store(at.nx, tag, &q.nx[k]);
      hn::Store(at.ny, tag, &q.ny[k]);
      hn::Store(slope, tag, &q.slope[k]);
      hn::Store(e.p, tag, &q.p[k]);
      // dP/d(s^2) = density (z/2s - 1/2R) / s: the half level moves along.
      if constexpr (kB > 0)
        hn::Store(hn::Mul(slope, hn::Sub(hn::Mul(hn::Mul(set(0.5), at.z), at.inv_s), ring.half_over_radius)),
                  tag, &q.by_s2[k]);
      squares = hn::MulAdd(hn::Mul(w, residual), residual, squares);
      const V rest = hn::IfThenElseZero(counts, hn::MulAdd(a, e.p, residual));
      seen = hn::Add(seen, rest);
      seen_squares = hn::MulAdd(rest, rest, seen_squares);
      const V tamed = hn::IfThenElseZero(counts, hn::Min(size, huber));
      tamed_squares = hn::MulAdd(tamed, tamed, tamed_squares);
    }
    s.pixels += static_cast<double>(n);
    s.squares += total(squares);
    s.seen += total(seen);
    s.seen_squares += total(seen_squares);
    s.residual_squares += total(tamed_squares);
  }

  /// The normal equations of x, y, R and a.
  static HWY_INLINE void gather(const RingPixels& q, std::size_t n, RingSums& s) {
    const Tag tag;
    V jj[kF * (kF + 1) / 2], jr[kF];
    for (V& v : jj) v = hn::Zero(tag);
    for (V& v : jr) v = hn::Zero(tag);
    for (std::size_t k = 0; k < n; k += hn::MaxLanes(tag)) {
      const V w = hn::Load(tag, &q.w[k]), residual = hn::Load(tag, &q.residual[k]),
              slope = hn::Load(tag, &q.slope[k]);
      const V j[kF] = {hn::Mul(slope, hn::Load(tag, &q.nx[k])), hn::Mul(slope, hn::Load(tag, &q.ny[k])),
                       slope, hn::Load(tag, &q.p[k])};
      int at = 0;
      for (int m = 0; m < kF; ++m) {
        const V wj = hn::Mul(w, j[m]);
        jr[m] = hn::MulAdd(wj, residual, jr[m]);
        for (int c = 0; c <= m; ++c, ++at) jj[at] = hn::MulAdd(wj, j[c], jj[at]);
      }
    }
    for (std::size_t m = 0; m < s.jj.size(); ++m) s.jj[m] += total(jj[m]);
    for (std::size_t m = 0; m < s.jr.size(); ++m) s.jr[m] += total(jr[m]);
  }

  /// Those of the blur, and what it shares with the four.
  static HWY_INLINE void gather_blur(const RingPixels& q, std::size_t n, RingSums& s) {
    const Tag tag;
    V jb[kF * kSome], bb[kSome * (kSome + 1) / 2], br[kSome];
    for (V& v : jb) v = hn::Zero(tag);
    for (V& v : bb) v = hn::Zero(tag);
    for (V& v : br) v = hn::Zero(tag);
    for (std::size_t k = 0; k < n; k += hn::MaxLanes(tag)) {
      const V w = hn::Load(tag, &q.w[k]), residual = hn::Load(tag, &q.residual[k]),
              slope = hn::Load(tag, &q.slope[k]);
      const V nx = hn::Load(tag, &q.nx[k]), ny = hn::Load(tag, &q.ny[k]), by_s2 = hn::Load(tag, &q.by_s2[k]);
      const V j[kF] = {hn::Mul(slope, nx), hn::Mul(slope, ny), slope, hn::Load(tag, &q.p[k])};
      V b[kSome];
      b[0] = by_s2;
      if constexpr (kB == 3) {
        b[0] = hn::Mul(by_s2, hn::Mul(nx, nx));
        b[1] = hn::Mul(by_s2, hn::Mul(set(2), hn::Mul(nx, ny)));
        b[2] = hn::Mul(by_s2, hn::Mul(ny, ny));
      }
      int at = 0;
      for (int m = 0; m < kSome; ++m) {
        const V wb = hn::Mul(w, b[m]);
        br[m] = hn::MulAdd(wb, residual, br[m]);
        for (int c = 0; c <= m; ++c, ++at) bb[at] = hn::MulAdd(wb, b[c], bb[at]);
        for (int c = 0; c < kF; ++c) jb[kSome * c + m] = hn::MulAdd(wb, j[c], jb[kSome * c + m]);
      }
    }
    for (int m = 0; m < kSome * (kSome + 1) / 2; ++m) s.bb[static_cast<std::size_t>(m)] += total(bb[m]);
    for (int m = 0; m < kSome; ++m) s.br[static_cast<std::size_t>(m)] += total(br[m]);
    for (int m = 0; m < kF; ++m)
      for (int c = 0; c < kSome; ++c)
        s.jb[std::size_t{RingSums::kBlurs} * static_cast<std::size_t>(m) + static_cast<std::size_t>(c)] +=
            total(jb[kSome * m + c]);
  }

  static HWY_INLINE double total(V v) { return static_cast<double>(hn::GetLane(hn::SumOfLanes(Tag(), v))); }

  static HWY_INLINE RingSums of(const RingArgs& args, const Disc& disc) {
    const Ring ring(disc, args.blur);
    const Tag tag;
    RingPixels q;
    RingSums s;
    std::size_t n = 0;
    const auto flush = [&]() HWY_ATTR {
      // What stands behind the last pixel counts for nothing, but must be numbers.
      for (RingPixels::Row* row : {&q.dx, &q.dy, &q.d, &q.t}) hn::StoreU(hn::Zero(tag), tag, row->data() + n);
      read(q, n, ring, args, disc, s);
      gather(q, n, s);
      if constexpr (kB > 0) gather_blur(q, n, s);
      n = 0;
    };
    const double low = std::max(0.0, disc.radius - args.ring), high = disc.radius + args.ring;
    const V low2 = set(low * low), high2 = set(high * high), unseen = set(static_cast<double>(kUnseen));
    ring.over<false>(
        frame_of(*args.picture), low, high, args.row_step,
        [&](int row, int column, V dx, V dy, bool) HWY_ATTR {
          const V r2 = hn::MulAdd(dx, dx, hn::Mul(dy, dy));
          const V d = hn::LoadU(tag, args.picture->ptr<float>(ring.base_y + row) + ring.base_x + column);
          const V t = hn::LoadU(tag, args.model->ptr<float>(ring.base_y + row) + ring.base_x + column);
          const Mask counts = hn::And(hn::And(hn::Gt(r2, low2), hn::Lt(r2, high2)), hn::Lt(d, unseen));
          hn::StoreU(hn::Compress(dx, counts), tag, &q.dx[n]);
          hn::StoreU(hn::Compress(dy, counts), tag, &q.dy[n]);
          hn::StoreU(hn::Compress(d, counts), tag, &q.d[n]);
          hn::StoreU(hn::Compress(t, counts), tag, &q.t[n]);
          n += hn::CountTrue(tag, counts);
          if (n + hn::MaxLanes(tag) > RingPixels::kMost) flush();
        });
    if (n > 0) flush();
    return s;
  }
};

PairSums pair(const RingArgs& args, const Disc& a, const Disc& b) {
  constexpr int n = static_cast<int>(hn::MaxLanes(Tag()));
  const Tag tag;
  const std::array<const Disc*, 2> discs = {&a, &b};
  const std::array<Ring, 2> rings = {Ring(a, args.blur), Ring(b, args.blur)};
  V low2[2], high2[2], scale[2];
  for (std::size_t q = 0; q < 2; ++q) {
    const double low = std::max(0.0, discs[q]->radius - args.ring), high = discs[q]->radius + args.ring;
    low2[q] = set(low * low), high2[q] = set(high * high);
    scale[q] = set(discs[q]->darkness / std::sqrt(2 * 3.14159265358979323846));
  }
  const double reach_a = a.radius + args.ring, reach_b = b.radius + args.ring;
  const cv::Mat1f& picture = *args.picture;
  const int last_column = picture.cols - kSpareColumns - 1;
  const int first_row = std::max(0, static_cast<int>(std::ceil(std::max(a.y - reach_a, b.y - reach_b))));
  const int last_row = std::min(picture.rows - 1, static_cast<int>(std::min(a.y + reach_a, b.y + reach_b)));
  V sums[16];
  for (V& v : sums) v = hn::Zero(tag);
  const int beside = first_row % args.row_step;
  for (int y = first_row + (beside > 0 ? args.row_step - beside : 0); y <= last_row; y += args.row_step) {
    const auto half = [&](const Disc& d, double reach) {
      return std::sqrt(static_cast<float>(std::max(0.0, reach * reach - (y - d.y) * (y - d.y))));
    };
    const auto half_a = static_cast<double>(half(a, reach_a)), half_b = static_cast<double>(half(b, reach_b));
    const int first = std::max(0, static_cast<int>(std::max(a.x - half_a, b.x - half_b)));
    const int last = std::min(last_column, static_cast<int>(std::min(a.x + half_a, b.x + half_b)));
    for (int x = first; x <= last; x += n) {
      const V d = hn::LoadU(tag, picture.ptr<float>(y) + x),
              t = hn::LoadU(tag, args.model->ptr<float>(y) + x);
      Mask counts = hn::Lt(d, set(static_cast<double>(kUnseen)));
      V dx[2], dy[2];
      for (std::size_t q = 0; q < 2; ++q) {
        const Ring& ring = rings[q];
        dx[q] = hn::Sub(hn::Iota(tag, static_cast<float>(x - ring.base_x)), hn::Set(tag, ring.x));
        dy[q] = hn::Set(tag, static_cast<float>(y - ring.base_y) - ring.y);
        const V r2 = hn::MulAdd(dx[q], dx[q], hn::Mul(dy[q], dy[q]));
        counts = hn::And(counts, hn::And(hn::Gt(r2, low2[q]), hn::Lt(r2, high2[q])));
      }
      if (hn::AllFalse(tag, counts)) continue;
      V j[2][4];
      for (std::size_t q = 0; q < 2; ++q) {
        const Ring::Point at = rings[q].at(dx[q], dy[q]);
        const Edge e = edge_at(at.z);
        const V slope = hn::Mul(hn::Mul(scale[q], e.density), at.inv_s);
        j[q][0] = hn::Mul(slope, at.nx);
        j[q][1] = hn::Mul(slope, at.ny);
        j[q][2] = slope;
        j[q][3] = e.p;
      }
      const V bright = hn::Max(hn::Sub(set(1), t), hn::Zero(tag)), size = hn::Abs(hn::Sub(d, t));
      const V cut = hn::Min(set(1), hn::Mul(set(args.huber), inverse(hn::Max(size, set(1e-6)))));
      const V variance =
          hn::MulAdd(set(args.light_variance), hn::Min(bright, set(1)), set(args.dark_variance));
      const V w = hn::IfThenElseZero(counts, hn::Mul(cut, inverse(variance)));
      for (int m = 0; m < 4; ++m) {
        const V wj = hn::Mul(w, j[0][m]);
        for (int k = 0; k < 4; ++k) sums[4 * m + k] = hn::MulAdd(wj, j[1][k], sums[4 * m + k]);
      }
    }
  }
  PairSums total;
  for (std::size_t m = 0; m < 16; ++m)
    total[m] = static_cast<double>(hn::GetLane(hn::SumOfLanes(tag, sums[m])));
  return total;
}

RingSums fixed_blur(const RingArgs& args, const Disc& disc) {
  return Sums<BlurFit::none>::of(args, disc);
}
RingSums round_blur(const RingArgs& args, const Disc& disc) {
  return Sums<BlurFit::round>::of(args, disc);
}
RingSums motion_blur(const RingArgs& args, const Disc& disc) {
  return Sums<BlurFit::motion>::of(args, disc);
}

void add(cv::Mat1f& model, const Disc& disc, const EdgeBlur& blur, int row_step) {
  const Ring ring(disc, blur);
  const Tag tag;
  const double s = std::sqrt(blur.variance + std::max(0.0, blur.motion[0] + blur.motion[2]));
  const V a = set(disc.darkness);
  ring.over<true>(frame_of(model), disc.radius - kFar * s, disc.radius + kFar * s, row_step,
                  [&](int row, int column, V dx, V dy, bool inside) HWY_ATTR {
                    float* at = model.ptr<float>(ring.base_y + row) + ring.base_x + column;
                    const V old = hn::LoadU(tag, at);
                    if (inside) {
                      hn::StoreU(hn::Add(old, a), tag, at);
                    } else {
                      hn::StoreU(hn::MulAdd(a, edge_at(ring.at(dx, dy).z).p, old), tag, at);
                    }
                  });
}

DiscMoments moments(const cv::Mat1f& picture, cv::Size size, const Disc& disc) {
  const Ring ring(disc, EdgeBlur{});
  const Tag tag;
  const V reach2 = set(disc.radius * disc.radius), zero = hn::Zero(tag);
  V mass = zero, x = zero, y = zero, xx = zero, xy = zero, yy = zero, most = zero;
  ring.over<true>(size, 0, disc.radius, 1, [&](int row, int column, V dx, V dy, bool) HWY_ATTR {
    const V d = hn::LoadU(tag, picture.ptr<float>(ring.base_y + row) + ring.base_x + column);
    // The last run of a row may reach beyond the frame.
    const Mask counts = hn::And(hn::Lt(hn::MulAdd(dx, dx, hn::Mul(dy, dy)), reach2),
                                hn::FirstN(tag, static_cast<std::size_t>(size.width - ring.base_x - column)));
    const V v = hn::IfThenElseZero(counts, hn::Max(d, zero)), vx = hn::Mul(v, dx), vy = hn::Mul(v, dy);
    mass = hn::Add(mass, v);
    x = hn::Add(x, vx);
    y = hn::Add(y, vy);
    xx = hn::MulAdd(vx, dx, xx);
    xy = hn::MulAdd(vx, dy, xy);
    yy = hn::MulAdd(vy, dy, yy);
    most = hn::Max(most, v);
  });
  const auto total = [&](V v) HWY_ATTR { return static_cast<double>(hn::GetLane(hn::SumOfLanes(tag, v))); };
  return {total(mass),
          total(x),
          total(y),
          total(xx),
          total(xy),
          total(yy),
          static_cast<double>(hn::GetLane(hn::MaxOfLanes(tag, most)))};
}

}  // namespace twincell::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace twincell {

HWY_EXPORT(fixed_blur);
HWY_EXPORT(round_blur);
HWY_EXPORT(motion_blur);
HWY_EXPORT(pair);
HWY_EXPORT(add);
HWY_EXPORT(moments);

RingSums ring_sums(const RingArgs& args, const Disc& disc, BlurFit fit) {
  if (fit == BlurFit::none) return HWY_DYNAMIC_DISPATCH(fixed_blur)(args, disc);
  if (fit == BlurFit::round) return HWY_DYNAMIC_DISPATCH(round_blur)(args, disc);
  return HWY_DYNAMIC_DISPATCH(motion_blur)(args, disc);
}

PairSums pair_sums(const RingArgs& args, const Disc& i, const Disc& j) {
  return HWY_DYNAMIC_DISPATCH(pair)(args, i, j);
}

void add_disc(cv::Mat1f& model, const Disc& disc, const EdgeBlur& blur, int row_step) {
  HWY_DYNAMIC_DISPATCH(add)(model, disc, blur, row_step);
}

DiscMoments disc_moments(const cv::Mat1f& picture, cv::Size size, const Disc& disc) {
  return HWY_DYNAMIC_DISPATCH(moments)(picture, size, disc);
}

}  // namespace twincell
#endif
