#include "sim/event_driven/ballistic_state.hpp"

#include <algorithm>
#include <cmath>

#include "sim/laws/cell_laws.hpp"

namespace twincell::sim {

namespace {

/// The first x > 0 with c + b x + a x^2/2 = 0, for c > 0, or for c = 0 and b > 0; infinite if there is no
/// such x.
double first_zero(double c, double b, double a) {
  const double inside = b * b - 2 * a * c;
  if (inside < 0) return HUGE_VAL;
  const double root = std::sqrt(inside);
  if (b < 0) return 2 * c / (root - b);
  return a < 0 ? (b + root) / -a : HUGE_VAL;
}

std::vector<double> radii_of(const System& s) {
  std::vector<double> radii;
  for (const Bead& b : s.beads) radii.push_back(b.radius);
  return radii;
}

}  // namespace

BallisticState::BallisticState(const Plan& of, const System& s, double time)
    : plan(&of),
      paths(radii_of(s), s.dimension, s.period),
      rim(s.beads.size()),
      walls(s.walls),
      gravity(s.gravity),
      axis(static_cast<Eigen::Index>(s.drive.axis)),
      amplitude(s.drive.amplitude),
      omega(s.drive.omega) {
  for (std::size_t i = 0; i < s.beads.size(); ++i) {
    const Bead& b = s.beads[i];
    mass.push_back(b.mass);
    turn.push_back(b.radius * b.radius / b.inertia);
    set_path(i, s, i, time);
  }
}

void BallisticState::set_path(std::size_t i, const System& s, std::size_t k, double t) {
  const Bead& b = s.beads[k];
  rim[i] = s.rim_speeds.size() == s.beads.size()
               ? Vec3(s.rim_speeds[k])
               : Vec3(b.radius * b.spin_x, -b.radius * b.spin, b.radius * b.spin_z);
  paths.put(i, path_of(b, t));
  paths.valid_from(i) = t;
}

void BallisticState::move_origin(double by) {
  for (std::size_t i = 0; i < paths.size(); ++i) {
    paths.put(i, paths[i].later(by, gravity));
    paths.valid_from(i) -= by;
  }
}

RelativeMotion BallisticState::relative_motion(BinaryContact& c, double t) const {
  const Vec3 r = c.before[0].position(t, gravity), v = c.before[0].velocity(t, gravity);
  if (c.j < 0) {
    const auto [point, speed] = surface(walls[static_cast<std::size_t>(-1 - c.j)], t);
    return {r - point, v - speed, c.rim[0]};
  }
  RelativeMotion m;
  m.r = r - c.before[1].position(t, gravity);
  c.shift = paths.shift(m.r);
  m.r += c.shift;
  m.u = v - c.before[1].velocity(t, gravity);
  m.s = c.rim[0] + c.rim[1];
  return m;
}

bool BallisticState::in_wall(std::size_t i, const Wall& wall, double t) const {
  const double above = wall.n.dot(paths[i].position(t, gravity)) - wall.offset - paths.radius(i) + 1e-12;
  if (!wall.moves || above > std::abs(amplitude)) return above < 0;
  return above < wall.n.dot(plate(t));
}
/// The gap h(t) is a parabola minus a sine, and its curvature is bounded below by -m. The root x of
/// h + h' x - m x^2/2 = 0 is therefore a step that never passes the first root of h, and the steps converge
/// to it as fast as Newton's.
double BallisticState::wall_touch(std::size_t i, const Wall& wall, double from, double needed) const {
  const BallisticPath line = paths[i];
  const double height = wall.n.dot(line.a) - wall.offset - paths.radius(i), speed = wall.n.dot(line.b),
               fall = wall.n.dot(gravity);
  const double swing = wall.moves ? amplitude * wall.n[axis] : 0, most = std::abs(swing);
  const double bend = std::max(0.0, most * omega * omega - fall);
  double t = from;
  for (int k = 0; k < 200; ++k) {
    // No touch is possible until the parabola reaches the highest position of the wall.
    const double above = height + t * (speed + 0.5 * t * fall) - most, rise = speed + t * fall;
    if (above > 0) {
      const double down = first_zero(above, rise, fall);
      if (down == HUGE_VAL) return HUGE_VAL;
      t += down;
    }
    if (t >= needed) return HUGE_VAL;
    double sine = 0, cosine = 0;
    if (most > 0) sine = std::sin(omega * t), cosine = std::cos(omega * t);
    const double h = height + t * (speed + 0.5 * t * fall) - swing * sine;
    const double rate = speed + t * fall - swing * omega * cosine;
    if (h < 1e-14 && rate <= 0) return t;
    const double x = first_zero(std::max(0.0, h), rate, -bend);
    if (x == HUGE_VAL) return HUGE_VAL;
    if (t + x == t) return t;
    t += x;
  }
  return t;
}

double BallisticState::distance(const PathInterval& p, const PathInterval& q, double t) const {
  const Vec3 d = p.line.a - q.line.a + t * (p.line.b - q.line.b);
  return (d + paths.shift(d)).norm();
}
bool BallisticState::come_near(const PathInterval& p, const PathInterval& q, double begin, double end) const {
  const Vec3 w = p.line.b - q.line.b;
  Vec3 d = p.line.a - q.line.a + begin * w;
  d += paths.shift(d);
  const double t = std::clamp(-d.dot(w) / std::max(w.squaredNorm(), 1e-300), 0.0, end - begin);
  const double reach = p.radius + q.radius;
  return (d + t * w).squaredNorm() < reach * reach;
}
bool BallisticState::reaches(const PathInterval& p, const Wall& wall) const {
  const double span = p.end - p.begin, swing = wall.moves ? std::abs(amplitude) : 0;
  const double bend = gravity.norm() + swing * omega * omega, sag = 0.125 * bend * span * span;
  const auto height = [&](double t) {
    return wall.n.dot(p.line.position(t, gravity)) - wall.offset - p.radius;
  };
  const double begin = height(p.begin), end = height(p.end);
  if (std::min(begin, end) > swing + sag) return false;
  const auto rise = [&](double t) { return wall.moves ? wall.n.dot(plate(t)) : 0; };
  return std::min(begin - rise(p.begin), end - rise(p.end)) < sag;
}

CollisionSetting BallisticState::setting(std::int32_t i, std::int32_t j) const {
  const auto a = static_cast<std::size_t>(i);
  CollisionSetting e;
  e.dimension = plan->dimension;
  const double m = mass[a], r = paths.radius(a);
  if (j < 0) {
    const Wall& wall = walls[static_cast<std::size_t>(-1 - j)];
    e.laws = &plan->laws->walls[static_cast<std::size_t>(-1 - j)];
    e.reach = r;
    e.turn = turn[a];
    e.pair = {m, r, 1 / m + turn[a]};
    e.wall = wall.n;
    e.pull = gravity;
    if (wall.moves) e.swing[axis] = amplitude * omega * omega, e.omega = omega;
  } else {
    const auto b = static_cast<std::size_t>(j);
    const double m_b = mass[b], r_b = paths.radius(b);
    e.laws = &plan->laws->bead;
    e.reach = r + r_b;
    e.turn = turn[a] + turn[b];
    e.pair = {m * m_b / (m + m_b), r * r_b / (r + r_b), 1 / m + 1 / m_b + turn[a] + turn[b]};
  }
  return e;
}
Vec3 BallisticState::plate(double t) const {
  Vec3 d = Vec3::Zero();
  d[axis] = amplitude * std::sin(omega * t);
  return d;
}
Vec3 BallisticState::plate_velocity(double t) const {
  Vec3 v = Vec3::Zero();
  v[axis] = amplitude * omega * std::cos(omega * t);
  return v;
}
std::pair<Vec3, Vec3> BallisticState::surface(const Wall& wall, double t) const {
  const Vec3 foot = wall.offset * wall.n;
  if (!wall.moves) return {foot, Vec3::Zero()};
  return {foot + plate(t), plate_velocity(t)};
}

std::array<BeadState, 2> BallisticState::states_of(const BinaryContact& c, const RelativeMotion& m,
                                                   double t) const {
  const auto i = static_cast<std::size_t>(c.i);
  std::array<BeadState, 2> both{};
  if (c.j < 0) {
    const auto [point, speed] = surface(walls[static_cast<std::size_t>(-1 - c.j)], t);
    both[0] = {point + m.r, speed + m.u, m.s};
    return both;
  }
  const auto j = static_cast<std::size_t>(c.j);
  const double share = mass[i] / (mass[i] + mass[j]);
  const Vec3 r =
      share * c.before[0].position(t, gravity) + (1 - share) * (c.before[1].position(t, gravity) - c.shift);
  const Vec3 v = share * c.before[0].velocity(t, gravity) + (1 - share) * c.before[1].velocity(t, gravity);
  const Vec3 turned = m.s - c.rim[0] - c.rim[1];
  const double part = turn[i] / (turn[i] + turn[j]);
  both[0] = {r + (1 - share) * m.r, v + (1 - share) * m.u, c.rim[0] + part * turned};
  both[1] = {r - share * m.r + c.shift, v - share * m.u, c.rim[1] + (1 - part) * turned};
  return both;
}

}  // namespace twincell::sim
