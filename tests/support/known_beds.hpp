#pragma once
/// \file
/// Trajectories of beads whose observables are known in closed form.

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "analysis/observable/observable.hpp"

namespace twincell::test {

/// A trajectory without frames: one frame per cycle at phase 0, velocities, and periods or walls on all
/// sides.
inline MemoryTrajectory empty(int dimension, const Vec3& size, bool periodic) {
  TrajectoryInfo info;
  info.columns.velocity = info.columns.phase = true;
  info.phases_per_cycle = 1;
  info.box.dimension = dimension;
  info.box.upper = size;
  const Boundary edge = periodic ? Boundary::periodic : Boundary::wall;
  info.box.boundary = {edge, dimension == 2 ? Boundary::open : edge, edge};
  return MemoryTrajectory(info);
}

/// Appends a frame of these beads at phase 0 of the next cycle.
inline void add(MemoryTrajectory& t, std::vector<Vec3> position, std::vector<Vec3> velocity = {}) {
  Frame frame;
  frame.cycle = static_cast<std::int64_t>(t.n_frames());
  frame.phase = 0;
  frame.step = frame.cycle;
  frame.time = static_cast<double>(frame.cycle);
  frame.velocity = velocity.empty() ? std::vector<Vec3>(position.size(), Vec3::Zero()) : std::move(velocity);
  frame.position = std::move(position);
  t.info().n_beads = frame.position.size();
  t.append(frame);
}

/// The values of one result.
inline std::vector<double> values_of(const MemoryTrajectory& t, const std::string& name) {
  analysis::AnalysisOptions options;
  options.only = {name};
  return analysis::find_result(analysis::analyze(t, options), name).values;
}

/// 60 frames of 600 points at random places.
inline MemoryTrajectory ideal_gas(int dimension, bool periodic) {
  const Vec3 size = dimension == 2 ? Vec3(20, 1, 30) : Vec3(12, 11, 13);
  MemoryTrajectory t = empty(dimension, size, periodic);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> share(0, 1);
  for (int f = 0; f < 60; ++f) {
    std::vector<Vec3> beads;
    for (int i = 0; i < 600; ++i)
      beads.emplace_back(share(random) * size.x(), dimension == 2 ? 0 : share(random) * size.y(),
                         share(random) * size.z());
    add(t, beads);
  }
  return t;
}

/// Sites of a triangular lattice of `columns` by `rows` (even) in the periodic box of that size.
inline std::vector<Vec3> triangular_lattice(int columns, int rows, double spacing) {
  std::vector<Vec3> beads;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      beads.emplace_back((column + 0.5 * (row % 2)) * spacing, 0, row * spacing * std::sqrt(3.0) / 2);
  return beads;
}
inline Vec3 period_of_lattice(int columns, int rows, double spacing) {
  return {columns * spacing, 1, rows * spacing * std::sqrt(3.0) / 2};
}

}  // namespace twincell::test
