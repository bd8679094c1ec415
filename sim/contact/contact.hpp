#pragma once
/// \file
/// Evaluation of one contact, from relative motion to force. The all-pairs oracle, the scalar kernel and the
/// SIMD kernels share this code, for 2D and 3D, for bead-bead and bead-wall contacts.

#include "sim/contact/contact_constants.hpp"
#include "sim/contact/velocity.hpp"
#include "sim/laws/axes.hpp"

namespace twincell::sim {

/// Offsets of the constants of each law of a set.
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
  V v[D];          ///< v_i - v_j; like s and w, in the middle of the step that ends now
  V s[kTurns<D>];  ///< R_i w_i + R_j w_j; in 2D w is counter-clockwise
  V w[kTurns<D>];  ///< w_i - w_j, for rolling
};

/// Contact load: force and torque on i (f, q) and on j (-f, q). The components are in the order of the force
/// record in kernels.hpp.
template <class V, int D>
struct ContactLoad {
  V f[D];
  V q[kTurns<D>];
  V q_i[kTurns<D>];  ///< rolling torque on i per radius
  V q_j[kTurns<D>];  ///< rolling torque on j per radius
};

/// Number of values that a contact remembers: those of its laws; with Velocity::full_step also the normal,
/// tangential and rolling velocity in the middle of the previous step, 0 where there was no contact.
template <class Laws, Velocity kVelocity, int D>
inline constexpr int kRemembered = Laws::template kMemory<D> +
                                   (kVelocity == Velocity::half_step
                                        ? 0
                                        : 1 + (Laws::Tangential::kActs ? kTurns<D> : 0) +
                                              (Laws::Rolling::kActs ? kTurns<D> : 0));

/// Tangential velocity v_t = v - (v . n) n - s x n; in the plane the scalar along t = (-n_z, n_x).
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

/// Removes the component along n from a vector (2D: no operation).
template <class V, int D>
[[gnu::always_inline]] inline void flatten(const V* n, Tangent<V, kTurns<D>>& t) {
  if constexpr (D == 3) {
    const V along = fma(t.c[0], n[0], fma(t.c[1], n[1], t.c[2] * n[2]));
    for (int k = 0; k < 3; ++k) t.c[k] = nfma(along, n[k], t.c[k]);
  }
}

/// Rotates a remembered vector into the present tangent plane and keeps its length (2D: no operation).
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

/// Rounds f to the rounding quantum of `quantum`. Multiples of one quantum add without rounding error, so the
/// sum of a bead's contact forces has the same bits for every order of summation: any list, any packing, any
/// number of threads (Demmel & Nguyen 2013). The quantum is about 1e-15 of the force at the overlap bound,
/// below the effect of the rounding of positions on a contact.
template <class V>
[[gnu::always_inline]] inline V rounded(V f, V quantum) {
  return (f + quantum) - quantum;
}

/// Contact interval: the fraction of a step during which the contact exists, and the normal force at its
/// ends, which sets the Coulomb limit.
template <class V>
struct ContactInterval {
  decltype(V() > V()) entering, leaving;  ///< first or last touch occurs within the step
  V fraction;                             ///< of the step after first touch, or before last touch; else 1
  V ended;                                ///< F_n at the end of the interval: now, or at last touch
  V begun{0.0};                           ///< F_n at its start: at first touch, or at the previous position
  V overlap_begun{0.0}, overlap_ended{0.0};  ///< overlaps at these two instants
  /// Fraction of the interval before F_n vanishes, from push to pull or, of a contact that attracts, from
  /// pull to push; 1 if it does not vanish.
  V pressed{1.0};
  bool any = false;  ///< in some lane a contact begins, ends, or F_n vanishes
};

/// Force whose impulse is correct although the force jumps where a contact begins or ends. The force at a
/// position acts for dt: dt/2 in the step that ends there and dt/2 in the next. If the contact begins in the
/// step, only the fraction since first touch counts, with the `mean` force over it. If the contact ends, the
/// mean force over the fraction before last touch counts, and the dt/2 that the previous position has already
/// contributed is subtracted.
/// \param mean twice the mean force over the interval
/// \param begun force at first touch or at the previous position
/// \param ended force now or at last touch
/// \param held force elsewhere
template <class V, class F>
[[gnu::always_inline]] inline F over_jump(const ContactInterval<V>& p, const F& mean, const F& begun,
                                          const F& ended, const F& held) {
  const F acted = (V(0.5) * p.fraction) * mean;
  return select(p.entering, fma(V(0.5), ended, acted), select(p.leaving, fma(V(-0.5), begun, acted), held));
}

/// Value of x at the end of a step, extrapolated from its values in the middle of this step and of the
/// previous one. Without a contact in the previous step, the middle value.
template <class M, class V, class X>
[[gnu::always_inline]] inline X at_end(const M& was, V half, const X& middle, const X& before) {
  return select(was, fma(half, middle - before, middle), middle);
}

/// Value of |F_n|, relative to the change of F_n within the step, that sets the Coulomb limit at the instant
/// at which F_n vanishes. Friction without an effective limit (mu = 1e9, for example) is therefore not
/// truncated at that instant.
inline constexpr double kMoment = 1e-6;

/// Friction or rolling over one step: `force(v, f_n, dt, x, overlap)` is the formula of the law, x its
/// remembered displacement.
///
/// The Coulomb limit jumps where a contact begins, from 0 to mu |F_n(0+)|, and has a kink where F_n vanishes.
/// A spring truncated there keeps its length for a long time, so it is truncated at that very instant and
/// then integrated over the rest of the step. (Truncation at the end of the step was tried and dropped: the
/// first position then set the friction of the whole impact, with an error of first order in dt, a fifth at n
/// = 50.)
/// \param v velocity in the middle of the step
/// \param seen velocity at its end
template <Velocity kVelocity, class V, class T, class X, class Force>
[[gnu::always_inline]] inline T lasting(const T& v, const T& seen, V dt, const ContactInterval<V>& p, X& x,
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

/// Where in the step two bodies touch, and what the normal law is evaluated with.
template <class V>
struct Touch {
  using Mask = decltype(V() > V());
  Mask now, was;  ///< they touch at the end of the step, at its start
  Mask acting;    ///< the contact exerts a force in this step
  V v_n, before;  ///< normal velocity in the middle of this step and of the previous one
  V seen;         ///< and at the end of this step
  V overlap;      ///< at the end of the step; at its start where the contact ends within it
  ContactInterval<V> interval;
};

/// With full-step velocities and `locate`, finds the fraction of the step in which the contact exists.
/// \param before normal velocity in the middle of the previous step, 0 where there was no contact
template <Velocity kVelocity, class V, int D>
[[gnu::always_inline]] inline Touch<V> touch(const ContactKinematics<V, D>& a, V dt,
                                             [[maybe_unused]] bool locate, [[maybe_unused]] V before) {
  const V zero(0.0), half(0.5);
  V v_n = a.v[D - 1] * a.n[D - 1];
  for (int k = D - 2; k >= 0; --k) v_n = fma(a.v[k], a.n[k], v_n);

  const auto now = a.overlap > zero;
  Touch<V> t{now, now, now, v_n, before, v_n, a.overlap, {now, now, V(1.0), V(0.0)}};
  if constexpr (kVelocity == Velocity::full_step) {
    // A pair whose previous v_n was exactly 0 is treated as new; its force is the same.
    t.was = abs(before) > zero;
    t.seen = at_end(t.was, half, v_n, before);
    t.interval.entering = both(now, before == zero);
    t.interval.leaving = both(t.was, a.overlap <= zero);
    const auto passes = either(t.interval.entering, t.interval.leaving);
    t.interval.any = locate && any(passes);
    if (t.interval.any) {
      t.acting = either(now, t.was);
      t.overlap = select(t.interval.leaving, max(fma(v_n, dt, a.overlap), zero), a.overlap);
      t.interval.fraction = select(passes, min(t.overlap / max(abs(v_n) * dt, V(kTiny)), V(1.0)), V(1.0));
    }
  }
  return t;
}

/// Normal force over the step, > 0 if it pushes; with full-step velocities corrected for its change within
/// the step. Completes the interval with the forces and overlaps at its ends.
/// \param own numbers that the normal law remembers
template <class Laws, Velocity kVelocity, class V, int D>
[[gnu::always_inline]] inline V normal_force(const ContactKinematics<V, D>& a, const V* c, V dt,
                                             [[maybe_unused]] bool locate, Touch<V>& t, V* own) {
  using Normal = typename Laws::Normal;
  using Tangential = typename Laws::Tangential;
  const V* c_n = c + Layout<Laws>::kNormal;
  ContactInterval<V>& interval = t.interval;
  V f_n = Normal::force(c_n, t.overlap, t.seen, own);
  interval.overlap_ended = t.overlap;
  interval.ended = f_n;  // the Coulomb limit uses the instantaneous force, not its mean over a step
  if constexpr (kVelocity == Velocity::full_step) {
    const V zero(0.0), half(0.5);
    // `seen` is based on the acceleration at the previous position. The change of this contact's force since
    // then is known and corrects the velocity.
    const V gain = f_n - Normal::force(c_n, fma(t.seen, dt, t.overlap), t.seen, own);
    const V corrected = fma(half * dt * c[constant::kInvMass], select(t.was, gain, zero), t.seen);
    const V held = Normal::force(c_n, t.overlap, corrected, own);
    if (interval.any) {
      const V edge = Normal::force(c_n, zero, t.seen, own);
      const V first = select(interval.leaving, f_n, edge), last = select(interval.leaving, edge, f_n);
      interval.begun = first;
      if constexpr (ReadsOverlap<Tangential>) {
        interval.overlap_begun = select(interval.leaving, t.overlap, zero);
        interval.overlap_ended = select(interval.leaving, zero, t.overlap);
      }
      interval.ended = select(interval.entering, f_n, select(interval.leaving, edge, held));
      f_n = over_jump(interval, first + last, first, last, held);
    } else {
      interval.ended = f_n = held;
    }
    if constexpr (Tangential::kActs || Laws::Rolling::kActs) {
      // Zero of F_n: near its end a contact pulls, so find the fraction of the interval with F_n > 0.
      const auto pulls = both(t.acting, interval.ended < zero);
      if (locate && any(pulls)) {
        const V start = half * (t.v_n + t.before);
        const V held_before = Normal::force(c_n, fma(t.v_n, dt, a.overlap), start, own);
        // Change only the lanes in which F_n vanishes: a contact's force must not depend on the other
        // contacts of its packet.
        const auto vanishes = both(both(pulls, t.was), held_before > zero);
        interval.begun = select(vanishes, held_before, interval.begun);
        if constexpr (ReadsOverlap<Tangential>)
          interval.overlap_begun =
              select(vanishes, max(fma(t.v_n, dt, a.overlap), zero), interval.overlap_begun);
        interval.pressed =
            select(vanishes, interval.begun / max(interval.begun - interval.ended, V(kTiny)), V(1.0));
        interval.any = true;
      }
      // A contact that attracts may pull from first touch on until the spring outweighs the attraction.
      if constexpr (requires { Normal::kAttracts; }) {
        const auto pushes = both(t.acting, interval.ended > zero);
        if (locate && any(pushes)) {
          const V start = half * (t.v_n + t.before), behind = fma(t.v_n, dt, a.overlap);
          const V held_before = Normal::force(c_n, behind, start, own);
          const V begun = select(interval.entering, interval.begun, held_before);
          const auto rises = both(both(pushes, begun < zero), either(t.was, interval.entering));
          if (any(rises)) {
            interval.begun = select(rises, begun, interval.begun);
            if constexpr (ReadsOverlap<Tangential>)
              interval.overlap_begun = select(both(rises, t.was), max(behind, zero), interval.overlap_begun);
            interval.pressed = select(rises, interval.begun / min(interval.begun - interval.ended, V(-kTiny)),
                                      interval.pressed);
            interval.any = true;
          }
        }
      }
    }
  }
  return f_n;
}

/// The tangential or rolling velocity at the end of the step, from its value `now` in the middle of this step
/// and the one that the contact remembers, which is replaced.
template <class V, int D>
[[gnu::always_inline]] inline Tangent<V, kTurns<D>> remembered_at_end(const V* n, const Touch<V>& t, V half,
                                                                      const Tangent<V, kTurns<D>>& now,
                                                                      V* middle) {
  constexpr int K = kTurns<D>;
  Tangent<V, K> before;
  for (int k = 0; k < K; ++k) before.c[k] = middle[k];
  flatten<V, D>(n, before);
  for (int k = 0; k < K; ++k) middle[k] = select(t.now, now.c[k], V(0.0));
  return at_end(t.was, half, now, before);
}

/// Adds friction: rotates its spring into the present tangent plane, applies the law, adds force and torque.
/// \param kept the law's memory
/// \param middle tangential velocity in the middle of the previous step; both are updated
template <class Laws, Velocity kVelocity, class V, int D>
[[gnu::always_inline]] inline void add_friction(const ContactKinematics<V, D>& a, const V* c, V dt,
                                                const Touch<V>& t, V* kept, [[maybe_unused]] V* middle,
                                                ContactLoad<V, D>& out) {
  using Tangential = typename Laws::Tangential;
  constexpr int K = kTurns<D>;
  const V zero(0.0), half(0.5);
  Tangent<V, K> xi{};
  if constexpr (Tangential::kHistory) {
    for (int k = 0; k < K; ++k) xi.c[k] = kept[k];
    into_tangent_plane<V, D>(a.n, xi);
  }
  const Tangent<V, K> v_t = tangential_velocity(a, t.v_n);
  Tangent<V, K> seen = v_t;
  if constexpr (kVelocity == Velocity::full_step) seen = remembered_at_end<V, D>(a.n, t, half, v_t, middle);
  const Tangent<V, K> f_t =
      lasting<kVelocity>(v_t, seen, dt, t.interval, xi, [&](const auto& v, V limit, V step, auto& x, V at) {
        return tangential_force<Tangential>(c + Layout<Laws>::kTangential, v, limit, step, x, at);
      });
  if constexpr (Tangential::kHistory)
    for (int k = 0; k < K; ++k) kept[k] = select(t.now, xi.c[k], zero);
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

/// Adds rolling resistance to the relative angular velocity in the tangent plane. Its component along n is
/// twisting, which no law resists.
/// \param kept, middle as in `add_friction`
template <class Laws, Velocity kVelocity, class V, int D>
[[gnu::always_inline]] inline void add_rolling(const ContactKinematics<V, D>& a, const V* c, V dt,
                                               const Touch<V>& t, V* kept, [[maybe_unused]] V* middle,
                                               ContactLoad<V, D>& out) {
  constexpr int K = kTurns<D>;
  const V zero(0.0), half(0.5);
  Tangent<V, K> theta, w;
  for (int k = 0; k < K; ++k) {
    theta.c[k] = kept[k];
    w.c[k] = a.w[k];
  }
  into_tangent_plane<V, D>(a.n, theta);
  flatten<V, D>(a.n, w);
  Tangent<V, K> seen = w;
  if constexpr (kVelocity == Velocity::full_step) seen = remembered_at_end<V, D>(a.n, t, half, w, middle);
  const Tangent<V, K> m = lasting<kVelocity>(
      w, seen, dt, t.interval, theta, [&](const auto& v, V limit, V step, auto& x, V /*overlap*/) {
        return Laws::Rolling::torque(c + Layout<Laws>::kRolling, v, limit, step, x);
      });
  for (int k = 0; k < K; ++k) {
    kept[k] = select(t.now, theta.c[k], zero);
    // The sign follows the definition of q: I dw/dt = -R q.
    out.q_i[k] = select(t.acting, -(m.c[k] * c[constant::kInvRadiusI]), zero);
    out.q_j[k] = select(t.acting, m.c[k] * c[constant::kInvRadiusJ], zero);
  }
}

/// Force and torque of one contact. Remembered numbers are updated, and set to 0 where the bodies do not
/// touch.
/// \param c constants, Layout<Laws>::kCount
/// \param locate with Velocity::full_step: the instants of entry and exit are located within their step and
/// the impulse is counted from there, which makes every collision second order. Otherwise the force acts from
/// the first step that finds an overlap to the last
/// \param memory kRemembered numbers: of the laws, then the velocities in the middle of the previous step
template <class Laws, Velocity kVelocity, class V, int D>
[[gnu::always_inline]] inline ContactLoad<V, D> act(const ContactKinematics<V, D>& a, const V* c, V dt,
                                                    bool locate, V* memory) {
  using Normal = typename Laws::Normal;
  using Tangential = typename Laws::Tangential;
  constexpr bool kFull = kVelocity == Velocity::full_step;
  constexpr int K = kTurns<D>;
  const V zero(0.0);
  V* middle = memory + Laws::template kMemory<D>;
  V* tangential = memory + Normal::kMemory;
  [[maybe_unused]] V* rolling = tangential + (Tangential::kHistory ? K : 0);
  V own[Normal::kMemory + 1];  // remembered by the normal law
  for (int k = 0; k < Normal::kMemory; ++k) own[k] = memory[k];

  auto t = touch<kVelocity>(a, dt, locate, kFull ? middle[0] : zero);
  const V f_n = normal_force<Laws, kVelocity>(a, c, dt, locate, t, own);
  ContactLoad<V, D> out;
  for (int k = 0; k < D; ++k) out.f[k] = f_n * a.n[k];
  for (int k = 0; k < K; ++k) out.q[k] = out.q_i[k] = out.q_j[k] = zero;
  if constexpr (Tangential::kActs) add_friction<Laws, kVelocity>(a, c, dt, t, tangential, middle + 1, out);
  if constexpr (Laws::Rolling::kActs)
    add_rolling<Laws, kVelocity>(a, c, dt, t, rolling, middle + 1 + (Tangential::kActs ? K : 0), out);

  // Contacts that have ended forget their numbers and exert no force.
  if constexpr (kFull) middle[0] = select(t.now, t.v_n, zero);
  for (int k = 0; k < Normal::kMemory; ++k) memory[k] = select(t.now, own[k], zero);
  for (int k = 0; k < D; ++k) out.f[k] = select(t.acting, out.f[k], zero);
  for (int k = 0; k < K; ++k) out.q[k] = select(t.acting, out.q[k], zero);
  return out;
}

}  // namespace twincell::sim
