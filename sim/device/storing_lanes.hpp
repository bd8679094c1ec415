#pragma once
/// \file
/// Scalar lanes that store the force of a contact instead of adding it to the beads.

#include "sim/kernels/simd_scalar.hpp"

namespace twincell::sim {

/// Numbers of a stored contact force: force and torque on the bead with the lower number. The force on the
/// other bead is the opposite, its torque (in R_i w_i, as in contact.hpp) the same.
template <int D>
inline constexpr int kContactForce = D == 2 ? 4 : 6;
/// Place of the torque in a force record (kernels.hpp).
template <int D>
inline constexpr int kTorque = D == 2 ? 2 : 4;

struct StoringLanes : ScalarLanes {
  /// Without rolling resistance, so that both beads have the same torque.
  template <int D, bool kSpin, bool kRolling>
  static void add(double* forces, const std::int32_t* i, const std::int32_t* /*j*/, const double* f,
                  const double* q_i, const double* /*q_j*/) {
    static_assert(!kRolling);
    double* a = forces + *i;
    for (int k = 0; k < D; ++k) a[k] = f[k];
    if constexpr (kSpin)
      for (int k = 0; k < kTurns<D>; ++k) a[D + k] = q_i[k];
  }
};

}  // namespace twincell::sim
