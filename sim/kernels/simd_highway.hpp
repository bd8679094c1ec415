#pragma once
/// \file
/// SIMD lanes by Highway: as many contacts at a time as the instruction set of this translation unit allows,
/// 4 with AVX2, 8 with AVX-512. All code is in a namespace of that instruction set.

#include <hwy/highway.h>

#include "sim/kernels/kernels.hpp"

#define TWINCELL_LANES HWY_ATTR

namespace twincell::sim::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using All = hn::ScalableTag<double>;
using Four = hn::FixedTag<double, 4>;
using Two = hn::FixedTag<double, 2>;
using One = hn::FixedTag<double, 1>;

/// A SIMD vector of numbers with the operations of laws/scalar_arithmetic.hpp. Two vectors in parallel, to
/// fill the gaps in one contact's long chain of dependent operations, were tried and dropped (a fifth
/// slower): the arithmetic units are already busy, and there are too few registers.
struct Pack {
  using Tag = All;
  using Raw = hn::Vec<Tag>;
  static constexpr std::size_t kLanes = hn::MaxLanes(Tag());
  Raw raw;
  struct Mask {
    hn::Mask<Tag> raw;
    HWY_INLINE friend bool any(Mask m) { return !hn::AllFalse(Tag(), m.raw); }
    HWY_INLINE friend Mask both(Mask a, Mask b) { return {hn::And(a.raw, b.raw)}; }
    HWY_INLINE friend Mask either(Mask a, Mask b) { return {hn::Or(a.raw, b.raw)}; }
    /// Returns one bit per lane.
    friend unsigned mask_bits(Mask m) {
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(Tag(), m.raw, bits);
      return bits[0] | static_cast<unsigned>(bits[1]) << 8;
    }
  };

  HWY_INLINE Pack() : raw(hn::Zero(Tag())) {}
  HWY_INLINE Pack(Raw r) : raw(r) {}  // NOLINT(google-explicit-constructor)
  HWY_INLINE explicit Pack(double a) : raw(hn::Set(Tag(), a)) {}

  HWY_INLINE friend Pack operator+(Pack a, Pack b) { return hn::Add(a.raw, b.raw); }
  HWY_INLINE friend Pack operator-(Pack a, Pack b) { return hn::Sub(a.raw, b.raw); }
  HWY_INLINE friend Pack operator*(Pack a, Pack b) { return hn::Mul(a.raw, b.raw); }
  HWY_INLINE friend Pack operator/(Pack a, Pack b) { return hn::Div(a.raw, b.raw); }
  HWY_INLINE friend Pack operator-(Pack a) { return hn::Neg(a.raw); }
  HWY_INLINE friend Mask operator>(Pack a, Pack b) { return {hn::Gt(a.raw, b.raw)}; }
  HWY_INLINE friend Mask operator<(Pack a, Pack b) { return {hn::Lt(a.raw, b.raw)}; }
  HWY_INLINE friend Mask operator<=(Pack a, Pack b) { return {hn::Le(a.raw, b.raw)}; }
  HWY_INLINE friend Mask operator==(Pack a, Pack b) { return {hn::Eq(a.raw, b.raw)}; }
  HWY_INLINE friend Pack fma(Pack a, Pack b, Pack c) { return hn::MulAdd(a.raw, b.raw, c.raw); }
  HWY_INLINE friend Pack nfma(Pack a, Pack b, Pack c) { return hn::NegMulAdd(a.raw, b.raw, c.raw); }
  HWY_INLINE friend Pack min(Pack a, Pack b) { return hn::Min(a.raw, b.raw); }
  HWY_INLINE friend Pack max(Pack a, Pack b) { return hn::Max(a.raw, b.raw); }
  HWY_INLINE friend Pack abs(Pack a) { return hn::Abs(a.raw); }
  HWY_INLINE friend Pack sqrt(Pack a) { return hn::Sqrt(a.raw); }
  HWY_INLINE friend Pack select(Mask where, Pack a, Pack b) {
    return hn::IfThenElse(where.raw, a.raw, b.raw);
  }
  template <class F>
  friend Pack each(Mask where, Pack x, Pack y, F f) {
    HWY_ALIGN double in[kLanes], out[kLanes];
    hn::Store(x.raw, Tag(), in);
    hn::Store(y.raw, Tag(), out);
    for (unsigned bits = mask_bits(where), k = 0; bits != 0; bits >>= 1, ++k)
      if ((bits & 1) != 0) out[k] = f(in[k]);
    return hn::Load(Tag(), out);
  }
};
struct HighwayLanes {
  using V = Pack;
  static constexpr int kLanes = static_cast<int>(hn::MaxLanes(All()));
  static constexpr int kWidth = kLanes;
  static_assert(kLanes == 4 || kLanes == 8);
  using Raw = hn::Vec<All>;
  using FourRaw = hn::Vec<Four>;

  /// Four consecutive numbers of a record.
  struct Row {
    FourRaw raw;
    HWY_INLINE static Row all(double a) { return {hn::Set(Four(), a)}; }
    HWY_INLINE static Row high(double a, double b) {
      return {hn::ConcatUpperLower(Four(), hn::OddEven(hn::Set(Four(), b), hn::Set(Four(), a)),
                                   hn::Zero(Four()))};
    }
    HWY_INLINE static Row low(double a) {
      return {hn::ConcatUpperLower(Four(), hn::Zero(Four()), hn::Set(Four(), a))};
    }
    HWY_INLINE static Row three(const double* p) {
      HWY_ALIGN const double v[4] = {p[0], p[1], p[2], 0};
      return {hn::Load(Four(), v)};
    }
    HWY_INLINE static Row load(const double* p) { return {hn::Load(Four(), p)}; }
    void store(double* p) const { hn::Store(raw, Four(), p); }
    [[nodiscard]] HWY_INLINE Row swapped() const { return {hn::SwapAdjacentBlocks(raw)}; }
    HWY_INLINE friend Row operator+(Row a, Row b) { return {hn::Add(a.raw, b.raw)}; }
    HWY_INLINE friend Row operator*(Row a, Row b) { return {hn::Mul(a.raw, b.raw)}; }
    HWY_INLINE friend Row fma(Row a, Row b, Row c) { return {hn::MulAdd(a.raw, b.raw, c.raw)}; }
    HWY_INLINE friend Row operator-(Row a, Row b) { return {hn::Sub(a.raw, b.raw)}; }
    HWY_INLINE friend Row abs(Row a) { return {hn::Abs(a.raw)}; }
    HWY_INLINE friend Row max(Row a, Row b) { return {hn::Max(a.raw, b.raw)}; }
    HWY_INLINE friend Row min(Row a, Row b) { return {hn::Min(a.raw, b.raw)}; }
  };

  static constexpr auto kLarger = [](Row x, Row y) HWY_ATTR { return max(x, y); };
  static constexpr auto kSmaller = [](Row x, Row y) HWY_ATTR { return min(x, y); };

  /// Integrates whole blocks of 2D beads, with as many records in a vector as fit. The operations and their
  /// order are the same as for one bead at a time.
  static constexpr int kBlock = kLanes;
  static_assert(kGroup % kBlock == 0);
  template <int kKicks, bool kDrift>
  HWY_INLINE static Row integrate_blocks(const IntegrateArgs& p, Row h_row, Row dt_row, Row gravity_row,
                                         Row fallen_row) {
    const All d;
    constexpr int kBeads = kLanes / 4;  // per vector
    const Raw h = spread(h_row), dt = spread(dt_row), gravity = spread(gravity_row),
              fallen = twice(fallen_row);
    const Raw alike = spread(Row{hn::Load(Four(), p.inv_mass)}),
              alike_kick = hn::Set(d, -(p.dt / 2) * p.turn[0]);
    Raw most = hn::Zero(d);
    for (std::int64_t run = 0; run < p.n_runs; ++run)
      for (std::int64_t b = p.runs[run].begin, end = end_of_blocks(p.runs[run]); b < end; b += kBlock) {
        Raw f[4], turned[4];
        for (int k = 0; k < 4; ++k) {
          const std::int64_t at = 4 * (b + kBeads * k);
          f[k] = hn::LoadU(d, p.forces + at);
          const Raw inv_m = p.inertia_step == 0 ? alike : hn::LoadU(d, p.inv_mass + at);
          const Raw a = hn::MulAdd(hn::SwapAdjacentBlocks(f[k]), inv_m, gravity);
          Raw v = hn::LoadU(d, p.records + at);
          for (int kick = 0; kick < kKicks; ++kick) v = hn::MulAdd(h, a, v);
          turned[k] = hn::SwapAdjacentBlocks(v);
          Raw next = v;
          if constexpr (kDrift) {
            next = hn::MulAdd(turned[k], dt, next);
            hn::StoreU(hn::Zero(d), d, p.forces + at);
          }
          hn::StoreU(next, d, p.records + at);
          if (k % 2 == 1) {
            const Raw both = hn::OddEvenBlocks(v, turned[k - 1]);
            const Raw flown = hn::Add(hn::LoadU(d, p.reference + 2 * (b + kBeads * (k - 1))), fallen);
            most = hn::Max(most, hn::Abs(hn::Sub(both, flown)));
          }
        }
        if (!p.spin) continue;
        // The torques are the third numbers of the force rows.
        Raw q;
        if constexpr (kLanes == 8)
          q = hn::ConcatOdd(d, hn::ConcatEven(d, f[3], f[2]), hn::ConcatEven(d, f[1], f[0]));
        else
          q = hn::ConcatUpperLower(
              d,
              hn::SwapAdjacentBlocks(
                  hn::InterleaveLower(d, hn::SwapAdjacentBlocks(f[2]), hn::SwapAdjacentBlocks(f[3]))),
              hn::InterleaveLower(d, hn::SwapAdjacentBlocks(f[0]), hn::SwapAdjacentBlocks(f[1])));
        Raw kick = alike_kick;
        if (p.inertia_step != 0) kick = hn::Mul(hn::Set(d, -(p.dt / 2)), hn::LoadU(d, p.turn + b));
        kick = hn::Mul(kick, q);
        Raw s = hn::LoadU(d, p.spins + b);
        for (int n = 0; n < kKicks; ++n) s = hn::Add(s, kick);
        hn::StoreU(s, d, p.spins + b);
      }
    const Row most_of_two = folded(most, kLarger);  // one velocity in each half
    return max(most_of_two, most_of_two.swapped());
  }
  static std::int64_t end_of_blocks(const BeadRange& run) {
    return run.begin + (run.end - run.begin) / kBlock * kBlock;
  }
  /// Steps of free_flight_kernel for a whole group of 2D beads.
  HWY_INLINE static void fly_group(const FreeFlightArgs& p, Row h_row, Row dt_row, Row gravity_row,
                                   std::int64_t b) {
    const All d;
    constexpr int kVectors = 4 * kGroup / kLanes;
    const Raw h = spread(h_row), dt = spread(dt_row), gravity = spread(gravity_row);
    Raw v[kVectors];
    for (int k = 0; k < kVectors; ++k) v[k] = hn::LoadU(d, p.records + 4 * b + kLanes * k);
    for (std::int64_t step = 0; step < p.steps; ++step)
      for (int k = 0; k < kVectors; ++k) {
        v[k] = hn::MulAdd(h, gravity, v[k]);
        v[k] = hn::MulAdd(h, gravity, v[k]);
        v[k] = hn::MulAdd(hn::SwapAdjacentBlocks(v[k]), dt, v[k]);
      }
    for (int k = 0; k < kVectors; ++k) hn::StoreU(v[k], d, p.records + 4 * b + kLanes * k);
  }
  /// Velocity range over whole blocks. The velocities in two vectors of records fill one vector: those of the
  /// first are in its even blocks, those of the second in its odd blocks.
  static std::int64_t range_blocks(const VelocityRangeArgs& p, Row& least_row, Row& most_row) {
    const All d;
    constexpr int kBeads = kLanes / 4;
    Raw least = hn::Set(d, HUGE_VAL), most = hn::Set(d, -HUGE_VAL);
    std::int64_t b = p.beads.begin;
    for (; b + kBlock <= p.beads.end; b += kBlock)
      for (int k = 0; k < 4; k += 2) {
        const std::int64_t at = b + kBeads * k;
        const Raw first = hn::LoadU(d, p.records + 4 * at),
                  second = hn::LoadU(d, p.records + 4 * (at + kBeads));
        const Raw both = hn::OddEvenBlocks(second, hn::SwapAdjacentBlocks(first));
        hn::StoreU(both, d, p.reference + 2 * at);
        least = hn::Min(both, least);
        most = hn::Max(both, most);
      }
    const Row low = folded(least, kSmaller);
    least_row = min(least_row, min(low, low.swapped()));
    const Row high = folded(most, kLarger);
    most_row = max(most_row, max(high, high.swapped()));
    return b;
  }
  /// Copies the upper half of a row to both halves of every row of a vector.
  HWY_INLINE static Raw twice(Row r) { return spread(Row{hn::ConcatUpperUpper(Four(), r.raw, r.raw)}); }
  /// Combines the rows of a vector into one with `op`.
  template <class R, class Op>
  HWY_INLINE static Row folded(const R& r, Op op) {
    if constexpr (kLanes == 8)
      return op(Row{hn::LowerHalf(Four(), r)}, Row{hn::UpperHalf(Four(), r)});
    else
      return Row{r};
  }
  /// Copies a row to every row of a vector.
  HWY_INLINE static Raw spread(Row r) { return spread_raw(r.raw); }
  template <class R>
  HWY_INLINE static Raw spread_raw(R r) {
    if constexpr (kLanes == 8)
      return hn::Combine(All(), r, r);
    else
      return r;
  }

  HWY_INLINE static V load(const double* p) { return hn::LoadU(All(), p); }
  HWY_INLINE static void store(V v, double* p) { hn::StoreU(v.raw, All(), p); }
  static double largest(V v) { return hn::GetLane(hn::MaxOfLanes(All(), v.raw)); }
  static unsigned bits(Pack::Mask m) { return mask_bits(m); }

  /// Transposes 4 x 4 numbers (two such blocks at once with AVX-512): neighbours are interleaved and 128-bit
  /// blocks exchanged. The operation is its own inverse.
  HWY_INLINE static void exchange(const Raw* r, Raw* column) {
    const All d;
    const auto l01 = hn::InterleaveLower(d, r[0], r[1]), u01 = hn::InterleaveUpper(d, r[0], r[1]);
    const auto l23 = hn::InterleaveLower(d, r[2], r[3]), u23 = hn::InterleaveUpper(d, r[2], r[3]);
    column[0] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(l23), l01);
    column[1] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(u23), u01);
    column[2] = hn::OddEvenBlocks(l23, hn::SwapAdjacentBlocks(l01));
    column[3] = hn::OddEvenBlocks(u23, hn::SwapAdjacentBlocks(u01));
  }
  /// The first kCount columns of the rows of all contacts. Lane k of a column belongs to contact k.
  template <int kCount, class Get>
  HWY_INLINE static void transpose(Get row, V* const* column) {
    Raw r[4], c[4];
    for (int k = 0; k < 4; ++k) {
      if constexpr (kLanes == 8)
        r[k] = hn::Combine(All(), row(k + 4), row(k));
      else
        r[k] = row(k);
    }
    exchange(r, c);
    for (int k = 0; k < kCount; ++k) column[k]->raw = c[k];
  }

  template <int D>
  HWY_INLINE static void columns(const double* records, const std::int32_t* i, V* r, V* v) {
    const auto part = [&](int at) {
      return [=](int k) HWY_ATTR { return hn::Load(Four(), records + i[k] + at); };
    };
    if constexpr (D == 2) {
      V* const to[4] = {&r[0], &r[1], &v[0], &v[1]};
      transpose<4>(part(0), to);
    } else {
      V* const to_r[3] = {&r[0], &r[1], &r[2]};
      V* const to_v[3] = {&v[0], &v[1], &v[2]};
      transpose<3>(part(0), to_r);
      transpose<3>(part(4), to_v);
    }
  }
  template <int D>
  HWY_INLINE static void difference(const double* records, const std::int32_t* i, const std::int32_t* j, V* d,
                                    V* v) {
    const auto part = [&](int at) {
      return [=](int k) HWY_ATTR {
        return hn::Sub(hn::Load(Four(), records + i[k] + at), hn::Load(Four(), records + j[k] + at));
      };
    };
    if constexpr (D == 2) {
      V* const to[4] = {&d[0], &d[1], &v[0], &v[1]};
      transpose<4>(part(0), to);
    } else {
      V* const to_d[3] = {&d[0], &d[1], &d[2]};
      V* const to_v[3] = {&v[0], &v[1], &v[2]};
      transpose<3>(part(0), to_d);
      transpose<3>(part(4), to_v);
    }
  }
  template <int D>
  HWY_INLINE static void spin_sums(const double* spin, const std::int32_t* i, const std::int32_t* j, V* s) {
    if constexpr (D == 2)
      gather(
          [=](int k) HWY_ATTR {
            return hn::Add(hn::Load(One(), at(spin, i[k], 4)), hn::Load(One(), at(spin, j[k], 4)));
          },
          s);
    else
      spins_of(
          [=](int k) HWY_ATTR {
            return hn::Add(hn::Load(Four(), at(spin, i[k], 2)), hn::Load(Four(), at(spin, j[k], 2)));
          },
          s);
  }
  template <int D>
  HWY_INLINE static void spins(const double* spin, const std::int32_t* i, V* s) {
    if constexpr (D == 2)
      gather([=](int k) HWY_ATTR { return hn::Load(One(), at(spin, i[k], 4)); }, s);
    else
      spins_of([=](int k) HWY_ATTR { return hn::Load(Four(), at(spin, i[k], 2)); }, s);
  }
  /// Address of a number in an array that is `part` times as dense as the records. The processor scales the
  /// index by 8/part.
  HWY_INLINE static const double* at(const double* numbers, std::int32_t i, int part) {
    return reinterpret_cast<const double*>(reinterpret_cast<const char*>(numbers) +
                                           std::ptrdiff_t{8 / part} * i);
  }
  template <class Get>
  HWY_INLINE static void gather(Get number, V* s) {
    const auto two = [&](int k) HWY_ATTR { return hn::Combine(Two(), number(k + 1), number(k)); };
    if constexpr (kLanes == 8)
      s[0] = V(hn::Combine(All(), hn::Combine(Four(), two(6), two(4)), hn::Combine(Four(), two(2), two(0))));
    else
      s[0] = V(hn::Combine(Four(), two(2), two(0)));
  }
  template <class Get>
  HWY_INLINE static void spins_of(Get row, V* s) {
    V* const to[3] = {&s[0], &s[1], &s[2]};
    transpose<3>(row, to);
  }

  template <class R>
  HWY_INLINE static FourRaw lower(const R& row) {
    if constexpr (kLanes == 8)
      return hn::LowerHalf(Four(), row);
    else
      return row;
  }
  template <class R>
  HWY_INLINE static FourRaw upper(const R& row) {
    return hn::UpperHalf(Four(), row);
  }
  /// Transposes the columns back to rows and calls put(contact, row) for each contact.
  template <class Put>
  HWY_INLINE static void rows(V a, V b, V c, Put put) {
    const Raw column[4] = {a.raw, b.raw, c.raw, hn::Zero(All())};
    Raw row[4];
    exchange(column, row);
    for (int k = 0; k < 4; ++k) {
      put(k, lower(row[k]));
      if constexpr (kLanes == 8) put(k + 4, upper(row[k]));
    }
  }
  HWY_INLINE static void add_row(double* at, FourRaw f) {
    hn::Store(hn::Add(hn::Load(Four(), at), f), Four(), at);
  }

  template <int D, bool kSpin>
  HWY_INLINE static void add_one(double* forces, const std::int32_t* i, const V* f, const V* q) {
    const auto to = [=](int offset) {
      return [=](int k, FourRaw row) HWY_ATTR { add_row(forces + i[k] + offset, row); };
    };
    if constexpr (D == 2) {
      rows(f[0], f[1], kSpin ? q[0] : V(0.0), to(0));
    } else {
      rows(f[0], f[1], f[2], to(0));
      if constexpr (kSpin) rows(q[0], q[1], q[2], to(4));
    }
  }
  /// Adds the force to i, its opposite to j, and the torques to both. Sums of rounded forces are exact, so a
  /// fused product may apply the signs.
  template <int D, bool kSpin, bool kRolling>
  HWY_INLINE static void add(double* forces, const std::int32_t* i, const std::int32_t* j, const V* f,
                             const V* q_i, const V* q_j) {
    if constexpr (kRolling) {
      const V g[3] = {-f[0], -f[1], -f[D - 1]};
      add_one<D, kSpin>(forces, i, f, q_i);
      add_one<D, kSpin>(forces, j, g, q_j);
    } else {
      HWY_ALIGN static constexpr double kSigns[2][4] = {{-1, -1, 1, 1}, {-1, -1, -1, -1}};
      const auto signs = hn::Load(Four(), kSigns[D - 2]);
      rows(f[0], f[1],
           D == 3  ? f[D - 1]
           : kSpin ? q_i[0]
                   : V(0.0),
           [&](int k, FourRaw row) HWY_ATTR {
             add_row(forces + i[k], row);
             double* at = forces + j[k];
             hn::Store(hn::MulAdd(row, signs, hn::Load(Four(), at)), Four(), at);
           });
      if constexpr (D == 3 && kSpin)
        rows(q_i[0], q_i[1], q_i[2], [&](int k, FourRaw row) HWY_ATTR {
          add_row(forces + i[k] + 4, row);
          add_row(forces + j[k] + 4, row);
        });
    }
  }
};

}  // namespace twincell::sim::HWY_NAMESPACE
