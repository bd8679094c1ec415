#pragma once
/// \file
/// The beads of a System in the memory layout that kernels use.

#include <cstring>
#include <vector>

#include "sim/stepping/solver.hpp"

namespace twincell::sim {

/// An array of numbers aligned to cache lines.
class Lines {
 public:
  /// Makes room for a count of numbers; new numbers are 0.
  void resize(std::size_t numbers) { lines_.resize((numbers + 7) / 8); }
  [[nodiscard]] double* data() { return lines_.empty() ? nullptr : lines_[0].c; }
  [[nodiscard]] const double* data() const { return lines_.empty() ? nullptr : lines_[0].c; }
  [[nodiscard]] std::size_t bytes() const { return lines_.capacity() * sizeof(Line); }

 private:
  struct alignas(64) Line {
    double c[8] = {};
  };
  std::vector<Line> lines_;
};

/// Records of all beads in the solver's own order, followed by `dummies` records that touch nothing: their
/// positions are NaN, so every comparison with them is false.
class PackedBeads {
 public:
  explicit PackedBeads(const Plan& plan) : plan_(&plan) {}

  /// Copies positions and velocities from the system; `order[k]` is the bead in place k. Also copies the
  /// forces and rim speeds if the system has them.
  void load(const System& s, const std::vector<std::int32_t>& order, std::size_t dummies);
  /// Copies them back to the system.
  void store(System& s, const std::vector<std::int32_t>& order) const;
  /// Whether store() would change nothing. The packed data then equal the system, and load() is not needed.
  [[nodiscard]] bool agrees(const System& s, const std::vector<std::int32_t>& order) const;

  [[nodiscard]] std::size_t size() const { return n_; }
  /// Bytes in use.
  [[nodiscard]] std::size_t bytes() const {
    return records_.bytes() + forces_.bytes() + spins_.bytes() + inv_mass_.bytes() +
           sizeof(double) * (radius_.capacity() + mass_.capacity() + inertia_.capacity() + turn_.capacity());
  }
  /// Bytes that a step of one bead reads and writes: record, forces and spin twice, the reference of its
  /// velocity and, of unequal beads, its mass and moment of inertia once.
  [[nodiscard]] double bytes_per_step() const {
    const bool flat = plan_->dimension == 2;
    const int changed =
        flat ? kRecord<2> + kForceRecord<2> + kSpinRecord<2> : kRecord<3> + kForceRecord<3> + kSpinRecord<3>;
    return static_cast<double>(sizeof(double)) * (2 * changed + (flat ? 2 : 4) + (equal_ ? 0 : 5));
  }
  [[nodiscard]] bool equal() const { return equal_; }
  /// Centre of the bead in place k, sigma.
  [[nodiscard]] Vec3 position(std::size_t k) const;
  [[nodiscard]] double radius(std::size_t k) const { return radius_[equal_ ? 0 : k]; }
  [[nodiscard]] double mass(std::size_t k) const { return mass_[equal_ ? 0 : k]; }
  [[nodiscard]] double inertia(std::size_t k) const { return inertia_[equal_ ? 0 : k]; }
  /// Scale of the contact of two beads, by their places.
  [[nodiscard]] PairScale pair(std::size_t a, std::size_t b) const;
  /// Scale of the contact of a bead with a wall.
  [[nodiscard]] PairScale wall(std::size_t a) const;

  [[nodiscard]] double* records() { return records_.data(); }
  [[nodiscard]] double* spins() { return spins_.data(); }
  [[nodiscard]] double* forces() { return forces_.data(); }
  /// Arguments of the integration kernel for all beads.
  [[nodiscard]] IntegrateArgs integrate_args(const System& s);
  /// Moves all beads along their velocities for a time, t0, that may be negative.
  void drift(double time);
  /// Adds the drag of the front and back plates to the forces of places begin .. end - 1 (2D).
  /// \param velocity_x, velocity_z of the cell, sqrt(g sigma)
  /// \param quantum rounding_constant()
  void add_plate_drag(const System& s, double velocity_x, double velocity_z, double quantum,
                      std::size_t begin, std::size_t end);

 private:
  void give_one(std::size_t k, Bead& bead, Force& force) const;
  [[nodiscard]] Vec3 rim_speed(std::size_t k) const;

  const Plan* plan_;
  std::size_t n_ = 0;
  bool equal_ = true;
  Lines records_, forces_, spins_, inv_mass_;
  std::vector<double> radius_, mass_, inertia_, turn_;
};

/// Constants of the contact of beads a and b (contact_constants).
std::vector<double> pair_constants(const Plan& plan, const PackedBeads& beads, std::size_t a, std::size_t b);
/// Constants of the contact of bead a with wall w.
std::vector<double> wall_constants(const Plan& plan, const PackedBeads& beads, std::size_t w, std::size_t a);

/// The constant, m g, that rounds forces to a quantum with which sums are exact (contact.hpp rounded()).
double rounding_constant(const Plan& plan);

}  // namespace twincell::sim
