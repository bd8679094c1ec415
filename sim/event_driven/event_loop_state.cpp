// The beads, forces and contact memories of event-driven motion at a step, as steps would have left them.

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "sim/event_driven/event_loop.hpp"

namespace twincell::sim {

void EventLoop::write_contact(System& s, const BinaryContact& c, const RelativeMotion& m, const Vec3& xi,
                              double t) {
  const CollisionSetting e = beads_.setting(c.i, c.j);
  const CollisionForce f = force_of(e, m, xi);
  const auto add = [&](std::int32_t bead, double sign) {
    Force& to = s.forces[static_cast<std::size_t>(bead)];
    to.x += sign * f.force.x(), to.y += sign * f.force.y(), to.z += sign * f.force.z();
    to.q_x += f.moment.x(), to.q -= f.moment.y(), to.q_z += f.moment.z();
  };
  add(c.i, 1);
  if (c.j >= 0) add(c.j, -1);
  ContactMemory memory{c.i, c.j, {}};
  // A tangential vector; in 2D only its component along (-n_z, n_x).
  const auto remember = [&](const Vec3& along) {
    if (plan_.dimension == 2)
      memory.values.push_back(-along.x() * f.normal.z() + along.z() * f.normal.x());
    else
      memory.values.insert(memory.values.end(), {along.x(), along.y(), along.z()});
  };
  if (plan_.history) remember(xi);
  if (plan_.key.velocity == Velocity::half_step) {
    if (plan_.history) memories_.push_back(std::move(memory));
    return;
  }
  // The contact memory that a preceding step would have left: the velocities in the middle of that step.
  const double half = 0.5 * dt_;
  RelativeMotion middle = m;
  Vec3 push = f.force / e.pair.m_eff + e.pull + e.swing * std::sin(e.omega * t);
  middle.u -= half * push;
  middle.s += half * e.turn * f.moment;
  const double v_n = middle.u.dot(f.normal);
  memory.values.push_back(v_n);
  if (plan_.rotation) remember(middle.u - v_n * f.normal - middle.s.cross(f.normal));
  memories_.push_back(std::move(memory));
}

void EventLoop::write(System& s) {
  const double t = static_cast<double>(s.step - base_) * dt_;
  const auto put = [&](std::size_t i, const BeadState& at) {
    Bead& b = s.beads[i];
    b.x = at.r.x(), b.y = at.r.y(), b.z = at.r.z();
    b.vx = at.v.x(), b.vy = at.v.y(), b.vz = at.v.z();
    b.spin_x = at.rim.x() / b.radius, b.spin = -at.rim.y() / b.radius, b.spin_z = at.rim.z() / b.radius;
  };
  const auto flown = [&](const BallisticPath& line, const Vec3& rim) {
    return BeadState{line.position(t, beads_.gravity), line.velocity(t, beads_.gravity), rim};
  };
  s.rim_speeds.clear();
  s.forces.assign(s.beads.size(), {});
  s.forces_known = true;
  memories_.clear();
  for (std::size_t i = 0; i < s.beads.size(); ++i) put(i, flown(beads_.paths[i], beads_.rim[i]));
  // The paths are those after a contact; beads still in contact need its integration.
  for (const BinaryContact& c : contacts_) {
    if (t < c.from || t >= c.end) continue;
    std::array<BeadState, 2> both{};
    if (t <= c.begin) {
      for (std::size_t q = 0; q < 2; ++q) both[q] = flown(c.before[q], c.rim[q]);
      if (t == c.begin) write_contact(s, c, c.motion, Vec3::Zero(), t);
    } else {
      const CollisionEnd now =
          integrate_collision(beads_.setting(c.i, c.j), c.motion, c.begin, t, kTolerance);
      both = beads_.states_of(c, now.motion, t);
      write_contact(s, c, now.motion, now.xi, t);
    }
    put(static_cast<std::size_t>(c.i), both[0]);
    if (c.j >= 0) put(static_cast<std::size_t>(c.j), both[1]);
  }
  for (const ClusterRun& c : clusters_) {
    if (s.step - c.cluster.start.step >= c.cluster.steps) continue;
    const ClusterState now = after(c.cluster, s.step - c.cluster.start.step, make_few_);
    for (std::size_t k = 0; k < c.cluster.members.size(); ++k) {
      const auto i = static_cast<std::size_t>(c.cluster.members[k]);
      s.beads[i] = now.system.beads[k];
      s.forces[i] = now.system.forces[k];
    }
    for (ContactMemory m : now.memories) {
      m.i = c.cluster.members[static_cast<std::size_t>(m.i)];
      if (m.j >= 0) m.j = c.cluster.members[static_cast<std::size_t>(m.j)];
      memories_.push_back(std::move(m));
    }
  }
  std::sort(memories_.begin(), memories_.end(), [](const ContactMemory& a, const ContactMemory& b) {
    return std::pair(a.i, a.j) < std::pair(b.i, b.j);
  });
}

}  // namespace twincell::sim
