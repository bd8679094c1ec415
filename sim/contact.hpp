#pragma once
/// \file
/// The one place where a contact becomes a force: used by the list kernel and by the oracle alike.

#include <algorithm>
#include <cmath>

#include "sim/laws/axes.hpp"
#include "sim/state.hpp"

namespace twincell::sim {

/// What a contact exerts on i: normal and tangential components, and the direction they belong to.
struct ContactForce {
  double n = 0, t = 0;    ///< F_n along n, F_t along t = (-n_z, n_x)
  double nx = 0, nz = 0;  ///< n, from j to i
};

/// Guards 0/0 of coinciding centres; the overlap bound stops such a run anyway.
inline constexpr double kTinyDistance = 1e-12;

/// Force on bead i of the pair at separation (dx, dz) = r_i - r_j with overlap delta > 0.
/// \param xi tangential history, changed in place
template <class Contact>
ContactForce pair_force(const Contact& law, const Bead& i, const Bead& j, double dx, double dz, double m_eff,
                        double dt, double& xi) {
  const double r = std::max(std::sqrt(dx * dx + dz * dz), kTinyDistance);
  const double nx = dx / r, nz = dz / r;
  const double vx = i.vx - j.vx, vz = i.vz - j.vz;
  const double v_n = vx * nx + vz * nz;
  ContactForce f{law.normal(i.radius + j.radius - r, v_n, m_eff), 0, nx, nz};
  const double v_t = vz * nx - vx * nz - (i.radius * i.spin + j.radius * j.spin);
  f.t = law.tangential(v_t, f.n, m_eff, dt, xi);
  return f;
}

/// A flat wall: n points into the cell, `offset` = w . n, moving at (0, velocity_z).
struct Wall {
  double nx, nz;
  double offset;
  double velocity_z;
  [[nodiscard]] double overlap(const Bead& b) const { return b.radius - (b.x * nx + b.z * nz - offset); }
};

/// Force on a bead from a wall; the wall's mass is infinite (m_eff = m) and it does not turn.
template <class Contact>
ContactForce wall_force(const Contact& law, const Bead& b, const Wall& wall, double dt, double& xi) {
  const double vx = b.vx, vz = b.vz - wall.velocity_z;
  const double v_n = vx * wall.nx + vz * wall.nz;
  ContactForce f{law.normal(wall.overlap(b), v_n, b.mass), 0, wall.nx, wall.nz};
  const double v_t = vz * wall.nx - vx * wall.nz - b.radius * b.spin;
  f.t = law.tangential(v_t, f.n, b.mass, dt, xi);
  return f;
}

/// Adds a contact's force to bead i (sign +1) or to its partner (sign -1). Both torques have the same sign.
inline void add_force(Force& force, const ContactForce& f, double radius, double sign) {
  force.x += sign * (f.n * f.nx - f.t * f.nz);
  force.z += sign * (f.n * f.nz + f.t * f.nx);
  force.torque -= radius * f.t;
}

/// Bottom, left and right wall at the plate's present height. The lid never acts (guard.hpp).
struct Walls {
  static constexpr int kBottom = 0, kLeft = 1, kRight = 2;
  Wall of[3];

  explicit Walls(const System& s)
      : of{{0, 1, s.plate_height(), s.plate_velocity()},
           {1, 0, 0, s.side_walls_move ? s.plate_velocity() : 0},
           {-1, 0, -s.width, s.side_walls_move ? s.plate_velocity() : 0}} {}
};

}  // namespace twincell::sim
