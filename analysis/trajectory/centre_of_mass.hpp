#pragma once
/// \file
/// How the beads of a frame move as a whole.

#include <cstddef>
#include <optional>
#include <vector>

#include "analysis/trajectory/trajectory.hpp"

namespace twincell {

/// sum m v/sum m over the beads whose velocity is known, sigma/t0. \param mass per slot; empty: all 1.
/// \returns nothing where no velocity is known
inline std::optional<Vec3> centre_of_mass_velocity(const Frame& frame, const std::vector<double>& mass) {
  Vec3 momentum = Vec3::Zero();
  double total = 0;
  for (std::size_t i = 0; i < frame.velocity.size(); ++i) {
    if (!frame.present(i) || !frame.velocity[i].allFinite()) continue;
    const double m = mass.empty() ? 1.0 : mass[i];
    momentum += m * frame.velocity[i];
    total += m;
  }
  if (total == 0) return std::nullopt;
  return momentum / total;
}

}  // namespace twincell
