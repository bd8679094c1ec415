#include "trajectory/trajectory.hpp"

#include <algorithm>

namespace twincell {

double gravity_of(const TrajectoryInfo& info) {
  if (!info.drive) return 1;
  const bool none = info.conditions.n_l && !info.conditions.gamma && !info.drive->ramp;
  return none ? 0 : info.drive->gravity;
}

BedForces BedForces::zero(std::size_t walls) {
  BedForces none;
  none.wall_normal_force.assign(walls, 0);
  none.wall_force.assign(walls, Vec3::Zero());
  none.stress = none.kinetic = Tensor::Zero();
  none.in_contact = none.normal_force = none.tangential_force = 0;
  return none;
}

void BedForces::add(const BedForces& sample, double weight) {
  for (std::size_t w = 0; w < wall_force.size(); ++w) {
    wall_normal_force[w] += weight * sample.wall_normal_force[w];
    wall_force[w] += weight * sample.wall_force[w];
  }
  stress += weight * sample.stress;
  kinetic += weight * sample.kinetic;
  in_contact += weight * sample.in_contact;
  normal_force += weight * sample.normal_force;
  tangential_force += weight * sample.tangential_force;
}

std::size_t Frame::n_present() const {
  if (id.empty()) return position.size();
  return static_cast<std::size_t>(std::count_if(id.begin(), id.end(), [](std::int64_t v) { return v >= 0; }));
}

}  // namespace twincell
