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
        record_(plan.dimension == 2 ? kRecord<2> : kRecord<3>),
        wall_constants_(system_.walls.size()) {
    std::vector<std::int32_t> order(s.beads.size());
    std::iota(order.begin(), order.end(), 0);
    beads_.load(s, order, 0);
  }

  [[nodiscard]] ContactForce pair(std::int32_t i, std::int32_t j, const Vec3& shift) {
    const Bead &a = system_.beads[static_cast<Size>(i)], &b = system_.beads[static_cast<Size>(j)];
    if (pair_constants_.empty() || !beads_.equal())
      pair_constants_ = pair_constants(plan_, beads_, static_cast<Size>(i), static_cast<Size>(j));
    recall({i, j});
    const std::int32_t record_i = i * record_, record_j = j * record_;
    const auto image = components(shift);
    PairArgs p{};
    p.records = beads_.records(), p.spins = beads_.spins(), p.forces = beads_.forces();
    p.i = p.force_i = &record_i, p.j = p.force_j = &record_j;
    p.shift = image.data();
    p.constants = pair_constants_.data(), p.memory = memory_.data();
    p.packets = 1, p.dt = 0, p.locate = false, p.quantum = quantum_;
    clear(i), clear(j);
    kernels_.pairs(p);
    const Vec3 apart = centre_of(a) - centre_of(b) + shift;
    return resolved({i, j}, a.radius + b.radius - apart.norm(), apart.normalized());
  }

  [[nodiscard]] ContactForce wall(std::int32_t i, std::int32_t w) {
    const Bead& bead = system_.beads[static_cast<Size>(i)];
    const Wall& wall = system_.walls[static_cast<Size>(w)];
    std::vector<double>& constants = wall_constants_[static_cast<Size>(w)];
    if (constants.empty() || !beads_.equal())
      constants = wall_constants(plan_, beads_, static_cast<Size>(w), static_cast<Size>(i));
    recall({i, -1 - w});
    const std::int32_t record = i * record_;
    const auto normal = components(wall.n);
    const Vec3 plate = wall.moves ? system_.plate_velocity_in_space() : Vec3::Zero();
    const auto velocity = components(plate);
    WallArgs g{};
    g.records = beads_.records(), g.spins = beads_.spins(), g.forces = beads_.forces();
    g.bead = &record;
    g.constants = constants.data(), g.memory = memory_.data();
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
  /// Sets memory_ to that of a contact, which is all 0 at its beginning.
  void recall(Key key) {
    // The numbers of the laws come first; those of the integrator after them are not used here.
    const auto numbers = static_cast<Size>(kernels_.remembered);
    memory_.assign(numbers + 1, 0);
    if (numbers == 0) return;
    const auto before = [](const ContactMemory& c, Key k) { return Key(c.i, c.j) < k; };
    // Contacts are mostly evaluated in the order of the memories, so the next one is at hand.
    if (next_ >= memories_.size() || before(memories_[next_], key) ||
        (next_ > 0 && !before(memories_[next_ - 1], key)))
      next_ = static_cast<Size>(std::lower_bound(memories_.begin(), memories_.end(), key, before) -
                                memories_.begin());
    if (next_ == memories_.size() || Key(memories_[next_].i, memories_[next_].j) != key) return;
    const std::vector<double>& values = memories_[next_].values;
    std::copy_n(values.begin(), std::min(values.size(), numbers), memory_.begin());
    ++next_;
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
  std::vector<double> memory_, pair_constants_;
  Size next_ = 0;  ///< where recall() looks first
  std::vector<std::vector<double>> wall_constants_;
};

}  // namespace

bool NearPairs::cover(const System& s) const {
  if (at_.size() != s.beads.size() || !(margin_ > 0)) return false;
  // A bed that flies or lands as a whole brings no beads together.
  Vec3 mean = Vec3::Zero();
  for (Size i = 0; i < at_.size(); ++i) mean += centre_of(s.beads[i]) - at_[i];
  mean /= static_cast<double>(at_.size());
  constexpr double kSlack = 1 - 1e-9;
  const double most = kSlack * margin_ / 2;
  for (Size i = 0; i < at_.size(); ++i)
    if (!((centre_of(s.beads[i]) - at_[i] - mean).squaredNorm() < most * most)) return false;
  return true;
}

const std::vector<std::pair<std::int32_t, std::int32_t>>& NearPairs::of(const System& s) {
  if (cover(s)) return pairs_;
  constexpr double kMargin = 0.4;  // of the smallest diameter
  double smallest = 0, largest = 0;
  for (const Bead& b : s.beads) {
    smallest = smallest == 0 ? 2 * b.radius : std::min(smallest, 2 * b.radius);
    largest = std::max(largest, 2 * b.radius);
  }
  margin_ = kMargin * smallest;
  for (const double period : s.period)  // the search finds one image of a pair
    if (period > 0 && period < 2 * (largest + margin_)) margin_ = 0;
  pairs_.clear();
  at_.clear();
  for (const Bead& b : s.beads) at_.push_back(centre_of(b));
  for_each_near_pair(s.beads, s.dimension, s.period, margin_,
                     [&](std::int32_t i, std::int32_t j, double, const Vec3&) {
                       pairs_.emplace_back(std::min(i, j), std::max(i, j));
                     });
  std::sort(pairs_.begin(), pairs_.end());
  return pairs_;
}

std::vector<ContactForce> contact_forces(const Plan& plan, const System& system,
                                         const std::vector<ContactMemory>& memories) {
  NearPairs near;
  return contact_forces(plan, system, memories, near);
}

std::vector<ContactForce> contact_forces(const Plan& plan, const System& system,
                                         const std::vector<ContactMemory>& memories, NearPairs& near) {
  Evaluation evaluation(plan, system, memories);
  std::vector<ContactForce> all;
  const bool periodic = std::ranges::any_of(system.period, [](double p) { return p > 0; });
  struct Ball {
    Vec3 centre;
    double radius;
  };
  std::vector<Ball> balls;  // a third of the memory of the beads
  balls.reserve(system.beads.size());
  for (const Bead& b : system.beads) balls.push_back({centre_of(b), b.radius});
  constexpr double kMore = 1 + 1e-12;  // most pairs are apart, which needs no root
  for (const auto& [i, j] : near.of(system)) {
    const Ball &a = balls[static_cast<Size>(i)], &b = balls[static_cast<Size>(j)];
    const double reach = a.radius + b.radius;
    const Vec3 apart = a.centre - b.centre,
               shift = periodic ? nearest_shift(apart, system.period) : Vec3(Vec3::Zero());
    const double square = (apart + shift).squaredNorm();
    if (square < kMore * reach * reach && std::sqrt(square) < reach)
      all.push_back(evaluation.pair(i, j, shift));
  }
  for (Size w = 0; w < system.walls.size(); ++w) {
    const double offset = offset_now(system, system.walls[w]);
    for (Size i = 0; i < system.beads.size(); ++i) {
      const Bead& b = system.beads[i];
      if (system.walls[w].n.dot(centre_of(b)) - offset < b.radius)
        all.push_back(evaluation.wall(static_cast<std::int32_t>(i), static_cast<std::int32_t>(w)));
    }
  }
  std::sort(all.begin(), all.end(),
            [](const ContactForce& a, const ContactForce& b) { return Key(a.i, a.j) < Key(b.i, b.j); });
  return all;
}

}  // namespace twincell::sim
