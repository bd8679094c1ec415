#include "sim/run/contact_forces.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "sim/laws/cell_laws.hpp"
#include "sim/stepping/packed_beads.hpp"
#include "sim/system/cell_grid.hpp"

namespace twincell::sim {
namespace {

using Size = std::size_t;
using Key = std::pair<std::int32_t, std::int32_t>;

/// Evaluates one contact at a time with the kernels of velocities that are known at the positions.
class Evaluation {
 public:
  Evaluation(const Plan& plan, const System& s, const std::vector<ContactMemory>& memories)
      : plan_(plan),
        system_(s),
        memories_(memories),
        kernels_(kScalar.find({plan.key.dimension, plan.key.normal, plan.key.tangential, plan.key.rolling,
                               Velocity::half_step})),
        beads_(plan),
        quantum_(rounding_constant(plan)),
        record_(plan.dimension == 2 ? kRecord<2> : kRecord<3>) {
    std::vector<std::int32_t> order(s.beads.size());
    std::iota(order.begin(), order.end(), 0);
    beads_.load(s, order, 0);
  }

  [[nodiscard]] ContactForce pair(std::int32_t i, std::int32_t j, const Vec3& shift) {
    const Bead &a = system_.beads[static_cast<Size>(i)], &b = system_.beads[static_cast<Size>(j)];
    const std::vector<double> constants =
        contact_constants(plan_.laws->bead, beads_.pair(static_cast<Size>(i), static_cast<Size>(j)),
                          a.radius + b.radius, 1 / a.radius, 1 / b.radius);
    std::vector<double> memory = memory_of({i, j});
    const std::int32_t record_i = i * record_, record_j = j * record_;
    const auto image = components(shift);
    PairArgs p{};
    p.records = beads_.records(), p.spins = beads_.spins(), p.forces = beads_.forces();
    p.i = p.force_i = &record_i, p.j = p.force_j = &record_j;
    p.shift = image.data();
    p.constants = constants.data(), p.memory = memory.data();
    p.packets = 1, p.dt = 0, p.locate = false, p.quantum = quantum_;
    clear(i), clear(j);
    kernels_.pairs(p);
    const Vec3 apart = centre_of(a) - centre_of(b) + shift;
    return resolved({i, j}, a.radius + b.radius - apart.norm(), apart.normalized());
  }

  [[nodiscard]] ContactForce wall(std::int32_t i, std::int32_t w) {
    const Bead& bead = system_.beads[static_cast<Size>(i)];
    const Wall& wall = system_.walls[static_cast<Size>(w)];
    const std::vector<double> constants =
        contact_constants(plan_.laws->walls[static_cast<Size>(w)], beads_.wall(static_cast<Size>(i)),
                          bead.radius, 1 / bead.radius, 0);
    std::vector<double> memory = memory_of({i, -1 - w});
    const std::int32_t record = i * record_;
    const auto normal = components(wall.n);
    const Vec3 plate = wall.moves ? system_.plate_velocity_in_space() : Vec3::Zero();
    const auto velocity = components(plate);
    WallArgs g{};
    g.records = beads_.records(), g.spins = beads_.spins(), g.forces = beads_.forces();
    g.bead = &record;
    g.constants = constants.data(), g.memory = memory.data();
    std::copy(normal.begin(), normal.end(), g.n);
    std::copy(velocity.begin(), velocity.end(), g.velocity);
    g.offset = offset_now(system_, wall);
    g.packets = 1, g.dt = 0, g.locate = false, g.quantum = quantum_;
    clear(i);
    kernels_.walls(g);
    return resolved({i, -1 - w}, bead.radius - (wall.n.dot(centre_of(bead)) - g.offset), wall.n);
  }

 private:
  /// A vector in the order of the kernels: (x, z) or (x, y, z).
  [[nodiscard]] std::array<double, 3> components(const Vec3& v) const {
    if (plan_.dimension == 2) return {v.x(), v.z(), 0};
    return {v.x(), v.y(), v.z()};
  }
  [[nodiscard]] std::vector<double> memory_of(Key key) const {
    // The numbers of the laws come first; those of the integrator after them are not used here.
    std::vector<double> memory(static_cast<Size>(kernels_.remembered) + 1, 0);
    const auto found = std::lower_bound(memories_.begin(), memories_.end(), key,
                                        [](const ContactMemory& c, Key k) { return Key(c.i, c.j) < k; });
    if (found != memories_.end() && Key(found->i, found->j) == key)
      std::copy_n(found->values.begin(),
                  std::min<Size>(found->values.size(), static_cast<Size>(kernels_.remembered)),
                  memory.begin());
    return memory;
  }
  void clear(std::int32_t bead) { std::fill_n(beads_.forces() + bead * record_, record_, 0.0); }
  /// The force that the kernel has added to bead key.first, split at the normal.
  [[nodiscard]] ContactForce resolved(Key key, double overlap, const Vec3& n) {
    const double* f = beads_.forces() + key.first * record_;
    const Vec3 force = plan_.dimension == 2 ? Vec3(f[0], 0, f[1]) : Vec3(f[0], f[1], f[2]);
    ContactForce c{.i = key.first, .j = key.second, .overlap = overlap, .normal = n};
    c.normal_force = force.dot(n);
    if (plan_.rotation) c.tangential_force = force - c.normal_force * n;
    return c;
  }

  const Plan& plan_;
  const System& system_;
  const std::vector<ContactMemory>& memories_;
  Kernels kernels_;
  PackedBeads beads_;
  double quantum_;
  std::int32_t record_;
};

}  // namespace

std::vector<ContactForce> contact_forces(const Plan& plan, const System& system,
                                         const std::vector<ContactMemory>& memories) {
  Evaluation evaluation(plan, system, memories);
  std::vector<ContactForce> all;
  for_each_near_pair(system.beads, system.dimension, system.period, 0,
                     [&](std::int32_t i, std::int32_t j, double, const Vec3& shift) {
                       all.push_back(i < j ? evaluation.pair(i, j, shift) : evaluation.pair(j, i, -shift));
                     });
  for (Size w = 0; w < system.walls.size(); ++w)
    for (Size i = 0; i < system.beads.size(); ++i) {
      const Bead& b = system.beads[i];
      if (system.walls[w].n.dot(centre_of(b)) - offset_now(system, system.walls[w]) < b.radius)
        all.push_back(evaluation.wall(static_cast<std::int32_t>(i), static_cast<std::int32_t>(w)));
    }
  std::sort(all.begin(), all.end(),
            [](const ContactForce& a, const ContactForce& b) { return Key(a.i, a.j) < Key(b.i, b.j); });
  return all;
}

}  // namespace twincell::sim
