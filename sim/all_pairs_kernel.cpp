// The oracle: every pair and every wall at every step, one contact at a time, what contacts remember in a
// table.

#include <cmath>
#include <map>
#include <numeric>

#include "sim/list_kernel.hpp"
#include "sim/packed.hpp"
#include "sim/subnormals.hpp"

namespace twincell::sim {

namespace {

class AllPairsKernel : public Kernel {
 public:
  AllPairsKernel(const Plan& plan, const GuardLimits& limits)
      : plan_(plan),
        limits_(limits),
        passes_(kScalar.find(plan.key)),
        beads_(plan_),
        magic_(grain_of_sums(plan)) {}

  void advance(System& s, std::int64_t steps) override {
    if (s.beads.empty() || steps <= 0) {
      s.step += std::max<std::int64_t>(0, steps);
      return;
    }
    const FlushSubnormals flush;
    order_.resize(s.beads.size());
    std::iota(order_.begin(), order_.end(), 0);
    s.forces_known = s.forces_known && s.forces.size() == s.beads.size();
    const bool known = s.forces_known;
    if (!beads_.agrees(s, order_)) beads_.take(s, order_, 0);
    IntegrateArgs args = beads_.integrate_args(s);
    // How far beads stray from free flight is of no interest here.
    reference_.resize(static_cast<std::size_t>(record(1)) / 2 * s.beads.size());
    args.reference = reference_.data();
    const BeadRange all{0, static_cast<std::int64_t>(s.beads.size())};
    args.runs = &all, args.n_runs = 1;
    if (!known) forces(s);
    for (std::int64_t k = 0; k < steps; ++k) {
      args.kicks = k == 0 ? 1 : 2;
      args.drift = true;
      passes_.integrate(args);
      ++s.step;
      if (!(forces(s) <= limits_.overlap)) {
        beads_.give(s, order_);
        explain_overlap(s, limits_);
      }
    }
    args.kicks = 1;
    args.drift = false;
    passes_.integrate(args);
    beads_.give(s, order_);
    check_motion(s, limits_);
  }
  [[nodiscard]] std::int64_t list_builds() const override { return 0; }
  void rebuild_every(std::int64_t) override {}
  [[nodiscard]] std::vector<ContactMemory> contacts() const override {
    std::vector<ContactMemory> all;
    for (const auto& [key, contact] : contacts_)
      for (const double v : contact.memory)
        if (v != 0) {
          all.push_back({key.first, key.second, contact.memory});
          break;
        }
    return all;
  }
  void restore(std::vector<ContactMemory> contacts) override {
    for (ContactMemory& c : contacts) contacts_[{c.i, c.j}].memory = std::move(c.values);
  }
  [[nodiscard]] std::string description() const override { return "all pairs, 1 contact at a time"; }

 private:
  [[nodiscard]] std::int32_t record(std::int32_t place) const {
    return place * (plan_.dimension == 2 ? kRecord<2> : kRecord<3>);
  }
  double forces(const System& s) {
    double overlap = 0;
    const auto remembered = static_cast<std::size_t>(passes_.remembered);
    const auto n = static_cast<std::int32_t>(s.beads.size());
    PairArgs p{};
    p.records = beads_.records(), p.spins = beads_.spins(), p.forces = beads_.forces();
    p.packets = 1, p.dt = s.dt, p.locate = plan_.locate, p.magic = magic_;
    for (std::int32_t i = 0; i < n; ++i)
      for (std::int32_t j = i + 1; j < n; ++j) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        const Vec3 apart = beads_.position(a) - beads_.position(b);
        double shift[3] = {0, 0, 0};
        for (int k = 0, c = 0; k < 3; ++k) {
          if (plan_.dimension == 2 && k == 1) continue;
          const double period = s.period[static_cast<std::size_t>(k)];
          shift[c++] = period > 0 ? -period * std::round(apart[k] / period) : 0;
        }
        auto& [memory, constants] = contacts_[{i, j}];
        if (constants.empty()) {
          const double ra = beads_.radius(a), rb = beads_.radius(b);
          constants = contact_constants(plan_.bead, beads_.pair(a, b), ra + rb, 1 / ra, 1 / rb);
        }
        memory.resize(remembered);
        const std::int32_t at_i = record(i), at_j = record(j);
        p.i = &at_i, p.j = &at_j, p.force_i = &at_i, p.force_j = &at_j;
        p.shift = s.period[0] > 0 || s.period[1] > 0 || s.period[2] > 0 ? shift : nullptr;
        p.constants = constants.data();
        p.memory = memory.data();
        overlap = std::max(overlap, passes_.pairs(p));
      }
    const double plate = s.plate_height();
    const double plate_velocity = plan_.key.velocity == Velocity::full_step
                                      ? (plate - s.plate_height_before()) / s.dt
                                      : s.plate_velocity();
    const int axis = static_cast<int>(s.drive.axis);
    for (std::size_t w = 0; w < s.walls.size(); ++w) {
      const Wall& wall = s.walls[w];
      WallArgs g{};
      g.records = p.records, g.spins = p.spins, g.forces = p.forces, g.packets = 1, g.dt = s.dt,
      g.locate = plan_.locate, g.magic = magic_;
      Vec3 v = Vec3::Zero();
      if (wall.moves) v[axis] = plate_velocity;
      g.n[0] = wall.n.x(), g.velocity[0] = v.x();
      if (plan_.dimension == 2) {
        g.n[1] = wall.n.z(), g.velocity[1] = v.z();
      } else {
        g.n[1] = wall.n.y(), g.velocity[1] = v.y(), g.n[2] = wall.n.z(), g.velocity[2] = v.z();
      }
      g.offset = wall.moves ? wall.offset + wall.n[axis] * plate : wall.offset;
      for (std::int32_t i = 0; i < n; ++i) {
        const auto a = static_cast<std::size_t>(i);
        auto& [memory, constants] = contacts_[{i, -1 - static_cast<std::int32_t>(w)}];
        if (constants.empty())
          constants = contact_constants(plan_.wall_laws[w], beads_.wall(a), beads_.radius(a),
                                        1 / beads_.radius(a), 0);
        memory.resize(remembered);
        const std::int32_t at = record(i);
        g.bead = &at, g.constants = constants.data(), g.memory = memory.data();
        overlap = std::max(overlap, passes_.walls(g));
      }
    }
    if (s.plate_drag > 0) {
      const Vec3 v = plate_velocity * Vec3::Unit(axis);
      beads_.add_plate_drag(s, v.x(), v.z(), 0, beads_.size());
    }
    return overlap;
  }

  Plan plan_;
  GuardLimits limits_;
  Passes passes_;
  PackedBeads beads_;
  double magic_;
  std::vector<std::int32_t> order_;
  Lines reference_;
  struct Contact {
    std::vector<double> memory, constants;
  };
  std::map<std::pair<std::int32_t, std::int32_t>, Contact> contacts_;
};

}  // namespace

std::unique_ptr<Kernel> make_all_pairs_kernel(const Plan& plan, const GuardLimits& limits) {
  return std::make_unique<AllPairsKernel>(plan, limits);
}

}  // namespace twincell::sim
