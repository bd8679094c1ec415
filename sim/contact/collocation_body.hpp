#pragma once
/// \file
/// Implementation of the collocation steps of collocation.hpp, compiled once per instruction set.

#include <algorithm>

#include "sim/contact/collision_forces.hpp"
#include "sim/contact/collocation.hpp"
#include "sim/laws/axes.hpp"

namespace twincell::sim {

/// The values at all eight stages, in as many SIMD vectors as they need. It has the operations of
/// laws/scalar_arithmetic.hpp, so the laws take it as a number type.
template <class Lanes>
struct Octet {
  using Part = typename Lanes::V;
  static constexpr int kParts = static_cast<int>(kStages) / Lanes::kWidth;
  Part part[kParts];
  struct Mask {
    decltype(Part() > Part()) part[kParts];
  };

  Octet() = default;
  explicit Octet(double a) {
    for (Part& p : part) p = Part(a);
  }
  static Octet load(const double* p) {
    Octet o;
    for (int k = 0; k < kParts; ++k) o.part[k] = Lanes::load(p + k * Lanes::kWidth);
    return o;
  }
  void store(double* p) const {
    for (int k = 0; k < kParts; ++k) Lanes::store(part[k], p + k * Lanes::kWidth);
  }
  [[nodiscard]] double largest() const {
    double most = Lanes::largest(part[0]);
    for (int k = 1; k < kParts; ++k) {
      const double other = Lanes::largest(part[k]);
      if (!(most >= other)) most = other;
    }
    return most;
  }
  template <class F>
  static Octet of(Octet a, Octet b, F f) {
    for (int k = 0; k < kParts; ++k) a.part[k] = f(a.part[k], b.part[k]);
    return a;
  }
  friend Octet operator+(Octet a, Octet b) {
    return of(a, b, [](Part x, Part y) { return x + y; });
  }
  friend Octet operator-(Octet a, Octet b) {
    return of(a, b, [](Part x, Part y) { return x - y; });
  }
  friend Octet operator*(Octet a, Octet b) {
    return of(a, b, [](Part x, Part y) { return x * y; });
  }
  friend Octet operator/(Octet a, Octet b) {
    return of(a, b, [](Part x, Part y) { return x / y; });
  }
  friend Octet max(Octet a, Octet b) {
    return of(a, b, [](Part x, Part y) { return max(x, y); });
  }
  friend Octet operator-(Octet a) {
    for (Part& p : a.part) p = -p;
    return a;
  }
  friend Octet fma(Octet a, Octet b, Octet c) {
    for (int k = 0; k < kParts; ++k) c.part[k] = fma(a.part[k], b.part[k], c.part[k]);
    return c;
  }
  friend Octet nfma(Octet a, Octet b, Octet c) {
    for (int k = 0; k < kParts; ++k) c.part[k] = nfma(a.part[k], b.part[k], c.part[k]);
    return c;
  }
  friend Octet abs(Octet a) {
    for (Part& p : a.part) p = abs(p);
    return a;
  }
  friend Octet sqrt(Octet a) {
    for (Part& p : a.part) p = sqrt(p);
    return a;
  }
  friend Mask operator<(Octet a, Octet b) {
    Mask m;
    for (int k = 0; k < kParts; ++k) m.part[k] = a.part[k] < b.part[k];
    return m;
  }
  friend Octet select(Mask where, Octet a, Octet b) {
    for (int k = 0; k < kParts; ++k) a.part[k] = select(where.part[k], a.part[k], b.part[k]);
    return a;
  }
};

/// One collocation step for the laws N and T in D dimensions.
template <class Lanes, class N, class T, int D>
struct CollocationOf {
  using V = Octet<Lanes>;
  using Forces = CollisionForces<V, N, T, D>;
  static constexpr int kTurn = D == 2 ? 1 : 3;
  static constexpr int kSlopes = D + (T::kActs ? kTurn : 0);
  static constexpr int kMaxPasses = 40;
  // From pass kPatience on, the iteration stops if a pass does not reduce the change by kProgress: outside
  // the range of its regime, a force may have no smooth solution.
  static constexpr int kPatience = 3;
  static constexpr double kProgress = 0.4;
  // Smallest ratio of successive changes that the error estimate assumes: after a good initial guess the
  // first ratios are unreliable.
  static constexpr double kMinContraction = 0.01;

  /// Applies one linear map to each of K rows of stage values.
  template <int K>
  static void map(const StageMap& by, const double (*rows)[kStages], V* to) {
    for (int k = 0; k < K; ++k) to[k] = V(rows[k][0]) * V::load(by.column[0]);
    for (std::size_t j = 1; j < kStages; ++j) {
      const V column = V::load(by.column[j]);
      for (int k = 0; k < K; ++k) to[k] = fma(V(rows[k][j]), column, to[k]);
    }
  }
  /// Applies one map to `row` and another to `other` and returns the sum. Two accumulators shorten the
  /// dependency chain.
  static V map_two(const StageMap& by, const double* row, const StageMap& other_by, const double* other) {
    V sum = V(row[0]) * V::load(by.column[0]), rest = V(other[0]) * V::load(other_by.column[0]);
    for (std::size_t j = 1; j < kStages; ++j) {
      sum = fma(V(row[j]), V::load(by.column[j]), sum);
      rest = fma(V(other[j]), V::load(other_by.column[j]), rest);
    }
    return sum + rest;
  }

  /// Initial guess: motion of an oscillator along n_0, exponential relaxation across it.
  [[gnu::always_inline]] static void guess(const CollocationStart& a, V time, const V* r0, const V* u0,
                                           const V* n0, V* r, V* u) {
    V a0[kSlopes];
    for (int k = 0; k < kSlopes; ++k) a0[k] = V(a.slopes[k]);
    const V u_n = Forces::dot(n0, u0), a_n = Forces::dot(n0, a0), square = time * time;
    // cos and sin of omega t, and exp of -lambda t, by the first terms of their series.
    const V q = V(a.frequency * a.frequency) * square, x = V(a.relaxation) * time;
    const V cosine = q * fma(q, fma(q, V(-1.0 / 720), V(1.0 / 24)), V(-0.5));             // cos - 1
    const V sine = time * q * fma(q, fma(q, V(-1.0 / 5040), V(1.0 / 120)), V(-1.0 / 6));  // sin/omega - t
    const V one_minus_cosine =
        square * fma(q, fma(q, V(1.0 / 720), V(-1.0 / 24)), V(0.5));  // (1 - cos)/omega^2
    // Integrals of exp(-lambda t): once for the velocity, twice for the position.
    const V relaxed_time = time * fma(x, fma(x, fma(x, V(-1.0 / 24), V(1.0 / 6)), V(-0.5)), V(1.0));
    const V relaxed_square = square * fma(x, fma(x, V(1.0 / 24), V(-1.0 / 6)), V(0.5));
    const V more_u = fma(u_n, cosine, a_n * (time + sine - relaxed_time));
    const V more_r = fma(u_n, sine, a_n * (one_minus_cosine - relaxed_square));
    for (int k = 0; k < D; ++k) r[k] = fma(more_r, n0[k], fma(relaxed_square, a0[k], r0[k]));
    for (int k = 0; k < kSlopes; ++k) u[k] = fma(relaxed_time, a0[k], u0[k]);
    for (int k = 0; k < D; ++k) u[k] = fma(more_u, n0[k], u[k]);
  }
  /// Performs the step.
  static void step(const CollocationStart& a, CollocationMotion& m) {
    // Setup: constants as SIMD vectors, free motion r0, u0 at all stages, initial guess.
    const Collocation& numbers = *a.method;
    V r0[D], u0[kSlopes], r[D], u[kSlopes], slope[kSlopes], n0[D], wall[D], push[D];
    V c_n[N::kConstants], c_t[T::kConstants > 0 ? T::kConstants : 1];
    for (int k = 0; k < N::kConstants; ++k) c_n[k] = V(a.normal_law[k]);
    for (int k = 0; k < T::kConstants; ++k) c_t[k] = V(a.tangential_law[k]);
    const double frequency = a.response != nullptr ? a.response->width / a.h : 0;
    const V whole(a.h), square(a.h * a.h), stiffness(frequency * frequency), damping(a.damping);
    const V time = whole * V::load(numbers.moment);
    for (int k = 0; k < D; ++k) {
      r0[k] = fma(time, V(a.numbers[D + k]), V(a.numbers[k]));
      n0[k] = V(a.normal[k]);
      if (a.wall != nullptr) wall[k] = V(a.wall[k]);
      if (a.push != nullptr) push[k] = V::load(a.push + k * kStages);
    }
    for (int k = 0; k < kSlopes; ++k) u0[k] = V(a.numbers[D + k]);
    guess(a, time, r0, u0, n0, r, u);
    const V reach = V(a.reach), inv_mass = V(a.inv_mass), inv_rim_mass = V(a.turn);
    V r_n = Forces::dot(n0, r0), u_n = Forces::dot(n0, u0);
    const V* along_wall = a.wall != nullptr ? wall : nullptr;
    Forces f;
    // Iteration: evaluate the forces at all stages, integrate them, repeat until the velocities converge.
    double before = 0;
    for (int pass = 0; pass < kMaxPasses; ++pass) {
      pass == 0 ? f.look(reach, along_wall, r) : f.look_again(reach, along_wall, r);
      f.approach(c_n, u, u + D);
      f.friction(c_t, a.pressed, a.slides);
      f.slopes(inv_mass, inv_rim_mass, a.push != nullptr ? push : nullptr, slope);
      // The new accelerations change the motion, and the changed motion changes the normal force. `now`
      // contains the acceleration -`unapplied` that the linear spring and dashpot exert at the present r and
      // u. With their response to the new motion instead, the acceleration along n_0 is R (unapplied + now) -
      // eta h R A now.
      V now(0.0);
      alignas(64) double along[2][kStages];
      if (a.response != nullptr) {
        now = Forces::dot(n0, slope);
        const V unapplied = stiffness * (Forces::dot(n0, r) - r_n) + damping * (Forces::dot(n0, u) - u_n);
        (unapplied + now).store(along[0]);
        (-(whole * damping * now)).store(along[1]);
        for (int k = 0; k < D; ++k) slope[k] = nfma(now, n0[k], slope[k]);
      }
      for (int k = 0; k < kSlopes; ++k) slope[k].store(m.slopes[k]);
      // Integrate the accelerations to velocities and positions at the stages.
      V next[kSlopes];
      map<D>(numbers.twice, m.slopes, r);
      map<kSlopes>(numbers.once, m.slopes, next);
      if (a.response != nullptr) {
        const OscillatorResponse& by = *a.response;
        const V displacement = map_two(by.twice, along[0], by.thrice, along[1]);
        const V speed = map_two(by.once, along[0], by.twice, along[1]);
        for (int k = 0; k < D; ++k)
          r[k] = fma(displacement, n0[k], r[k]), next[k] = fma(speed, n0[k], next[k]);
      }
      for (int k = 0; k < D; ++k) r[k] = fma(square, r[k], r0[k]);
      for (int k = 0; k < kSlopes; ++k) next[k] = fma(whole, next[k], u0[k]);
      V change = abs(next[0] - u[0]);
      for (int k = 1; k < kSlopes; ++k) change = max(change, abs(next[k] - u[k]));
      for (int k = 0; k < kSlopes; ++k) u[k] = next[k];
      // Convergence: the ratio of the last two changes predicts the next change.
      const double most = change.largest();
      m.change = pass > 0 && most < before ? most * std::max(most / before, kMinContraction) : most;
      const bool stalled = pass >= kPatience && !(most < kProgress * before);
      before = most;
      if (m.change <= a.enough || stalled || pass + 1 == kMaxPasses) {
        for (int k = 0; k < D; ++k) fma(now, n0[k], slope[k]).store(m.slopes[k]);
        f.overlap.store(m.overlap);
        m.deepest = f.overlap.largest();
        f.f_n.store(m.f_n);
        if constexpr (T::kActs) f.slack(c_t, a.pressed).store(m.slack);
        break;
      }
    }
    for (int k = 0; k < D; ++k) r[k].store(m.numbers[k]);
    for (int k = 0; k < kSlopes; ++k) u[k].store(m.numbers[D + k]);
  }
};

/// Table of the step functions by laws (their indices in the lists of laws/axes.hpp) and dimension; null for
/// laws whose collisions are not smooth.
template <class Lanes>
struct CollocationTable {
  static constexpr std::size_t kTangentials = std::variant_size_v<TangentialAxis>;

  template <int D, std::size_t kIndex>
  static constexpr CollocationStep entry() {
    using N = std::variant_alternative_t<kIndex / kTangentials, NormalAxis>;
    using T = std::variant_alternative_t<kIndex % kTangentials, TangentialAxis>;
    if constexpr (SmoothNormal<N> && PresentTangential<T>)
      return &CollocationOf<Lanes, N, T, D>::step;
    else
      return nullptr;
  }
  template <int D, std::size_t... kIndex>
  static CollocationStep pick(std::size_t index, std::index_sequence<kIndex...>) {
    static constexpr CollocationStep kAll[] = {entry<D, kIndex>()...};
    return kAll[index];
  }
  static CollocationStep find(std::size_t normal, std::size_t tangential, int dimension) {
    constexpr auto kEach = std::make_index_sequence<std::variant_size_v<NormalAxis> * kTangentials>();
    const std::size_t index = normal * kTangentials + tangential;
    return dimension == 2 ? pick<2>(index, kEach) : pick<3>(index, kEach);
  }
};

}  // namespace twincell::sim
