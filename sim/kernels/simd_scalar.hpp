#pragma once
/// \file
/// Scalar lanes: one contact at a time, in plain C++. For machines without these vector units, and as the
/// reference against which the SIMD kernels are tested.

#include "sim/kernels/kernels.hpp"
#include "sim/laws/scalar_arithmetic.hpp"

namespace twincell::sim {

struct ScalarLanes {
  using V = double;
  static constexpr int kWidth = 1;
  static constexpr int kBlock =
      0;  ///< beads per block of integrate_blocks() (simd_highway.hpp); 0: no blocks

  /// Two consecutive numbers at an address that is a multiple of 16 bytes. A graphics card reads them at
  /// once.
  using Two = double __attribute__((vector_size(16), may_alias));
  static Two two(const double* p) { return *reinterpret_cast<const Two*>(p); }
  static void store(Two v, double* p) { *reinterpret_cast<Two*>(p) = v; }

  /// Four consecutive numbers of a record.
  struct Row {
    double c[4];
    static Row all(double a) { return {{a, a, a, a}}; }
    static Row high(double a, double b) { return {{0, 0, a, b}}; }
    static Row low(double a) { return {{a, a, 0, 0}}; }
    static Row three(const double* p) { return {{p[0], p[1], p[2], 0}}; }
    static Row load(const double* p) {
      const Two a = two(p), b = two(p + 2);
      return {{a[0], a[1], b[0], b[1]}};
    }
    void store(double* p) const {
      ScalarLanes::store(Two{c[0], c[1]}, p);
      ScalarLanes::store(Two{c[2], c[3]}, p + 2);
    }
    [[nodiscard]] Row swapped() const { return {{c[2], c[3], c[0], c[1]}}; }
    template <class F>
    static Row each(F f) {
      return {{f(0), f(1), f(2), f(3)}};
    }
    friend Row operator+(Row a, Row b) {
      return each([&](int k) { return a.c[k] + b.c[k]; });
    }
    friend Row operator-(Row a, Row b) {
      return each([&](int k) { return a.c[k] - b.c[k]; });
    }
    friend Row abs(Row a) {
      return each([&](int k) { return std::abs(a.c[k]); });
    }
    friend Row operator*(Row a, Row b) {
      return each([&](int k) { return a.c[k] * b.c[k]; });
    }
    friend Row fma(Row a, Row b, Row c) {
      return each([&](int k) { return std::fma(a.c[k], b.c[k], c.c[k]); });
    }
    friend Row max(Row a, Row b) {
      return each([&](int k) { return sim::max(a.c[k], b.c[k]); });
    }
    friend Row min(Row a, Row b) {
      return each([&](int k) { return sim::min(a.c[k], b.c[k]); });
    }
  };

  static double load(const double* p) { return *p; }
  static void store(double v, double* p) { *p = v; }
  static double largest(V v) { return v; }
  static unsigned bits(bool m) { return m ? 1 : 0; }

  template <int D>
  static void numbers(const double* from, double* to) {
    const Two first = two(from);
    for (int k = 0; k < D; ++k) to[k] = k < 2 ? first[k] : from[k];
  }
  template <int D>
  static void columns(const double* records, const std::int32_t* i, double* r, double* v) {
    numbers<D>(records + *i, r);
    numbers<D>(records + *i + kRecord<D> / 2, v);
  }
  template <int D>
  static void difference(const double* records, const std::int32_t* i, const std::int32_t* j, double* d,
                         double* v) {
    double rj[D], vj[D];
    columns<D>(records, i, d, v);
    columns<D>(records, j, rj, vj);
    for (int k = 0; k < D; ++k) {
      d[k] -= rj[k];
      v[k] -= vj[k];
    }
  }
  template <int D>
  static void spins(const double* spin, const std::int32_t* i, double* s) {
    for (int k = 0; k < kTurns<D>; ++k) s[k] = spin[spin_place<D>(*i) + k];
  }
  template <int D>
  static void spin_sums(const double* spin, const std::int32_t* i, const std::int32_t* j, double* s) {
    double s_j[kTurns<D>];
    spins<D>(spin, i, s);
    spins<D>(spin, j, s_j);
    for (int k = 0; k < kTurns<D>; ++k) s[k] += s_j[k];
  }
  template <int D, bool kSpin>
  static void add_one(double* forces, const std::int32_t* i, const double* f, const double* q,
                      double sign = 1) {
    double* a = forces + *i;
    for (int k = 0; k < D; ++k) a[k] += sign * f[k];
    if constexpr (kSpin)
      for (int k = 0; k < kTurns<D>; ++k) a[(D == 2 ? 2 : 4) + k] += q[k];
  }
  template <int D, bool kSpin, bool kRolling>
  static void add(double* forces, const std::int32_t* i, const std::int32_t* j, const double* f,
                  const double* q_i, const double* q_j) {
    add_one<D, kSpin>(forces, i, f, q_i);
    add_one<D, kSpin>(forces, j, f, q_j, -1);
  }
};

}  // namespace twincell::sim
