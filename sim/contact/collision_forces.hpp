#pragma once
/// \file
/// The forces of an collision (binary_collision.hpp) in one of their regimes, at one moment or at several in
/// the lanes of vectors: written once, for any type of number of laws/real.hpp.

#include "sim/laws/concepts.hpp"
#include "sim/laws/isolated.hpp"

namespace twincell::sim {

/// Forces on i, and what they depend on, in D dimensions.
template <class V, class N, class T, int D>
struct CollisionForces {
  static constexpr int kTurn = D == 2 ? 1 : 3;

  V n[D], f_t[D], per_distance, overlap, v_n, f_n;
  Tangent<V, kTurn> v_t, turning;  ///< tangential velocity; n x F_t, in the plane F_t

  static V dot(const V* a, const V* b) {
    V sum = a[D - 1] * b[D - 1];
    for (int k = D - 2; k >= 0; --k) sum = sum + a[k] * b[k];
    return sum;
  }

  /// Direction and overlap. \param wall its normal; null between beads
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
  /// The same if r has changed a little since: a step of Newton's for 1/|r|, whose error is of second order
  /// in the change, instead of a root and a division.
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
  /// Normal force and velocities, after one of these.
  [[gnu::always_inline]] void approach(const V* c_n, const V* u, const V* s) {
    v_n = dot(n, u);
    f_n = N::template force<V>(c_n, overlap, v_n, nullptr);
    if constexpr (T::kActs && D == 2) {
      v_t.c[0] = n[0] * u[1] - n[1] * u[0] - s[0];
    } else if constexpr (T::kActs) {
      for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        v_t.c[k] = u[k] - v_n * n[k] - (s[l] * n[m] - s[m] * n[l]);
      }
    }
  }
  /// Friction, after approach(). \param pressed, slides the regime: F_n > 0, and the Coulomb limit binds. It
  /// is continued beyond where it holds: |F_n| as F_n or -F_n
  [[gnu::always_inline]] void rub(const V* c_t, bool pressed, bool slides) {
    if constexpr (T::kActs) {
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
  /// How far the Coulomb limit is from binding, after approach(); continued as rub() is.
  [[nodiscard]] [[gnu::always_inline]] V slack(const V* c_t, bool pressed) const {
    const V slack = T::slack(c_t, norm(v_t), f_n);
    return select((pressed ? f_n : -f_n) < V(0.0), slack - V(2.0) * T::slack(c_t, V(0.0), f_n), slack);
  }
  /// Slopes of u and s, after these. \param push other accelerations; null: none
  [[gnu::always_inline]] void slopes(V inv_mass, V turn, const V* push, V* to) const {
    for (int k = 0; k < D; ++k) {
      V force = f_n * n[k];
      if constexpr (T::kActs) force = force + f_t[k];
      to[k] = force * inv_mass;
      if (push != nullptr) to[k] = to[k] + push[k];
    }
    if constexpr (T::kActs)
      for (int k = 0; k < kTurn; ++k) to[D + k] = -(turn * turning.c[k]);
  }
};

}  // namespace twincell::sim
