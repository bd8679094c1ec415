#pragma once
/// \file
/// Forces of a binary collision (binary_collision.hpp) within one regime of friction, at one instant or at
/// several instants in the lanes of a SIMD vector. The code is written once for every number type of
/// laws/scalar_arithmetic.hpp.

#include "sim/laws/concepts.hpp"
#include "sim/laws/separate_integration.hpp"

namespace twincell::sim {

/// Forces on bead i and the contact kinematics on which they depend, in D dimensions. Call look() or
/// look_again(), then approach(), friction() and slopes(). The relative motion r, u, s is that of
/// RelativeMotion (event_driven/collision.hpp).
template <class V, class N, class T, int D>
struct CollisionForces {
  static constexpr int kTurn = D == 2 ? 1 : 3;

  V n[D], f_t[D], per_distance, overlap, v_n, f_n;
  Tangent<V, kTurn> v_t, turning;  ///< tangential velocity; n x F_t (in 2D F_t)
  bool released = false;           ///< the law omits tension, and F_n would pull: there is no force

  /// Scalar product of two vectors in D dimensions.
  static V dot(const V* a, const V* b) {
    V sum = a[D - 1] * b[D - 1];
    for (int k = D - 2; k >= 0; --k) sum = sum + a[k] * b[k];
    return sum;
  }

  /// Computes the normal and the overlap.
  /// \param wall normal of the wall; null between beads
  [[gnu::always_inline]] void look(V reach, const V* wall, const V* r) {
    if (wall != nullptr) {
      for (int k = 0; k < D; ++k) n[k] = wall[k];
      overlap = reach - dot(wall, r);
    } else {
      const V apart = sqrt(dot(r, r));
      per_distance = V(1.0) / apart;
      for (int k = 0; k < D; ++k) n[k] = r[k] * per_distance;
      overlap = reach - apart;
    }
  }
  /// Like look(), for an r that has changed little since the last call: one Newton step for 1/|r|, whose
  /// error is of second order in the change, replaces a square root and a division.
  [[gnu::always_inline]] void look_again(V reach, const V* wall, const V* r) {
    if (wall != nullptr) {
      overlap = reach - dot(wall, r);
    } else {
      const V square = dot(r, r), half = V(0.5) * per_distance;
      per_distance = fma(half, nfma(square * per_distance, per_distance, V(1.0)), per_distance);
      for (int k = 0; k < D; ++k) n[k] = r[k] * per_distance;
      overlap = nfma(square, per_distance, reach);
    }
  }
  /// Computes the normal velocity, the normal force and the tangential velocity; call after look() or
  /// look_again().
  [[gnu::always_inline]] void approach(const V* c_n, const V* u, const V* s) {
    v_n = dot(n, u);
    f_n = smooth_force<N>(c_n, overlap, v_n);
    if constexpr (T::kActs && D == 2) {
      v_t.c[0] = n[0] * u[1] - n[1] * u[0] - s[0];
    } else if constexpr (T::kActs) {
      for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        v_t.c[k] = u[k] - v_n * n[k] - (s[l] * n[m] - s[m] * n[l]);
      }
    }
  }
  /// Computes the friction; call after approach().
  /// \param pressed regime F_n > 0
  /// \param slides regime in which the Coulomb limit binds. The formula of a regime is also evaluated outside
  /// its range: |F_n| is F_n or -F_n as `pressed` states, whatever the sign of F_n.
  [[gnu::always_inline]] void friction(const V* c_t, bool pressed, bool slides) {
    released = OmitsTension<N> && !pressed;
    if constexpr (T::kActs) {
      if (released) {
        for (int k = 0; k < D; ++k) f_t[k] = V(0.0);
        for (int k = 0; k < kTurn; ++k) turning.c[k] = V(0.0);
        return;
      }
      const V pressure = pressed ? f_n : -f_n;
      const V sign = select(pressure < V(0.0), V(-1.0), V(1.0));
      const Tangent<V, kTurn> force = slides ? sign * T::sliding(c_t, v_t, f_n) : T::sticking(c_t, v_t);
      if constexpr (D == 2) {
        f_t[0] = -(force.c[0] * n[1]), f_t[1] = force.c[0] * n[0];
        turning = force;
      } else {
        for (int k = 0; k < 3; ++k) {
          const int l = (k + 1) % 3, m = (k + 2) % 3;
          f_t[k] = force.c[k];
          turning.c[k] = n[l] * force.c[m] - n[m] * force.c[l];
        }
      }
    }
  }
  /// Distance to the Coulomb limit; call after approach(). It is extended outside its range as in friction().
  [[nodiscard]] [[gnu::always_inline]] V slack(const V* c_t, bool pressed) const {
    if (OmitsTension<N> && !pressed) return V(-1.0);  // without a normal force surfaces slide
    const V slack = T::slack(c_t, norm(v_t), f_n);
    return select((pressed ? f_n : -f_n) < V(0.0), slack - V(2.0) * T::slack(c_t, V(0.0), f_n), slack);
  }
  /// Computes the time derivatives of u and s from the forces.
  /// \param push additional accelerations; null if there are none
  [[gnu::always_inline]] void slopes(V inv_mass, V turn, const V* push, V* to) const {
    for (int k = 0; k < D; ++k) {
      V force = released ? V(0.0) : f_n * n[k];
      if constexpr (T::kActs) force = force + f_t[k];
      to[k] = force * inv_mass;
      if (push != nullptr) to[k] = to[k] + push[k];
    }
    if constexpr (T::kActs)
      for (int k = 0; k < kTurn; ++k) to[D + k] = -(turn * turning.c[k]);
  }
};

}  // namespace twincell::sim
