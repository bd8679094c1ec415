#pragma once
/// \file
/// One contact, from relative motion to force: the same text for the all-pairs oracle, the scalar kernel and
/// the vector kernels, for 2D and 3D, for a partner and for a wall.

#include "sim/laws/axes.hpp"

namespace twincell::sim {

/// Components of spin and of the tangent plane.
template <int D>
inline constexpr int kTurns = D == 2 ? 1 : 3;

/// Constants of a contact, one set per kind of pair: its geometry, then those of its laws in the order of the
/// axes.
namespace constant {
inline constexpr int kReach = 0;       ///< R_i + R_j; R at a wall
inline constexpr int kInvReach = 1;    ///< 1/kReach
inline constexpr int kInvRadiusI = 2;  ///< 1/R_i, for rolling
inline constexpr int kInvRadiusJ = 3;  ///< 1/R_j; 0 at a wall
inline constexpr int kLaws = 4;
}  // namespace constant

/// Where the laws of a set find their constants.
template <class Laws>
struct Layout {
  static constexpr int kNormal = constant::kLaws;
  static constexpr int kTangential = kNormal + Laws::Normal::kConstants;
  static constexpr int kRolling = kTangential + Laws::Tangential::kConstants;
  static constexpr int kCount = kRolling + Laws::Rolling::kConstants;
};

/// Relative motion at a contact. n points from j (or the wall) to i.
template <class V, int D>
struct Approach {
  V n[D];
  V overlap;       ///< > 0 in contact
  V v[D];          ///< v_i - v_j
  V s[kTurns<D>];  ///< R_i w_i + R_j w_j; in 2D of the counter-clockwise spins
  V w[kTurns<D>];  ///< w_i - w_j, for rolling
};

/// What the contact does to i (f, q) and to j (-f, q). Components of Force in force.hpp's order.
template <class V, int D>
struct Action {
  V f[D];
  V q[kTurns<D>];
  V q_i[kTurns<D>];  ///< rolling torque per radius, i
  V q_j[kTurns<D>];  ///< the same, j
  V overlap;         ///< max(0, overlap)
};

/// Order of the integrator through the jump of the force where a contact begins and ends.
enum class Jump {
  stepwise,  ///< the force acts from the first step that finds an overlap: first order in dt for each
             ///< collision
  located,   ///< the moments of entry and exit are located within their step and the impulse integrated from
             ///< there
};

/// v_t = v - (v . n) n - s x n; in the plane the scalar along t = (-n_z, n_x).
template <class V, int D>
[[gnu::always_inline]] inline Tangent<V, kTurns<D>> tangential_velocity(const Approach<V, D>& a, V v_n) {
  Tangent<V, kTurns<D>> t;
  if constexpr (D == 2) {
    t.c[0] = nfma(a.v[0], a.n[1], fma(a.v[1], a.n[0], -a.s[0]));
  } else {
    t.c[0] = nfma(v_n, a.n[0], a.v[0]) - nfma(a.s[2], a.n[1], a.s[1] * a.n[2]);
    t.c[1] = nfma(v_n, a.n[1], a.v[1]) - nfma(a.s[0], a.n[2], a.s[2] * a.n[0]);
    t.c[2] = nfma(v_n, a.n[2], a.v[2]) - nfma(a.s[1], a.n[0], a.s[0] * a.n[1]);
  }
  return t;
}

/// Turns a remembered vector into the present tangent plane, keeping its length (2D: nothing to do).
template <class V, int D>
[[gnu::always_inline]] inline void into_tangent_plane(const V* n, Tangent<V, kTurns<D>>& xi) {
  if constexpr (D == 3) {
    const V before = norm(xi);
    const V along = fma(xi.c[0], n[0], fma(xi.c[1], n[1], xi.c[2] * n[2]));
    for (int k = 0; k < 3; ++k) xi.c[k] = nfma(along, n[k], xi.c[k]);
    const V factor = before / max(norm(xi), V(1e-300));
    const auto turned = before > V(0.0);
    for (int k = 0; k < 3; ++k) xi.c[k] = select(turned, factor * xi.c[k], xi.c[k]);
  }
}

/// f rounded to the grain of `magic`. Multiples of one grain add up without rounding, so the sum of a bead's
/// contact forces is the same bits in whatever order they come: any list, any packing, any number of threads
/// (Demmel & Nguyen 2013). The grain is some 1e-11 of the largest force, below what the rounding of positions
/// does to a contact.
template <class V>
[[gnu::always_inline]] inline V rounded(V f, V magic) {
  return (f + magic) - magic;
}

/// Force and turning moment of one contact. Remembered numbers are updated; where bodies are apart they
/// become 0. \param c constants, Layout<Laws>::kCount \param memory Laws::kMemory<D> numbers
template <class Laws, Jump kJump, class V, int D>
[[gnu::always_inline]] inline Action<V, D> act(const Approach<V, D>& a, const V* c, V dt, V magic,
                                               V* memory) {
  using Normal = typename Laws::Normal;
  using Tangential = typename Laws::Tangential;
  using Rolling = typename Laws::Rolling;
  constexpr int K = kTurns<D>;
  const V zero(0.0);

  V v_n = a.v[D - 1] * a.n[D - 1];
  for (int k = D - 2; k >= 0; --k) v_n = fma(a.v[k], a.n[k], v_n);

  const auto now = a.overlap > zero;
  auto acting = now;
  V overlap = a.overlap, step = dt, weight(1.0);
  // Of the step in which a contact begins, only the fraction after first touch counts; of the one in which it
  // ended, the fraction before. Both are known from the overlap one step ago, delta + v_n dt. The kicks on
  // either side of a position together give 2 x dt/2, so one effective force per step can make up for both.
  [[maybe_unused]] V fraction(1.0);
  [[maybe_unused]] auto entering = now, leaving = now;
  if constexpr (kJump == Jump::located) {
    const V before = fma(v_n, dt, a.overlap);
    const auto was = before > zero;
    entering = both(now, before <= zero);
    leaving = both(was, a.overlap <= zero);
    acting = either(now, was);
    overlap = select(now, a.overlap, before);
    const V travel = max(abs(v_n) * dt, V(1e-300));
    fraction = select(either(entering, leaving), min(overlap / travel, V(1.0)), V(1.0));
    step = fraction * dt;
    weight = select(entering, fraction + V(0.5), select(leaving, fraction - V(0.5), V(1.0)));
  }

  V f_n = Normal::force(c + Layout<Laws>::kNormal, overlap, v_n, memory);
  const V limit_force = f_n;  // the Coulomb limit knows the force of the moment, not its mean over a step
  if constexpr (kJump == Jump::located) {
    const V edge = Normal::force(c + Layout<Laws>::kNormal, zero, v_n, memory);
    const V mean = fraction * (edge + f_n);
    f_n = select(entering, V(0.5) * (mean + f_n), select(leaving, V(0.5) * (mean - f_n), f_n));
  }

  Action<V, D> out;
  for (int k = 0; k < D; ++k) out.f[k] = f_n * a.n[k];
  for (int k = 0; k < K; ++k) out.q[k] = out.q_i[k] = out.q_j[k] = zero;
  if constexpr (Tangential::kActs) {
    Tangent<V, K> xi{};
    V* kept = memory + Normal::kMemory;
    if constexpr (Tangential::kHistory) {
      for (int k = 0; k < K; ++k) xi.c[k] = kept[k];
      into_tangent_plane<V, D>(a.n, xi);
    }
    Tangent<V, K> f_t =
        Tangential::force(c + Layout<Laws>::kTangential, tangential_velocity(a, v_n), limit_force, step, xi);
    if constexpr (Tangential::kHistory)
      for (int k = 0; k < K; ++k) kept[k] = select(now, xi.c[k], zero);
    if constexpr (kJump == Jump::located) f_t = weight * f_t;
    if constexpr (D == 2) {
      out.f[0] = nfma(f_t.c[0], a.n[1], out.f[0]);
      out.f[1] = fma(f_t.c[0], a.n[0], out.f[1]);
      out.q[0] = f_t.c[0];
    } else {
      for (int k = 0; k < 3; ++k) {
        out.f[k] = out.f[k] + f_t.c[k];
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        out.q[k] = nfma(a.n[m], f_t.c[l], a.n[l] * f_t.c[m]);
      }
    }
  }
  if constexpr (Rolling::kActs) {
    Tangent<V, K> theta, w;
    V* kept = memory + Normal::kMemory + (Tangential::kHistory ? K : 0);
    for (int k = 0; k < K; ++k) {
      theta.c[k] = kept[k];
      w.c[k] = a.w[k];
    }
    const Tangent<V, K> m = Rolling::torque(c + Layout<Laws>::kRolling, w, limit_force, step, theta);
    for (int k = 0; k < K; ++k) {
      kept[k] = select(now, theta.c[k], zero);
      // q turns a bead by -R q.
      out.q_i[k] = rounded(select(acting, -(m.c[k] * c[constant::kInvRadiusI]), zero), magic);
      out.q_j[k] = rounded(select(acting, m.c[k] * c[constant::kInvRadiusJ], zero), magic);
    }
  }
  for (int k = 0; k < Normal::kMemory; ++k) memory[k] = select(now, memory[k], zero);
  for (int k = 0; k < D; ++k) out.f[k] = rounded(select(acting, out.f[k], zero), magic);
  for (int k = 0; k < K; ++k) out.q[k] = rounded(select(acting, out.q[k], zero), magic);
  out.overlap = max(select(now, a.overlap, zero), zero);
  return out;
}

}  // namespace twincell::sim
