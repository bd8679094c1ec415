#pragma once
/// \file
/// Scalar lanes for a thread that sums the forces on one bead: the other bead of a pair belongs to another
/// thread, which computes the same contact.

#include "sim/kernels/simd_scalar.hpp"

namespace twincell::sim {

struct OneSidedLanes : ScalarLanes {
  static constexpr std::int32_t kOthers = -1;  ///< place of the force on a bead of another thread

  template <int D, bool kSpin, bool kRolling>
  static void add(double* forces, const std::int32_t* i, const std::int32_t* j, const double* f,
                  const double* q_i, const double* q_j) {
    if (*i != kOthers) add_one<D, kSpin>(forces, i, f, q_i);
    if (*j != kOthers) add_one<D, kSpin>(forces, j, f, q_j, -1);
  }
};

}  // namespace twincell::sim
