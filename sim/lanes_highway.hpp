#pragma once
/// \file
/// As many contacts at a time as the instruction set of this translation unit allows, by Highway: 4 with
/// AVX2, 8 with AVX-512. Everything here is in a namespace of that instruction set.

#include <hwy/highway.h>

#include "sim/passes.hpp"

namespace twincell::sim::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Wide = hn::ScalableTag<double>;
using Four = hn::FixedTag<double, 4>;
using Two = hn::FixedTag<double, 2>;

/// Vectors worked on side by side: one contact is a long chain of dependent operations, and a second vector
/// fills the gaps of the first. With 16 registers (AVX2) there is no room for it.
#ifndef KSIDE
#define KSIDE 1
#endif
inline constexpr int kSide = KSIDE;

/// A pack of numbers with the operations of laws/real.hpp.
struct Pack {
  using Raw = hn::Vec<Wide>;
  Raw raw[kSide];
  HWY_INLINE Pack() : Pack(0.0) {}
  HWY_INLINE explicit Pack(double a) {
    for (Raw& r : raw) r = hn::Set(Wide(), a);
  }
  struct Unset {};
  HWY_INLINE explicit Pack(Unset) {}
};
struct Mask {
  hn::Mask<Wide> raw[kSide];
};
template <class F>
HWY_INLINE Pack by_side(F f) {
  Pack p{Pack::Unset()};
  for (int k = 0; k < kSide; ++k) p.raw[k] = f(k);
  return p;
}
template <class F>
HWY_INLINE Mask mask_by_side(F f) {
  Mask m;
  for (int k = 0; k < kSide; ++k) m.raw[k] = f(k);
  return m;
}

HWY_INLINE Pack operator+(const Pack& a, const Pack& b) {
  return by_side([&](int k) HWY_ATTR { return hn::Add(a.raw[k], b.raw[k]); });
}
HWY_INLINE Pack operator-(const Pack& a, const Pack& b) {
  return by_side([&](int k) HWY_ATTR { return hn::Sub(a.raw[k], b.raw[k]); });
}
HWY_INLINE Pack operator*(const Pack& a, const Pack& b) {
  return by_side([&](int k) HWY_ATTR { return hn::Mul(a.raw[k], b.raw[k]); });
}
HWY_INLINE Pack operator/(const Pack& a, const Pack& b) {
  return by_side([&](int k) HWY_ATTR { return hn::Div(a.raw[k], b.raw[k]); });
}
HWY_INLINE Pack operator-(const Pack& a) {
  return by_side([&](int k) HWY_ATTR { return hn::Neg(a.raw[k]); });
}
HWY_INLINE Mask operator>(const Pack& a, const Pack& b) {
  return mask_by_side([&](int k) HWY_ATTR { return hn::Gt(a.raw[k], b.raw[k]); });
}
HWY_INLINE Mask operator<(const Pack& a, const Pack& b) {
  return mask_by_side([&](int k) HWY_ATTR { return hn::Lt(a.raw[k], b.raw[k]); });
}
HWY_INLINE Mask operator<=(const Pack& a, const Pack& b) {
  return mask_by_side([&](int k) HWY_ATTR { return hn::Le(a.raw[k], b.raw[k]); });
}
HWY_INLINE Mask operator==(const Pack& a, const Pack& b) {
  return mask_by_side([&](int k) HWY_ATTR { return hn::Eq(a.raw[k], b.raw[k]); });
}
HWY_INLINE Pack fma(const Pack& a, const Pack& b, const Pack& c) {
  return by_side([&](int k) HWY_ATTR { return hn::MulAdd(a.raw[k], b.raw[k], c.raw[k]); });
}
HWY_INLINE Pack nfma(const Pack& a, const Pack& b, const Pack& c) {
  return by_side([&](int k) HWY_ATTR { return hn::NegMulAdd(a.raw[k], b.raw[k], c.raw[k]); });
}
HWY_INLINE Pack min(const Pack& a, const Pack& b) {
  return by_side([&](int k) HWY_ATTR { return hn::Min(a.raw[k], b.raw[k]); });
}
HWY_INLINE Pack max(const Pack& a, const Pack& b) {
  return by_side([&](int k) HWY_ATTR { return hn::Max(a.raw[k], b.raw[k]); });
}
HWY_INLINE Pack abs(const Pack& a) {
  return by_side([&](int k) HWY_ATTR { return hn::Abs(a.raw[k]); });
}
HWY_INLINE Pack sqrt(const Pack& a) {
  return by_side([&](int k) HWY_ATTR { return hn::Sqrt(a.raw[k]); });
}
HWY_INLINE Pack select(const Mask& where, const Pack& a, const Pack& b) {
  return by_side([&](int k) HWY_ATTR { return hn::IfThenElse(where.raw[k], a.raw[k], b.raw[k]); });
}
HWY_INLINE bool any(const Mask& m) {
  auto all = m.raw[0];
  for (int k = 1; k < kSide; ++k) all = hn::Or(all, m.raw[k]);
  return !hn::AllFalse(Wide(), all);
}
HWY_INLINE Mask both(const Mask& a, const Mask& b) {
  return mask_by_side([&](int k) HWY_ATTR { return hn::And(a.raw[k], b.raw[k]); });
}
HWY_INLINE Mask either(const Mask& a, const Mask& b) {
  return mask_by_side([&](int k) HWY_ATTR { return hn::Or(a.raw[k], b.raw[k]); });
}
inline unsigned mask_bits(const Mask& m) {
  unsigned all = 0;
  for (int k = 0; k < kSide; ++k) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(Wide(), m.raw[k], bits);
    all |= static_cast<unsigned>(bits[0]) << (k * static_cast<int>(hn::MaxLanes(Wide())));
  }
  return all;
}
template <class F>
inline Pack each(const Mask& where, const Pack& x, const Pack& y, F f) {
  constexpr int kLanes = static_cast<int>(hn::MaxLanes(Wide()));
  HWY_ALIGN double in[kSide * kLanes], out[kSide * kLanes];
  for (int k = 0; k < kSide; ++k) {
    hn::Store(x.raw[k], Wide(), in + k * kLanes);
    hn::Store(y.raw[k], Wide(), out + k * kLanes);
  }
  const unsigned bits = mask_bits(where);
  for (int k = 0; k < kSide * kLanes; ++k)
    if ((bits >> k & 1) != 0) out[k] = f(in[k]);
  return by_side([&](int k) HWY_ATTR { return hn::Load(Wide(), out + k * kLanes); });
}

struct HighwayLanes {
  using V = Pack;
  static constexpr int kLanes = static_cast<int>(hn::MaxLanes(Wide()));  ///< of one vector
  static constexpr int kWidth = kSide * kLanes;
  static_assert(kLanes == 4 || kLanes == 8);
  using Raw = hn::Vec<Wide>;
  using FourRaw = hn::Vec<Four>;

  /// Four numbers of a record.
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
  };

  /// Integrates whole blocks of 2D beads, as many records to a vector as fit, and returns the first bead that
  /// is left. The same operations in the same order as one bead at a time.
  static constexpr int kBlock = kLanes;
  template <int kKicks, bool kDrift>
  static std::int64_t integrate_blocks(const IntegrateArgs& p, Row h_row, Row dt_row, Row gravity_row,
                                       Row fallen_row, Row& most_row) {
    const Wide d;
    constexpr int kBeads = kLanes / 4;  // of a vector
    const Raw h = spread(h_row), dt = spread(dt_row), gravity = spread(gravity_row),
              fallen = spread(fallen_row);
    const Raw alike = spread(Row{hn::Load(Four(), p.inv_mass)}),
              alike_kick = hn::Set(d, -(p.dt / 2) * p.turn[0]);
    Raw most = hn::Zero(d);
    std::int64_t b = p.begin;
    for (; b + kBlock <= p.end; b += kBlock) {
      Raw f[4];
      for (int k = 0; k < 4; ++k) {
        const std::int64_t at = 4 * (b + kBeads * k);
        f[k] = hn::LoadU(d, p.forces + at);
        const Raw inv_m = p.inertia_step == 0 ? alike : hn::LoadU(d, p.inv_mass + at);
        const Raw a = hn::MulAdd(hn::SwapAdjacentBlocks(f[k]), inv_m, gravity);
        Raw v = hn::LoadU(d, p.records + at);
        for (int kick = 0; kick < kKicks; ++kick) v = hn::MulAdd(h, a, v);
        Raw next = v;
        if constexpr (kDrift) {
          next = hn::MulAdd(hn::SwapAdjacentBlocks(v), dt, next);
          hn::StoreU(hn::Zero(d), d, p.forces + at);
        }
        hn::StoreU(next, d, p.records + at);
        most = hn::Max(most, hn::Abs(hn::Sub(v, hn::Add(hn::LoadU(d, p.reference + at), fallen))));
      }
      if (!p.spin) continue;
      // The turning moments are the third numbers of the force rows.
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
    most_row = max(most_row, folded(most));
    return b;
  }
  /// The larger of a vector's rows.
  template <class R>
  HWY_INLINE static Row folded(R r) {
    if constexpr (kLanes == 8)
      return max(Row{hn::LowerHalf(Four(), r)}, Row{hn::UpperHalf(Four(), r)});
    else
      return Row{r};
  }
  /// A row in every row of a vector.
  HWY_INLINE static Raw spread(Row r) { return spread_raw(r.raw); }
  template <class R>
  HWY_INLINE static Raw spread_raw(R r) {
    if constexpr (kLanes == 8)
      return hn::Combine(Wide(), r, r);
    else
      return r;
  }

  HWY_INLINE static V load(const double* p) {
    return by_side([&](int k) HWY_ATTR { return hn::LoadU(Wide(), p + k * kLanes); });
  }
  HWY_INLINE static void store(const V& v, double* p) {
    for (int k = 0; k < kSide; ++k) hn::StoreU(v.raw[k], Wide(), p + k * kLanes);
  }
  static double largest(const V& v) {
    Raw m = v.raw[0];
    for (int k = 1; k < kSide; ++k) m = hn::Max(m, v.raw[k]);
    return hn::GetLane(hn::MaxOfLanes(Wide(), m));
  }
  static unsigned bits(const Mask& m) { return mask_bits(m); }

  /// Four vectors as the four columns they hold, by interleaving neighbours and exchanging 128-bit blocks: a
  /// transposition of 4 x 4 numbers, of two at once with AVX-512. It is its own inverse.
  HWY_INLINE static void exchange(const Raw* r, Raw* column) {
    const Wide d;
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
    for (int side = 0; side < kSide; ++side) {
      Raw r[4], c[4];
      for (int k = 0; k < 4; ++k) {
        const int at = side * kLanes + k;
        if constexpr (kLanes == 8)
          r[k] = hn::Combine(Wide(), row(at + 4), row(at));
        else
          r[k] = row(at);
      }
      exchange(r, c);
      for (int k = 0; k < kCount; ++k) column[k]->raw[side] = c[k];
    }
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
      gather([=](int k) HWY_ATTR { return *at(spin, i[k], 4) + *at(spin, j[k], 4); }, s);
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
      gather([=](int k) HWY_ATTR { return *at(spin, i[k], 4); }, s);
    else
      spins_of([=](int k) HWY_ATTR { return hn::Load(Four(), at(spin, i[k], 2)); }, s);
  }
  /// Numbers that stand `part` times as dense as records do: the processor scales the index by 8/part.
  HWY_INLINE static const double* at(const double* numbers, std::int32_t i, int part) {
    return reinterpret_cast<const double*>(reinterpret_cast<const char*>(numbers) +
                                           std::ptrdiff_t{8 / part} * i);
  }
  template <class Get>
  HWY_INLINE static void gather(Get number, V* s) {
    const Two d2;
    for (int side = 0; side < kSide; ++side) {
      const auto two = [&](int k) HWY_ATTR {
        return hn::InterleaveLower(d2, hn::Set(d2, number(side * kLanes + k)),
                                   hn::Set(d2, number(side * kLanes + k + 1)));
      };
      if constexpr (kLanes == 8)
        s[0].raw[side] =
            hn::Combine(Wide(), hn::Combine(Four(), two(6), two(4)), hn::Combine(Four(), two(2), two(0)));
      else
        s[0].raw[side] = hn::Combine(Four(), two(2), two(0));
    }
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
  /// Calls put(contact, row) for the rows that columns make.
  template <class Put>
  HWY_INLINE static void rows(const V& a, const V& b, const V& c, Put put) {
    for (int side = 0; side < kSide; ++side) {
      const Raw column[4] = {a.raw[side], b.raw[side], c.raw[side], hn::Zero(Wide())};
      Raw row[4];
      exchange(column, row);
      for (int k = 0; k < 4; ++k) {
        put(side * kLanes + k, lower(row[k]));
        if constexpr (kLanes == 8) put(side * kLanes + k + 4, upper(row[k]));
      }
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
  /// The force on i, its opposite on j, the turning moments on both. Sums of rounded forces are exact, so the
  /// signs may be put in by a fused product.
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
