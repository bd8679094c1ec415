#include "calibration/contact/collisions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/constants.hpp"
#include "core/error.hpp"
#include "core/plural.hpp"

namespace twincell::calibration {
namespace {

/// Time in [0, longest] at which two discs in uniform relative motion touch; none if they do not.
std::optional<double> meeting(const Vec3& r, const Vec3& v, double reach, double longest) {
  const double b = r.dot(v), c = r.squaredNorm() - reach * reach, a = v.squaredNorm();
  if (!(b < 0) || c < 0 || a == 0) return std::nullopt;
  const double root = b * b - a * c;
  if (root < 0) return std::nullopt;
  const double t = (-b - std::sqrt(root)) / a;
  return t >= 0 && t <= longest ? std::optional(t) : std::nullopt;
}

class Finder {
 public:
  Finder(const TrajectorySource& source, const CollisionOptions& options, std::size_t stride)
      : info_(source.info()),
        options_(options),
        gravity_(options.gravity.value_or(gravity_of(info_))),
        source_(source),
        stride_(stride) {
    found_.stride = stride;
  }

  FoundCollisions find() {
    found_.spins = info_.columns.spin;
    const bool velocities = info_.columns.velocity;
    // Velocities from differences need one more frame on either side.
    const std::size_t margin = velocities ? 0 : 1, n = (source_.n_frames() + stride_ - 1) / stride_;
    if (n < 2 + 2 * margin)
      throw InputError({.file = source_.name(), .key = {}}, fmt::format("has {}; collisions need {} or more.",
                                                                        plural(n, "frame"), 2 + 2 * margin));
    std::vector<Frame> frames(2 + 2 * margin);
    for (std::size_t f = 0; f + frames.size() <= n; ++f) {
      for (std::size_t k = 0; k < frames.size(); ++k)
        if (f == 0 || k + 1 == frames.size()) source_.read((f + k) * stride_, frames[k]);
      between(frames[margin], frames[margin + 1], velocities ? nullptr : &frames.front(),
              velocities ? nullptr : &frames.back());
      std::rotate(frames.begin(), frames.begin() + 1, frames.end());
    }
    return std::move(found_);
  }

 private:
  /// Velocity in `at`; `other` is the neighbouring frame away from the collision.
  [[nodiscard]] Vec3 velocity(const Frame& at, const Frame* other, std::size_t i) const {
    if (other == nullptr) return at.velocity[i];
    const double dt = at.time - other->time;
    Vec3 v = (at.position[i] - other->position[i]) / dt;
    v.y() = 0;
    v.z() -= gravity_ * 0.5 * dt;  // from the interval's middle to this end; dt < 0 after the collision
    return v;
  }
  [[nodiscard]] double radius(std::size_t i) const { return radius_of(info_.radius, i); }
  [[nodiscard]] static bool there(const Frame& f, std::size_t i) {
    return f.present(i) && std::isfinite(f.position[i].x());
  }

  void between(const Frame& a, const Frame& b, const Frame* before, const Frame* after) {
    const double dt = b.time - a.time;
    if (!(dt > 0)) return;
    const std::size_t n = info_.n_beads;
    std::vector<std::size_t> order;
    std::vector<Vec3> v(n, Vec3::Zero()), w(n, Vec3::Zero());
    double fastest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (!there(a, i) || !there(b, i) || (before && !there(*before, i)) || (after && !there(*after, i)))
        continue;
      v[i] = velocity(a, before, i);
      w[i] = velocity(b, after, i);
      fastest = std::max(fastest, v[i].norm());
      order.push_back(i);
    }
    std::sort(order.begin(), order.end(),
              [&](std::size_t i, std::size_t k) { return a.position[i].x() < a.position[k].x(); });
    // Pairs across a periodic boundary are skipped: they are few and do not differ from the others.
    for (std::size_t p = 0; p < order.size(); ++p)
      for (std::size_t q = p + 1; q < order.size(); ++q) {
        const std::size_t i = order[p], k = order[q];
        const double reach = radius(i) + radius(k);
        if (a.position[k].x() - a.position[i].x() > reach + 2 * fastest * dt) break;
        meet(i, k, reach, a, b, v, w, dt);
      }
  }

  void meet(std::size_t i, std::size_t k, double reach, const Frame& a, const Frame& b,
            const std::vector<Vec3>& v, const std::vector<Vec3>& w, double dt) {
    const auto flat = [](Vec3 r) {
      r.y() = 0;
      return r;
    };
    const Vec3 r = flat(a.position[i] - a.position[k]), u = flat(v[i] - v[k]);
    const Vec3 r2 = flat(b.position[i] - b.position[k]), u2 = flat(w[i] - w[k]);
    const auto t = meeting(r, u, reach, dt);
    // Backwards in time, separating beads approach.
    const auto t2 = meeting(r2, -u2, reach, dt);
    if (!t || !t2 || std::abs(*t + *t2 - dt) > 0.5 * dt) return;
    const Vec3 n = ((r + u * *t).normalized() + (r2 - u2 * *t2).normalized()).normalized();
    const double approach = -u.dot(n);
    if (!(approach > options_.least_speed)) return;
    ++found_.pairs;
    const double mi = mass_of(info_.mass, i), mk = mass_of(info_.mass, k);
    const Vec3 kick = flat((mi * (w[i] - v[i]) + mk * (w[k] - v[k])) / (mi + mk)) + Vec3(0, 0, gravity_ * dt);
    if (kick.norm() > options_.largest_kick * approach) {
      ++found_.crowded;
      return;
    }
    Impact impact{.speed = approach, .restitution = u2.dot(n) / approach, .psi_1 = kNaN, .psi_2 = kNaN};
    if (info_.columns.spin) {
      const Vec3 t_hat(-n.z(), 0, n.x());
      // Counter-clockwise spin is -y (trajectory.hpp).
      const auto surface = [&](const Frame& f, const Vec3& g) {
        return g.dot(t_hat) + radius(i) * f.spin[i].y() + radius(k) * f.spin[k].y();
      };
      const double g = surface(a, u), g2 = surface(b, u2), sign = g < 0 ? -1 : 1;
      impact.psi_1 = sign * g / approach;
      impact.psi_2 = sign * g2 / approach;
    }
    found_.impacts.push_back(impact);
  }

  const TrajectoryInfo& info_;
  const CollisionOptions& options_;
  double gravity_;
  const TrajectorySource& source_;
  std::size_t stride_;
  FoundCollisions found_;
};

}  // namespace

FoundCollisions find_collisions(const TrajectorySource& trajectory, const CollisionOptions& options) {
  if (options.stride > 0) return Finder(trajectory, options, options.stride).find();
  constexpr std::size_t kMinFrames = 16;
  constexpr double kClearlyMore = 1.25;
  FoundCollisions best = Finder(trajectory, options, 1).find();
  for (std::size_t stride = 2; trajectory.n_frames() / stride >= kMinFrames; stride *= 2) {
    FoundCollisions found = Finder(trajectory, options, stride).find();
    const auto before = static_cast<double>(best.impacts.size());
    if (before > 0 && static_cast<double>(found.impacts.size()) <= kClearlyMore * before) break;
    best = std::move(found);
  }
  return best;
}

}  // namespace twincell::calibration
