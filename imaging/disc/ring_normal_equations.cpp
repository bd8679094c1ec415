#include "imaging/disc/ring_normal_equations.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

// This file is compiled once for each SIMD target.
#ifndef TWINCELL_RING_NORMAL_EQUATIONS_ONCE
#define TWINCELL_RING_NORMAL_EQUATIONS_ONCE
namespace twincell::imaging::ring_normal_equations {

/// Gauss-Legendre node on -1/2 .. 1/2.
struct GaussNode {
  double at, weight;
};

/// The nodes of the Legendre polynomial of degree n, by Newton's method.
inline std::vector<GaussNode> gauss_nodes(int n) {
  std::vector<GaussNode> nodes;
  for (int k = 0; k < n; ++k) {
    double x = std::cos(std::numbers::pi * (k + 0.75) / (n + 0.5)), slope = 1;
    for (int step = 0; step < 10; ++step) {
      double before = 1, p = x;
      for (int m = 2; m <= n; ++m) before = std::exchange(p, ((2 * m - 1) * x * p - (m - 1) * before) / m);
      slope = n * (x * p - before) / (x * x - 1);
      x -= p / slope;
    }
    nodes.push_back({0.5 * x, 1 / ((1 - x * x) * slope * slope)});
  }
  return nodes;
}

/// The nodes for the path of a blur: two, and one more for each s of its length, up to 12.
inline std::span<const GaussNode> nodes_of(const EdgeBlur& blur) {
  constexpr int kMinNodes = 2, kMaxNodes = 12;
  if (blur.path == std::array<double, 2>{}) return {};
  static const std::vector<std::vector<GaussNode>> kNodes = [] {
    std::vector<std::vector<GaussNode>> all;
    for (int n = kMinNodes; n <= kMaxNodes; ++n) all.push_back(gauss_nodes(n));
    return all;
  }();
  const double widths = std::hypot(blur.path[0], blur.path[1]) / std::sqrt(blur.variance);
  return kNodes[static_cast<std::size_t>(std::min(widths, 1.0 * (kMaxNodes - kMinNodes)))];
}

}  // namespace twincell::imaging::ring_normal_equations
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "imaging/disc/ring_normal_equations.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "imaging/disc/masked_load.hpp"

HWY_BEFORE_NAMESPACE();
namespace twincell::imaging::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using ring_normal_equations::GaussNode, ring_normal_equations::nodes_of;

// A row of a ring has about twenty pixels: with wider vectors more lanes would be idle.
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

constexpr double kEdgeReach = 4;  // in units of s; beyond this distance the edge is 0 or 1 to 3e-5

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

/// Size of the frame, without the spare columns.
HWY_INLINE cv::Size frame_of(const cv::Mat1f& picture) {
  return {picture.cols - kSpareColumns, picture.rows};
}

/// P at a pixel, and the derivatives of a P with respect to x, y, R and the blur parameters.
template <int kBlurs>
struct Slopes {
  V p, x, y, radius;
  V blur[kBlurs > 0 ? kBlurs : 1];
};

constexpr int blurs_of(BlurFit fit) {
  return fit == BlurFit::none ? 0 : fit == BlurFit::round ? 1 : RingSums::kBlurs;
}

/// A disc relative to a base pixel, with the constants that all pixels of its ring use.
struct Ring {
  int base_x, base_y;
  float x, y;  // centre from the base pixel
  V half_over_radius, inv_s, shift, steepest;
  std::span<const GaussNode> nodes;  // of the path; empty if there is no motion
  std::array<double, 2> path;

  Ring(const Disc& disc, const EdgeBlur& blur)
      : base_x(static_cast<int>(std::lround(disc.x))),
        base_y(static_cast<int>(std::lround(disc.y))),
        x(static_cast<float>(disc.x - base_x)),
        y(static_cast<float>(disc.y - base_y)),
        half_over_radius(set(0.5 / disc.radius)),
        inv_s(set(1 / std::sqrt(blur.variance))),
        shift(set(0.5 * blur.variance / disc.radius - disc.radius)),
        steepest(set(disc.darkness / std::sqrt(2 * std::numbers::pi * blur.variance))),
        nodes(nodes_of(blur)),
        path(blur.path) {}

  struct Point {
    V nx, ny, z;
  };
  HWY_INLINE Point at(V dx, V dy) const {
    const V r2 = hn::Max(hn::MulAdd(dx, dx, hn::Mul(dy, dy)), set(1e-6));
    const V inv_r = inverse_sqrt(r2);
    return {hn::Mul(dx, inv_r), hn::Mul(dy, inv_r), hn::Mul(hn::MulAdd(r2, inv_r, shift), inv_s)};
  }
  /// dP/d(s^2) = density (z/2s - 1/2R) / s: the half level depends on s too.
  HWY_INLINE V by_variance(V z, V slope) const {
    return hn::Mul(slope, hn::Sub(hn::Mul(hn::Mul(set(0.5), z), inv_s), half_over_radius));
  }

  HWY_INLINE V value(V dx, V dy) const {
    if (nodes.empty()) return edge_at(at(dx, dy).z).p;
    V p = hn::Zero(Tag());
    for (const GaussNode& node : nodes)
      p = hn::MulAdd(set(node.weight), edge_at(passed(node, dx, dy).z).p, p);
    return p;
  }
  template <BlurFit kBlur>
  HWY_INLINE Slopes<blurs_of(kBlur)> slopes(V dx, V dy) const {
    Slopes<blurs_of(kBlur)> q;
    if (nodes.empty()) {
      const Point here = at(dx, dy);
      const Edge e = edge_at(here.z);
      q.p = e.p;
      q.radius = hn::Mul(e.density, steepest);
      q.x = hn::Mul(q.radius, here.nx);
      q.y = hn::Mul(q.radius, here.ny);
      if constexpr (kBlur != BlurFit::none) q.blur[0] = by_variance(here.z, q.radius);
      if constexpr (kBlur == BlurFit::uneven) {
        const V by_s2 = q.blur[0];
        q.blur[0] = hn::Mul(by_s2, hn::Mul(here.nx, here.nx));
        q.blur[1] = hn::Mul(by_s2, hn::Mul(set(2), hn::Mul(here.nx, here.ny)));
        q.blur[2] = hn::Mul(by_s2, hn::Mul(here.ny, here.ny));
      } else if constexpr (kBlur == BlurFit::path) {
        q.blur[1] = q.blur[2] = hn::Zero(Tag());
      }
      return q;
    }
    q.p = q.x = q.y = q.radius = hn::Zero(Tag());
    for (V& v : q.blur) v = hn::Zero(Tag());
    for (const GaussNode& node : nodes) {
      const Point here = passed(node, dx, dy);
      const Edge e = edge_at(here.z);
      const V slope = hn::Mul(hn::Mul(set(node.weight), steepest), e.density);
      const V by_x = hn::Mul(slope, here.nx), by_y = hn::Mul(slope, here.ny);
      q.p = hn::MulAdd(set(node.weight), e.p, q.p);
      q.radius = hn::Add(q.radius, slope);
      q.x = hn::Add(q.x, by_x);
      q.y = hn::Add(q.y, by_y);
      if constexpr (kBlur != BlurFit::none) q.blur[0] = hn::Add(q.blur[0], by_variance(here.z, slope));
      if constexpr (kBlur == BlurFit::path) {
        q.blur[1] = hn::MulAdd(set(node.at), by_x, q.blur[1]);
        q.blur[2] = hn::MulAdd(set(node.at), by_y, q.blur[2]);
      }
    }
    return q;
  }
  /// A pixel relative to the disc at a node of its path.
  HWY_INLINE Point passed(const GaussNode& node, V dx, V dy) const {
    return at(hn::Sub(dx, set(node.at * path[0])), hn::Sub(dy, set(node.at * path[1])));
  }

  /// Calls use(row, column, dx, dy, inside) for runs of pixels that touch low < r < high. `inside` means that
  /// all pixels of the run are nearer than low; such runs are skipped unless kFill.
  template <bool kFill, class Use>
  HWY_INLINE void over(cv::Size frame, double low, double high, int row_step, Use&& use) const {
    constexpr int n = static_cast<int>(hn::MaxLanes(Tag()));
    const Tag tag;
    const auto far = static_cast<float>(high), near = static_cast<float>(low);
    // Floor without a function call, for numbers not below -kShift.
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

/// Pixels of a ring in contiguous arrays, and their derivatives, weights and residuals.
struct RingPixels {
  static constexpr std::size_t kCapacity = 512;  // pixels
  using Row = std::array<float, kCapacity + kSpareColumns>;
  alignas(64) Row dx, dy, d, t;  // from the centre; picture; model
  // The derivatives overwrite the input, so that all arrays stay in the first-level cache.
  Row &x = dx, &y = dy, &radius = d, &p = t;
  alignas(64) Row w, residual;
  alignas(64) Row blur[RingSums::kBlurs];
};

/// The sums over one ring, for one choice of blur parameters.
template <BlurFit kBlur>
struct Sums {
  static constexpr int kF = RingSums::kFitted, kB = blurs_of(kBlur);
  static constexpr int kBlurLength = kB > 0 ? kB : 1;  // of arrays over the blur parameters, not 0

  /// Computes weight, residual and derivatives of each pixel.
  static HWY_INLINE void read(RingPixels& q, std::size_t n, const Ring& ring, const RingArgs& args,
                              const Disc& disc, RingSums& s) {
    const Tag tag;
    const V zero = hn::Zero(tag), one = set(1);
    const V a = set(disc.darkness), huber = set(args.huber);
    V squares = zero, seen = zero, seen_squares = zero, tamed_squares = zero;
    for (std::size_t k = 0; k < n; k += hn::MaxLanes(tag)) {
      const Mask counts = hn::FirstN(tag, n - k);
      const auto e = ring.slopes<kBlur>(hn::Load(tag, &q.dx[k]), hn::Load(tag, &q.dy[k]));
      const V d = hn::Load(tag, &q.d[k]), t = hn::Load(tag, &q.t[k]);
      const V bright = hn::Max(hn::Sub(one, t), zero);
      const V residual = hn::Sub(d, t), size = hn::Abs(residual);
      // Huber weight, min(1, huber/|residual|).
      const V cut = hn::Min(one, hn::Mul(huber, inverse(hn::Max(size, set(1e-6)))));
      const V variance = hn::MulAdd(set(args.light_variance), hn::Min(bright, one), set(args.dark_variance));
      const V w = hn::IfThenElseZero(counts, hn::Mul(cut, inverse(variance)));
      hn::Store(w, tag, &q.w[k]);
      hn::Store(residual, tag, &q.residual[k]);
      hn::Store(e.x, tag, &q.x[k]);
      hn::Store(e.y, tag, &q.y[k]);
      hn::Store(e.radius, tag, &q.radius[k]);
      hn::Store(e.p, tag, &q.p[k]);
      for (int b = 0; b < kB; ++b) hn::Store(e.blur[b], tag, &q.blur[b][k]);
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

  /// Sums the normal equations of x, y, R and a.
  static HWY_INLINE void gather(const RingPixels& q, std::size_t n, RingSums& s) {
    const Tag tag;
    V jj[kF * (kF + 1) / 2], jr[kF];
    for (V& v : jj) v = hn::Zero(tag);
    for (V& v : jr) v = hn::Zero(tag);
    for (std::size_t k = 0; k < n; k += hn::MaxLanes(tag)) {
      const V w = hn::Load(tag, &q.w[k]), residual = hn::Load(tag, &q.residual[k]);
      const V j[kF] = {hn::Load(tag, &q.x[k]), hn::Load(tag, &q.y[k]), hn::Load(tag, &q.radius[k]),
                       hn::Load(tag, &q.p[k])};
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

  /// Sums the normal equations of the blur, and its coupling to x, y, R and a.
  static HWY_INLINE void gather_blur(const RingPixels& q, std::size_t n, RingSums& s) {
    const Tag tag;
    V jb[kF * kBlurLength], bb[kBlurLength * (kBlurLength + 1) / 2], br[kBlurLength];
    for (V& v : jb) v = hn::Zero(tag);
    for (V& v : bb) v = hn::Zero(tag);
    for (V& v : br) v = hn::Zero(tag);
    for (std::size_t k = 0; k < n; k += hn::MaxLanes(tag)) {
      const V w = hn::Load(tag, &q.w[k]), residual = hn::Load(tag, &q.residual[k]);
      const V j[kF] = {hn::Load(tag, &q.x[k]), hn::Load(tag, &q.y[k]), hn::Load(tag, &q.radius[k]),
                       hn::Load(tag, &q.p[k])};
      V b[kBlurLength];
      for (int m = 0; m < kBlurLength; ++m) b[m] = hn::Load(tag, &q.blur[m][k]);
      int at = 0;
      for (int m = 0; m < kBlurLength; ++m) {
        const V wb = hn::Mul(w, b[m]);
        br[m] = hn::MulAdd(wb, residual, br[m]);
        for (int c = 0; c <= m; ++c, ++at) bb[at] = hn::MulAdd(wb, b[c], bb[at]);
        for (int c = 0; c < kF; ++c) jb[kBlurLength * c + m] = hn::MulAdd(wb, j[c], jb[kBlurLength * c + m]);
      }
    }
    for (int m = 0; m < kBlurLength * (kBlurLength + 1) / 2; ++m)
      s.bb[static_cast<std::size_t>(m)] += total(bb[m]);
    for (int m = 0; m < kBlurLength; ++m) s.br[static_cast<std::size_t>(m)] += total(br[m]);
    for (int m = 0; m < kF; ++m)
      for (int c = 0; c < kBlurLength; ++c)
        s.jb[std::size_t{RingSums::kBlurs} * static_cast<std::size_t>(m) + static_cast<std::size_t>(c)] +=
            total(jb[kBlurLength * m + c]);
  }

  static HWY_INLINE double total(V v) { return static_cast<double>(hn::GetLane(hn::SumOfLanes(Tag(), v))); }

  static HWY_INLINE RingSums of(const RingArgs& args, const Disc& disc) {
    const Ring ring(disc, args.blur);
    const Tag tag;
    RingPixels q;
    RingSums s;
    std::size_t n = 0;
    const auto flush = [&]() HWY_ATTR {
      // The lanes behind the last pixel have weight 0, but must be finite.
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
          const LaneCompaction compact(counts);
          hn::StoreU(compact(dx), tag, &q.dx[n]);
          hn::StoreU(compact(dy), tag, &q.dy[n]);
          hn::StoreU(compact(d), tag, &q.d[n]);
          hn::StoreU(compact(t), tag, &q.t[n]);
          n += compact.count();
          if (n + hn::MaxLanes(tag) > RingPixels::kCapacity) flush();
        });
    if (n > 0) flush();
    return s;
  }
};

/// Sums over the pixels that the rings of two discs share.
class SharedPixels {
 public:
  SharedPixels(const RingArgs& args, const Disc& a, const Disc& b)
      : args_(args), rings_{Ring(a, args.blur), Ring(b, args.blur)} {
    for (V& v : sums_) v = hn::Zero(Tag());
    const std::array<const Disc*, 2> discs = {&a, &b};
    for (std::size_t q = 0; q < 2; ++q) {
      const double low = std::max(0.0, discs[q]->radius - args.ring), high = discs[q]->radius + args.ring;
      low2_[q] = set(low * low), high2_[q] = set(high * high);
    }
    beside_x_ = static_cast<float>(rings_[0].base_x - rings_[1].base_x) + rings_[0].x - rings_[1].x;
    beside_y_ = static_cast<float>(rings_[0].base_y - rings_[1].base_y) + rings_[0].y - rings_[1].y;
  }

  /// Collects the pixels of a vector that are in both rings. Most rows of the overlap are narrow, so pixels
  /// are compacted before they are summed.
  HWY_INLINE void take(int x, int y) {
    const Tag tag;
    const Ring& ring = rings_[0];
    const V d = hn::LoadU(tag, args_.picture->ptr<float>(y) + x);
    const V dx = hn::Sub(hn::Iota(tag, static_cast<float>(x - ring.base_x)), hn::Set(tag, ring.x)),
            dy = hn::Set(tag, static_cast<float>(y - ring.base_y) - ring.y);
    const V other_dx = hn::Add(dx, hn::Set(tag, beside_x_)), other_dy = hn::Add(dy, hn::Set(tag, beside_y_));
    const V r2 = hn::MulAdd(dx, dx, hn::Mul(dy, dy)),
            other_r2 = hn::MulAdd(other_dx, other_dx, hn::Mul(other_dy, other_dy));
    const Mask counts = hn::And(hn::Lt(d, set(static_cast<double>(kUnseen))),
                                hn::And(hn::And(hn::Gt(r2, low2_[0]), hn::Lt(r2, high2_[0])),
                                        hn::And(hn::Gt(other_r2, low2_[1]), hn::Lt(other_r2, high2_[1]))));
    if (hn::AllFalse(tag, counts)) return;
    const LaneCompaction compact(counts);
    hn::StoreU(compact(dx), tag, &dx_[n_]);
    hn::StoreU(compact(dy), tag, &dy_[n_]);
    hn::StoreU(compact(d), tag, &d_[n_]);
    hn::StoreU(compact(hn::LoadU(tag, args_.model->ptr<float>(y) + x)), tag, &t_[n_]);
    n_ += compact.count();
    if (n_ + hn::MaxLanes(tag) > kCapacity) add();
  }

  PairSums sums() {
    if (n_ > 0) add();
    PairSums total;
    for (std::size_t m = 0; m < total.size(); ++m)
      total[m] = static_cast<double>(hn::GetLane(hn::SumOfLanes(Tag(), sums_[m])));
    return total;
  }

 private:
  static constexpr std::size_t kCapacity = 128;  // pixels
  using Row = std::array<float, kCapacity + kSpareColumns>;

  HWY_INLINE void add() {
    const Tag tag;
    // The lanes behind the last pixel have weight 0, but must be finite.
    for (Row* row : {&dx_, &dy_, &d_, &t_}) hn::StoreU(hn::Zero(tag), tag, row->data() + n_);
    for (std::size_t k = 0; k < n_; k += hn::MaxLanes(tag)) {
      const V dx = hn::Load(tag, &dx_[k]), dy = hn::Load(tag, &dy_[k]), d = hn::Load(tag, &d_[k]),
              t = hn::Load(tag, &t_[k]);
      const auto one = rings_[0].template slopes<BlurFit::none>(dx, dy);
      const auto other = rings_[1].template slopes<BlurFit::none>(hn::Add(dx, hn::Set(tag, beside_x_)),
                                                                  hn::Add(dy, hn::Set(tag, beside_y_)));
      const V bright = hn::Max(hn::Sub(set(1), t), hn::Zero(tag)), size = hn::Abs(hn::Sub(d, t));
      const V cut = hn::Min(set(1), hn::Mul(set(args_.huber), inverse(hn::Max(size, set(1e-6)))));
      const V variance =
          hn::MulAdd(set(args_.light_variance), hn::Min(bright, set(1)), set(args_.dark_variance));
      const V w = hn::IfThenElseZero(hn::FirstN(tag, n_ - k), hn::Mul(cut, inverse(variance)));
      const std::array<V, 4> j = {hn::Mul(w, one.x), hn::Mul(w, one.y), hn::Mul(w, one.radius),
                                  hn::Mul(w, one.p)},
                             i = {other.x, other.y, other.radius, other.p};
      for (std::size_t m = 0; m < 4; ++m)
        for (std::size_t c = 0; c < 4; ++c) sums_[4 * m + c] = hn::MulAdd(j[m], i[c], sums_[4 * m + c]);
    }
    n_ = 0;
  }

  const RingArgs& args_;
  std::array<Ring, 2> rings_;
  V low2_[2], high2_[2], sums_[16];
  float beside_x_, beside_y_;        // centre of the first disc relative to the second
  alignas(64) Row dx_, dy_, d_, t_;  // position from the first disc; picture; model
  std::size_t n_ = 0;
};

PairSums pair(const RingArgs& args, const Disc& a, const Disc& b) {
  constexpr int n = static_cast<int>(hn::MaxLanes(Tag()));
  SharedPixels shared(args, a, b);
  const double reach_a = a.radius + args.ring, reach_b = b.radius + args.ring;
  const cv::Size frame = frame_of(*args.picture);
  const int first_row = std::max(0, static_cast<int>(std::ceil(std::max(a.y - reach_a, b.y - reach_b))));
  const int last_row = std::min(frame.height - 1, static_cast<int>(std::min(a.y + reach_a, b.y + reach_b)));
  const int beside = first_row % args.row_step;
  for (int y = first_row + (beside > 0 ? args.row_step - beside : 0); y <= last_row; y += args.row_step) {
    const auto half = [&](const Disc& d, double reach) {
      return static_cast<double>(
          std::sqrt(static_cast<float>(std::max(0.0, reach * reach - (y - d.y) * (y - d.y)))));
    };
    const double half_a = half(a, reach_a), half_b = half(b, reach_b);
    const int first = std::max(0, static_cast<int>(std::max(a.x - half_a, b.x - half_b)));
    const int last = std::min(frame.width - 1, static_cast<int>(std::min(a.x + half_a, b.x + half_b)));
    for (int x = first; x <= last; x += n) shared.take(x, y);
  }
  return shared.sums();
}

RingSums fixed_blur(const RingArgs& args, const Disc& disc) {
  return Sums<BlurFit::none>::of(args, disc);
}
RingSums round_blur(const RingArgs& args, const Disc& disc) {
  return Sums<BlurFit::round>::of(args, disc);
}
RingSums uneven_blur(const RingArgs& args, const Disc& disc) {
  return Sums<BlurFit::uneven>::of(args, disc);
}
RingSums path_blur(const RingArgs& args, const Disc& disc) {
  return Sums<BlurFit::path>::of(args, disc);
}

void add(cv::Mat1f& model, const Disc& disc, const EdgeBlur& blur, int row_step) {
  const Ring ring(disc, blur);
  const Tag tag;
  const V a = set(disc.darkness);
  const double reach = blur.reach(kEdgeReach);
  ring.over<true>(frame_of(model), disc.radius - reach, disc.radius + reach, row_step,
                  [&](int row, int column, V dx, V dy, bool inside) HWY_ATTR {
                    float* at = model.ptr<float>(ring.base_y + row) + ring.base_x + column;
                    const V old = hn::LoadU(tag, at);
                    if (inside) {
                      hn::StoreU(hn::Add(old, a), tag, at);
                    } else {
                      hn::StoreU(hn::MulAdd(a, ring.value(dx, dy), old), tag, at);
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
    // The last run of a row may extend beyond the frame.
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

}  // namespace twincell::imaging::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace twincell::imaging {

HWY_EXPORT(fixed_blur);
HWY_EXPORT(round_blur);
HWY_EXPORT(uneven_blur);
HWY_EXPORT(path_blur);
HWY_EXPORT(pair);
HWY_EXPORT(add);
HWY_EXPORT(moments);

RingSums ring_sums(const RingArgs& args, const Disc& disc, BlurFit fit) {
  if (fit == BlurFit::none) return HWY_DYNAMIC_DISPATCH(fixed_blur)(args, disc);
  if (fit == BlurFit::round) return HWY_DYNAMIC_DISPATCH(round_blur)(args, disc);
  if (fit == BlurFit::uneven) return HWY_DYNAMIC_DISPATCH(uneven_blur)(args, disc);
  return HWY_DYNAMIC_DISPATCH(path_blur)(args, disc);
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

}  // namespace twincell::imaging
#endif
