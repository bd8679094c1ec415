#include "sim/stepping/packed_beads.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/contact/plate_drag.hpp"
#include "sim/laws/cell_laws.hpp"

namespace twincell::sim {

namespace {

/// R w of a bead. If the rim speed stored in the system agrees with the spin, it is used, because R w
/// computed from the spin may differ in the last bit.
Vec3 rim_speed_of(const System& s, std::size_t bead) {
  const Bead& b = s.beads[bead];
  const Vec3 spin(b.spin_x, -b.spin, b.spin_z);
  if (s.rim_speeds.size() == s.beads.size() && s.rim_speeds[bead] / b.radius == spin)
    return s.rim_speeds[bead];
  return b.radius * spin;
}

}  // namespace

void PackedBeads::load(const System& s, const std::vector<std::int32_t>& order, std::size_t dummies) {
  const int d = plan_->dimension, stride = d == 2 ? kRecord<2> : kRecord<3>,
            force_stride = d == 2 ? kForceRecord<2> : kForceRecord<3>,
            spin_stride = d == 2 ? kSpinRecord<2> : kSpinRecord<3>;
  n_ = order.size();
  records_.resize((n_ + dummies) * static_cast<std::size_t>(stride));
  spins_.resize((n_ + dummies) * static_cast<std::size_t>(spin_stride));
  forces_.resize((n_ + dummies) * static_cast<std::size_t>(force_stride));
  equal_ = true;
  for (const Bead& b : s.beads)
    equal_ = equal_ && b.radius == s.beads[0].radius && b.mass == s.beads[0].mass &&
             b.inertia == s.beads[0].inertia;
  const std::size_t kinds = equal_ ? std::min<std::size_t>(n_, 1) : n_;
  radius_.resize(kinds), mass_.resize(kinds), inertia_.resize(kinds), turn_.resize(kinds),
      inv_mass_.resize(4 * kinds);
  for (std::size_t k = 0; k < kinds; ++k) {
    const Bead& b = s.beads[static_cast<std::size_t>(order[k])];
    radius_[k] = b.radius, mass_[k] = b.mass, inertia_[k] = b.inertia;
    turn_[k] = b.radius * b.radius / b.inertia;
    for (std::size_t c = 0; c < 4; ++c)
      inv_mass_.data()[4 * k + c] = (d == 2 ? c >= 2 : c < 3) ? 1 / b.mass : 0;
  }
  for (std::size_t k = 0; k < n_; ++k) {
    const Bead& b = s.beads[static_cast<std::size_t>(order[k])];
    double* r = records_.data() + static_cast<std::size_t>(stride) * k;
    double* spin = spins_.data() + static_cast<std::size_t>(spin_stride) * k;
    double* f = forces_.data() + static_cast<std::size_t>(force_stride) * k;
    const Force force = s.forces_known ? s.forces[static_cast<std::size_t>(order[k])] : Force{};
    const Vec3 rim = rim_speed_of(s, static_cast<std::size_t>(order[k]));
    if (d == 2) {
      r[0] = b.x, r[1] = b.z, r[2] = b.vx, r[3] = b.vz, spin[0] = -rim.y();
      f[0] = force.x, f[1] = force.z, f[2] = force.q, f[3] = 0;
    } else {
      r[0] = b.x, r[1] = b.y, r[2] = b.z, r[3] = 0;
      r[4] = b.vx, r[5] = b.vy, r[6] = b.vz, r[7] = 0;
      spin[0] = rim.x(), spin[1] = rim.y(), spin[2] = rim.z(), spin[3] = 0;
      f[0] = force.x, f[1] = force.y, f[2] = force.z, f[3] = 0;
      f[4] = force.q_x, f[5] = -force.q, f[6] = force.q_z, f[7] = 0;
    }
  }
  for (std::size_t k = n_; k < n_ + dummies; ++k)
    for (int c = 0; c < stride; ++c)
      records_.data()[static_cast<std::size_t>(stride) * k + static_cast<std::size_t>(c)] =
          std::numeric_limits<double>::quiet_NaN();
}

void PackedBeads::give_one(std::size_t k, Bead& b, Force& force) const {
  if (plan_->dimension == 2) {
    const double* r = records_.data() + kRecord<2> * k;
    const double* f = forces_.data() + kForceRecord<2> * k;
    b.x = r[0], b.z = r[1], b.vx = r[2], b.vz = r[3];
    if (plan_->rotation) b.spin = spins_.data()[k] / b.radius;
    force = {.x = f[0], .z = f[1], .q = f[2]};
  } else {
    const double* r = records_.data() + kRecord<3> * k;
    const double* f = forces_.data() + kForceRecord<3> * k;
    const double* w = spins_.data() + kSpinRecord<3> * k;
    b.x = r[0], b.y = r[1], b.z = r[2];
    b.vx = r[4], b.vy = r[5], b.vz = r[6];
    if (plan_->rotation) b.spin_x = w[0] / b.radius, b.spin = -w[1] / b.radius, b.spin_z = w[2] / b.radius;
    force = {.x = f[0], .z = f[2], .q = -f[5], .y = f[1], .q_x = f[4], .q_z = f[6]};
  }
}

Vec3 PackedBeads::rim_speed(std::size_t k) const {
  if (plan_->dimension == 2) return {0, -spins_.data()[k], 0};
  const double* w = spins_.data() + kSpinRecord<3> * k;
  return {w[0], w[1], w[2]};
}

void PackedBeads::store(System& s, const std::vector<std::int32_t>& order) const {
  s.forces.resize(s.beads.size());
  s.rim_speeds.resize(plan_->rotation ? s.beads.size() : 0);
  for (std::size_t k = 0; k < n_; ++k) {
    const auto b = static_cast<std::size_t>(order[k]);
    give_one(k, s.beads[b], s.forces[b]);
    if (plan_->rotation) s.rim_speeds[b] = rim_speed(k);
  }
  s.forces_known = true;
}

bool PackedBeads::agrees(const System& s, const std::vector<std::int32_t>& order) const {
  if (n_ != s.beads.size() || n_ == 0 || !s.forces_known) return false;
  for (std::size_t k = 0; k < n_; ++k) {
    const Bead& given = s.beads[static_cast<std::size_t>(order[k])];
    Bead held = given;
    held.radius = radius(k), held.mass = mass(k), held.inertia = inertia(k);
    Force force;
    give_one(k, held, force);
    // Compare bits, not values: -0 is not 0. There is no padding between doubles.
    if (std::memcmp(&held, &given, sizeof(Bead)) != 0 ||
        // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
        std::memcmp(&force, &s.forces[static_cast<std::size_t>(order[k])], sizeof(Force)) != 0)
      return false;
  }
  return true;
}

Vec3 PackedBeads::position(std::size_t k) const {
  if (plan_->dimension == 2) {
    const double* r = records_.data() + kRecord<2> * k;
    return {r[0], 0, r[1]};
  }
  const double* r = records_.data() + kRecord<3> * k;
  return {r[0], r[1], r[2]};
}

PairScale PackedBeads::pair(std::size_t a, std::size_t b) const {
  const double ma = mass(a), mb = mass(b), ra = radius(a), rb = radius(b);
  return {ma * mb / (ma + mb), ra * rb / (ra + rb),
          1 / ma + 1 / mb + ra * ra / inertia(a) + rb * rb / inertia(b)};
}

PairScale PackedBeads::wall(std::size_t a) const {
  return {mass(a), radius(a), 1 / mass(a) + radius(a) * radius(a) / inertia(a)};
}

IntegrateArgs PackedBeads::integrate_args(const System& s) {
  IntegrateArgs a{};
  a.records = records_.data();
  a.spins = spins_.data();
  a.forces = forces_.data();
  a.inv_mass = inv_mass_.data();
  a.turn = turn_.data();
  a.inertia_step = equal_ ? 0 : 1;
  a.spin = plan_->rotation;
  a.dt = s.dt;
  if (plan_->dimension == 2) {
    a.gravity[0] = s.gravity.x(), a.gravity[1] = s.gravity.z();
  } else {
    for (int k = 0; k < 3; ++k) a.gravity[k] = s.gravity[k];
  }
  return a;
}

void PackedBeads::drift(double time) {
  const std::size_t stride = plan_->dimension == 2 ? kRecord<2> : kRecord<3>, half = stride / 2;
  for (std::size_t k = 0; k < n_; ++k)
    for (std::size_t c = 0; c < half; ++c)
      records_.data()[stride * k + c] += time * records_.data()[stride * k + half + c];
}

void PackedBeads::add_plate_drag(const System& s, double velocity_x, double velocity_z, double quantum,
                                 std::size_t begin, std::size_t end) {
  for (std::size_t k = begin; k < end; ++k) {
    const double* r = records_.data() + kRecord<2> * k;
    double* f = forces_.data() + kForceRecord<2> * k;
    const double drag = s.plate_drag * mass(k);
    f[0] += plate_drag_force(drag, r[2], velocity_x, quantum);
    f[1] += plate_drag_force(drag, r[3], velocity_z, quantum);
  }
}

std::vector<double> pair_constants(const Plan& plan, const PackedBeads& beads, std::size_t a, std::size_t b) {
  const double ra = beads.radius(a), rb = beads.radius(b);
  return contact_constants(plan.laws->bead, beads.pair(a, b), ra + rb, 1 / ra, 1 / rb);
}

std::vector<double> wall_constants(const Plan& plan, const PackedBeads& beads, std::size_t w, std::size_t a) {
  const double r = beads.radius(a);
  return contact_constants(plan.laws->walls[w], beads.wall(a), r, 1 / r, 0);
}

double rounding_constant(const Plan& plan) {
  // Twice the force at the overlap bound, so that dashpots and several contacts fit too. A power of two, so
  // that similar systems remain similar to the bit. For larger forces, sums are only rounded to a coarser
  // quantum.
  const double top = std::exp2(std::ceil(std::log2(2 * plan.largest_force)));
  return 1.5 * top;
}

}  // namespace twincell::sim
