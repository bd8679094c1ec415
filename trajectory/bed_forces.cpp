#include "trajectory/bed_forces.hpp"

#include "trajectory/branch_vector.hpp"
#include "trajectory/centre_of_mass.hpp"

namespace twincell {
namespace {

/// Sum of m v' v'; NaN without velocities.
BedForces::Tensor kinetic_sum(const Frame& frame, const std::vector<double>& mass) {
  const auto mean = centre_of_mass_velocity(frame, mass);
  if (!mean) return BedForces::Tensor::Constant(BedForces::kUnknown);
  BedForces::Tensor sum = BedForces::Tensor::Zero();
  for (std::size_t i = 0; i < frame.velocity.size(); ++i)
    if (frame.present(i) && frame.velocity[i].allFinite()) {
      const Vec3 off = frame.velocity[i] - *mean;
      sum += mass_of(mass, i) * off * off.transpose();
    }
  return sum;
}

}  // namespace

BedWindow stress_window(const Frame& frame, const Box& box) {
  constexpr double kMargin = 0.5;  // sigma: a bead reaches half its diameter beyond its centre
  const std::vector<Vec3> centres = present_centres(frame);
  return centres.empty() ? BedWindow{.content = 0} : bed_window(centres, box, kMargin);
}

BedForces bed_forces(const Frame& frame, const TrajectoryInfo& info) {
  const double volume = stress_window(frame, info.box).content;
  if (!(volume > 0)) return {};
  BedForces now = BedForces::zero(info.walls.size());
  double pairs = 0;
  for (const ContactForce& c : frame.contact_forces) {
    const Vec3 force = c.force();
    now.stress += force * branch_vector(c, info).transpose();
    if (c.j >= 0) {
      ++pairs;
      now.normal_force += c.normal_force;
      now.tangential_force += c.tangential_force.norm();
    } else if (const auto w = static_cast<std::size_t>(-1 - c.j); w < now.wall_force.size()) {
      now.wall_normal_force[w] += c.normal_force;
      now.wall_force[w] -= force;  // c.force() acts on the bead
    }
  }
  if (pairs > 0) {
    now.in_contact = 1;
    now.normal_force /= pairs;
    now.tangential_force /= pairs;
  }
  now.stress /= volume;
  now.kinetic = kinetic_sum(frame, info.mass) / volume;
  return now;
}

}  // namespace twincell
