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
inline constexpr int kReach = 0;            ///< R_i + R_j; R at a wall
inline constexpr int kEdge = 1;             ///< kReach^2, and a little: nearer pairs are looked at
inline constexpr int kInvReach = 2;         ///< 1/kReach
inline constexpr int kInvReachSquared = 3;  ///< 1/kReach^2
inline constexpr int kInvRadiusI = 4;       ///< 1/R_i, for rolling
inline constexpr int kInvRadiusJ = 5;       ///< 1/R_j; 0 at a wall
inline constexpr int kInvMass = 6;          ///< 1/m_eff
inline constexpr int kLaws = 7;
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
struct ContactKinematics {
  V n[D];
  V overlap;       ///< > 0 in contact
  V v[D];          ///< v_i - v_j, in the middle of the step that ends here, as s and w
  V s[kTurns<D>];  ///< R_i w_i + R_j w_j; in 2D of the counter-clockwise spins
  V w[kTurns<D>];  ///< w_i - w_j, for rolling
};

/// What the contact does to i (f, q) and to j (-f, q). Components of Force in force.hpp's order.
template <class V, int D>
struct ContactLoad {
  V f[D];
  V q[kTurns<D>];
  V q_i[kTurns<D>];  ///< rolling torque per radius, i
  V q_j[kTurns<D>];  ///< the same, j
};

/// Which velocity the laws see at the end of a step, where leapfrog knows the positions, but velocities only
/// in the middle of steps.
enum class Velocity {
  half_step,  ///< that of the middle of the step: dashpots lag by dt/2, first order in dt
  full_step,  ///< that of its end, from the last two middles: second order while a contact lasts
};

/// Numbers that a contact remembers: those of its laws; with Velocity::full_step also the normal, tangential
/// and rolling velocity in the middle of the step before, 0 where there was no contact.
template <class Laws, Velocity kVelocity, int D>
inline constexpr int kRemembered = Laws::template kMemory<D> +
                                   (kVelocity == Velocity::half_step
                                        ? 0
                                        : 1 + (Laws::Tangential::kActs ? kTurns<D> : 0) +
                                              (Laws::Rolling::kActs ? kTurns<D> : 0));

/// v_t = v - (v . n) n - s x n; in the plane the scalar along t = (-n_z, n_x).
template <class V, int D>
[[gnu::always_inline]] inline Tangent<V, kTurns<D>> tangential_velocity(const ContactKinematics<V, D>& a,
                                                                        V v_n) {
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

/// A vector without its part along n (2D: nothing to do).
template <class V, int D>
[[gnu::always_inline]] inline void flatten(const V* n, Tangent<V, kTurns<D>>& t) {
  if constexpr (D == 3) {
    const V along = fma(t.c[0], n[0], fma(t.c[1], n[1], t.c[2] * n[2]));
    for (int k = 0; k < 3; ++k) t.c[k] = nfma(along, n[k], t.c[k]);
  }
}

/// Turns a remembered vector into the present tangent plane, keeping its length (2D: nothing to do).
template <class V, int D>
[[gnu::always_inline]] inline void into_tangent_plane(const V* n, Tangent<V, kTurns<D>>& xi) {
  if constexpr (D == 3) {
    const V before = norm(xi);
    flatten<V, D>(n, xi);
    const V factor = before / max(norm(xi), V(kTiny));
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

/// What of a step a contact lasted, and the normal force that the Coulomb limit knows.
template <class V>
struct Passage {
  decltype(V() > V()) entering, leaving;  ///< first touch, or last, was within the step
  V fraction;    ///< of the step that lies after first touch, or before the last; 1 elsewhere
  V ended;       ///< F_n at the end of what acts: now, or at the last touch
  V begun{0.0};  ///< F_n where it begins: at first touch, or at the position before
  V overlap_begun{0.0}, overlap_ended{0.0};  ///< overlaps at the same two instants
  /// F_n > 0 vanishes on the way; else 1: the share of what acts that lies before.
  V pressed{1.0};
  bool any = false;  ///< one of these contacts enters, leaves, or ceases to press
};

/// The force that makes up for the jump where a contact begins or ends. At a position F acts for dt: a half
/// for the step that ends there, a half for the next. Entering, only a fraction of the first half counts,
/// with the `mean` of the force since first touch; leaving, the half given at the last position was too much
/// by what lies beyond the end. \param mean twice that of the force while it acts \param begun, ended the
/// force at first touch, or at the position before, and now, or at the last touch
template <class V, class F>
[[gnu::always_inline]] inline F over_jump(const Passage<V>& p, const F& mean, const F& begun, const F& ended,
                                          const F& held) {
  const F acted = (V(0.5) * p.fraction) * mean;
  return select(p.entering, fma(V(0.5), ended, acted), select(p.leaving, fma(V(-0.5), begun, acted), held));
}

/// x at the end of a step from its value in the middle of it and of the step before.
template <class M, class V, class X>
[[gnu::always_inline]] inline X at_end(const M& was, V half, const X& middle, const X& before) {
  return select(was, fma(half, middle - before, middle), middle);
}

/// How far F_n may be from 0, of its change within the step, and still count as 0: friction without a limit
/// (mu = 1e9, say) is not cut in the moment in which F_n vanishes.
inline constexpr double kMoment = 1e-6;

/// Friction or rolling: `force(v, f_n, dt, x, overlap)` is the law's, x its lasting displacement.
///
/// The Coulomb limit jumps where a contact begins, from nothing to mu |F_n(0+)|, and has a kink where F_n
/// vanishes. A spring that is cut there keeps that length for long after, so the cut is made at that instant,
/// and the spring then goes on for what is left of the step. (Cut at the end of the step instead, the
/// friction of a whole impact was that of its first position: first order in dt, wrong by a fifth at n = 50.)
/// \param v in the middle of the step \param seen at its end
template <Velocity kVelocity, class V, class T, class X, class Force>
[[gnu::always_inline]] inline T lasting(const T& v, const T& seen, V dt, const Passage<V>& p, X& x,
                                        Force force) {
  if constexpr (kVelocity == Velocity::half_step) {
    return force(v, p.ended, dt, x, p.overlap_ended);
  } else {
    const V zero(0.0), one(1.0);
    if (!p.any) {
      x = fma(dt, v, x);
      return force(seen, p.ended, zero, x, p.overlap_ended);
    }
    X begun = x;
    const T first = force(v, p.begun, zero, begun, p.overlap_begun);
    x = fma(p.fraction * p.pressed * dt, v, select(p.entering, begun, x));
    const V pulled = one - p.pressed;
    X vanished = x;
    const T between = force(v, V(kMoment) * (p.begun - p.ended), zero, vanished,
                            fma(p.pressed, p.overlap_ended - p.overlap_begun, p.overlap_begun));
    x = select(pulled > zero, fma(p.fraction * pulled * dt, v, vanished), x);
    const T f = force(seen, p.ended, zero, x, p.overlap_ended);
    const T mean =
        select(pulled > zero, fma(p.pressed, first, fma(pulled, f, between)), first + f);  // twice that
    return over_jump(p, mean, first, f, f);
  }
}

/// Force and turning moment of one contact. Remembered numbers are updated; where bodies are apart they
/// become 0. \param c constants, Layout<Laws>::kCount \param locate with Velocity::full_step: the moments of
/// entry and exit are located within their step and the impulse counted from there, which makes every
/// collision second order; without, the force acts from the first step that finds an overlap to the last
/// \param memory kRemembered numbers, of double precision: in single, steps of a slow creep would be lost in
/// the grain of a spring's length
template <class Laws, Velocity kVelocity, class V, int D>
[[gnu::always_inline]] inline ContactLoad<V, D> act(const ContactKinematics<V, D>& a, const V* c, V dt,
                                                    [[maybe_unused]] bool locate, V* memory) {
  using Normal = typename Laws::Normal;
  using Tangential = typename Laws::Tangential;
  using Rolling = typename Laws::Rolling;
  constexpr bool kFull = kVelocity == Velocity::full_step;
  constexpr bool kLimited = Tangential::kActs || Rolling::kActs;
  constexpr int K = kTurns<D>;
  const V zero(0.0), half(0.5);
  const V forgotten(0.0);
  const V* c_n = c + Layout<Laws>::kNormal;
  V own[Normal::kMemory + 1];  // what the normal law remembers
  for (int k = 0; k < Normal::kMemory; ++k) own[k] = V(memory[k]);

  V v_n = a.v[D - 1] * a.n[D - 1];
  for (int k = D - 2; k >= 0; --k) v_n = fma(a.v[k], a.n[k], v_n);

  const auto now = a.overlap > zero;
  auto acting = now, was = now;
  V overlap = a.overlap, seen = v_n;
  Passage<V> passage{now, now, V(1.0), V(0.0)};
  V* middle = memory + Laws::template kMemory<D>;
  if constexpr (kFull) {
    // A pair whose v_n was exactly 0 reads as new, and gets the same force.
    const V before = V(middle[0]);
    was = abs(before) > zero;
    seen = at_end(was, half, v_n, before);
    passage.entering = both(now, before == zero);
    passage.leaving = both(was, a.overlap <= zero);
    const auto passes = either(passage.entering, passage.leaving);
    passage.any = locate && any(passes);
    if (passage.any) {
      acting = either(now, was);
      overlap = select(passage.leaving, max(fma(v_n, dt, a.overlap), zero), a.overlap);
      passage.fraction = select(passes, min(overlap / max(abs(v_n) * dt, V(kTiny)), V(1.0)), V(1.0));
    }
  }

  V f_n = Normal::force(c_n, overlap, seen, own);
  passage.overlap_ended = overlap;
  passage.ended = f_n;  // the Coulomb limit knows the force of the moment, not its mean over a step
  if constexpr (kFull) {
    // So far the acceleration of the position before. What this contact's force has gained since is known.
    const V gain = f_n - Normal::force(c_n, fma(seen, dt, overlap), seen, own);
    const V corrected = fma(half * dt * c[constant::kInvMass], select(was, gain, zero), seen);
    const V held = Normal::force(c_n, overlap, corrected, own);
    if (passage.any) {
      const V edge = Normal::force(c_n, zero, seen, own);
      const V first = select(passage.leaving, f_n, edge), last = select(passage.leaving, edge, f_n);
      passage.begun = first;
      if constexpr (ReadsOverlap<Tangential>) {
        passage.overlap_begun = select(passage.leaving, overlap, zero);
        passage.overlap_ended = select(passage.leaving, zero, overlap);
      }
      passage.ended = select(passage.entering, f_n, select(passage.leaving, edge, held));
      f_n = over_jump(passage, first + last, first, last, held);
    } else {
      passage.ended = f_n = held;
    }
    if constexpr (kLimited) {
      // Near its end a contact pulls.
      const auto pulls = both(acting, passage.ended < zero);
      if (locate && any(pulls)) {
        const V start = half * (v_n + V(middle[0]));
        const V held_before = Normal::force(c_n, fma(v_n, dt, a.overlap), start, own);
        // Only where it matters: what else is in the packet must not show.
        const auto vanishes = both(both(pulls, was), held_before > zero);
        passage.begun = select(vanishes, held_before, passage.begun);
        if constexpr (ReadsOverlap<Tangential>)
          passage.overlap_begun = select(vanishes, max(fma(v_n, dt, a.overlap), zero), passage.overlap_begun);
        passage.pressed =
            select(vanishes, passage.begun / max(passage.begun - passage.ended, V(kTiny)), V(1.0));
        passage.any = true;
      }
    }
  }

  ContactLoad<V, D> out;
  for (int k = 0; k < D; ++k) out.f[k] = f_n * a.n[k];
  for (int k = 0; k < K; ++k) out.q[k] = out.q_i[k] = out.q_j[k] = zero;
  if constexpr (Tangential::kActs) {
    Tangent<V, K> xi{};
    V* kept = memory + Normal::kMemory;
    if constexpr (Tangential::kHistory) {
      for (int k = 0; k < K; ++k) xi.c[k] = kept[k];
      V n[D];
      for (int k = 0; k < D; ++k) n[k] = a.n[k];
      into_tangent_plane<V, D>(n, xi);
    }
    const Tangent<V, K> v_t = tangential_velocity(a, v_n);
    Tangent<V, K> seen_t = v_t;
    if constexpr (kFull) {
      Tangent<V, K> before;
      for (int k = 0; k < K; ++k) before.c[k] = V(middle[1 + k]);
      flatten<V, D>(a.n, before);
      seen_t = at_end(was, half, v_t, before);
      for (int k = 0; k < K; ++k) middle[1 + k] = select(now, v_t.c[k], forgotten);
    }
    const Tangent<V, K> f_t =
        lasting<kVelocity>(v_t, seen_t, dt, passage, xi, [&](const auto& v, V limit, V step, auto& x, V at) {
          return tangential_force<Tangential>(c + Layout<Laws>::kTangential, v, limit, step, x, at);
        });
    if constexpr (Tangential::kHistory)
      for (int k = 0; k < K; ++k) kept[k] = select(now, xi.c[k], forgotten);
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
    Tangent<V, K> theta;
    Tangent<V, K> w, seen_w;
    V* kept = memory + Normal::kMemory + (Tangential::kHistory ? K : 0);
    for (int k = 0; k < K; ++k) {
      theta.c[k] = kept[k];
      seen_w.c[k] = w.c[k] = a.w[k];
    }
    if constexpr (kFull) {
      Tangent<V, K> before;
      for (int k = 0; k < K; ++k) before.c[k] = V(middle[1 + K + k]);
      seen_w = at_end(was, half, w, before);
      for (int k = 0; k < K; ++k) middle[1 + K + k] = select(now, w.c[k], forgotten);
    }
    const Tangent<V, K> m = lasting<kVelocity>(
        w, seen_w, dt, passage, theta, [&](const auto& v, V limit, V step, auto& x, V /*overlap*/) {
          return Rolling::torque(c + Layout<Laws>::kRolling, v, limit, step, x);
        });
    for (int k = 0; k < K; ++k) {
      kept[k] = select(now, theta.c[k], forgotten);
      // q turns a bead by -R q.
      out.q_i[k] = select(acting, -(m.c[k] * c[constant::kInvRadiusI]), zero);
      out.q_j[k] = select(acting, m.c[k] * c[constant::kInvRadiusJ], zero);
    }
  }
  if constexpr (kFull) middle[0] = select(now, v_n, forgotten);
  for (int k = 0; k < Normal::kMemory; ++k) memory[k] = select(now, own[k], forgotten);
  for (int k = 0; k < D; ++k) out.f[k] = select(acting, out.f[k], zero);
  for (int k = 0; k < K; ++k) out.q[k] = select(acting, out.q[k], zero);
  return out;
}

}  // namespace twincell::sim
