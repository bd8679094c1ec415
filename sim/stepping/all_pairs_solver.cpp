// The all-pairs solver: every pair and every wall at every step, without lists. With one contact at a time it
// is the oracle. With wide SIMD vectors it is the solver for a few beads, for which lists would take longer
// than contacts.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "sim/kernels/subnormals.hpp"
#include "sim/stepping/contact_memories.hpp"
#include "sim/stepping/list_solver.hpp"
#include "sim/stepping/packed_beads.hpp"
#include "sim/system/cell_grid.hpp"

namespace twincell::sim {

namespace {

using Size = std::size_t;

/// Contacts of one kind in packets: all pairs, or all beads with one wall.
struct Packets {
  Size count = 0;                                ///< contacts
  std::vector<std::int32_t> i, j;                ///< records, padded; no j at a wall
  std::vector<double> memory, constants, shift;  ///< [packet][number][lane]
  bool remembers = false;                        ///< some number of `memory` may be nonzero
};

class AllPairsSolver : public Solver {
 public:
  AllPairsSolver(const Plan& plan, const GuardLimits& limits, const Target& target)
      : plan_(plan),
        limits_(limits),
        kernels_(target.find(plan.key)),
        width_(static_cast<Size>(target.width)),
        memory_(static_cast<Size>(kernels_.remembered)),
        dimension_(static_cast<Size>(plan.dimension)),
        beads_(plan_),
        quantum_(rounding_constant(plan)) {}

  void advance(System& s, std::int64_t steps) override {
    if (s.beads.empty() || steps <= 0) {
      s.step += std::max<std::int64_t>(0, steps);
      return;
    }
    const FlushSubnormals flush;
    if (order_.size() != s.beads.size()) {
      order_.resize(s.beads.size());
      std::iota(order_.begin(), order_.end(), 0);
    }
    s.forces_known = s.forces_known && s.forces.size() == s.beads.size();
    const bool known = s.forces_known;
    if (!arranged_ || !beads_.agrees(s, order_)) {
      keep_memories();
      beads_.load(s, order_, 1);
      arrange(s);
    }
    IntegrateArgs args = beads_.integrate_args(s);
    // The deviation from free flight is not used here, but the kernel needs a reference.
    reference_.resize(static_cast<Size>(record(1)) / 2 * s.beads.size());
    args.reference = reference_.data();
    const BeadRange all{0, static_cast<std::int64_t>(s.beads.size())};
    args.runs = &all, args.n_runs = 1;
    if (!known) forces(s);
    for (std::int64_t k = 0; k < steps; ++k) {
      args.kicks = k == 0 ? 1 : 2;
      args.drift = true;
      kernels_.integrate(args);
      ++s.step;
      if (!(forces(s) <= limits_.overlap)) {
        beads_.store(s, order_);
        explain_overlap(s, limits_);
      }
    }
    args.kicks = 1;
    args.drift = false;
    kernels_.integrate(args);
    beads_.store(s, order_);
    check_motion(s, limits_);
  }
  [[nodiscard]] std::int64_t list_builds() const override { return 0; }
  void rebuild_every(std::int64_t) override {}
  [[nodiscard]] std::vector<ContactMemory> contacts() const override { return sorted_list(memories()); }
  void restore(std::vector<ContactMemory> contacts) override {
    keep_memories();
    add_list(kept_, std::move(contacts));
  }
  [[nodiscard]] std::string description() const override {
    return fmt::format("all pairs, {} {} at a time", width_, width_ == 1 ? "contact" : "contacts");
  }

 private:
  [[nodiscard]] std::int32_t record(Size place) const {
    return static_cast<std::int32_t>(place) * (plan_.dimension == 2 ? kRecord<2> : kRecord<3>);
  }
  /// Index of number m (of `numbers`) of contact k.
  [[nodiscard]] Size place(Size k, Size m, Size numbers) const {
    return (k / width_ * numbers + m) * width_ + k % width_;
  }
  [[nodiscard]] Packets packets(Size count, bool pairs) const {
    Packets p;
    p.count = count;
    const Size padded = (count + width_ - 1) / width_ * width_;
    p.i.assign(padded, record(beads_.size()));
    if (pairs) p.j = p.i;
    p.memory.assign(padded * memory_, 0);
    if (pairs) p.shift.assign(padded * dimension_, 0);
    return p;
  }
  void put(Packets& p, Size k, std::pair<std::int32_t, std::int32_t> key,
           const std::vector<double>& constants) {
    if (p.constants.empty()) p.constants.assign(p.i.size() * constants.size(), 1);
    for (Size m = 0; m < constants.size(); ++m) p.constants[place(k, m, constants.size())] = constants[m];
    const auto kept = kept_.find(key);
    if (kept == kept_.end()) return;
    for (Size m = 0; m < std::min(memory_, kept->second.size()); ++m)
      p.memory[place(k, m, memory_)] = kept->second[m];
    p.remembers = true;
  }
  void arrange(const System& s) {
    const Size n = beads_.size();
    pairs_ = packets(n * (n - 1) / 2, true);
    Size k = 0;
    for (Size i = 0; i < n; ++i)
      for (Size j = i + 1; j < n; ++j, ++k) {
        pairs_.i[k] = record(i), pairs_.j[k] = record(j);
        put(pairs_, k, {static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)},
            pair_constants(plan_, beads_, i, j));
      }
    walls_.assign(s.walls.size(), {});
    for (Size w = 0; w < s.walls.size(); ++w) {
      walls_[w] = packets(n, false);
      for (Size i = 0; i < n; ++i) {
        walls_[w].i[i] = record(i);
        put(walls_[w], i, {static_cast<std::int32_t>(i), -1 - static_cast<std::int32_t>(w)},
            wall_constants(plan_, beads_, w, i));
      }
    }
    kept_.clear();
    arranged_ = true;
  }
  /// Remembered numbers of all contacts with nonzero memory.
  [[nodiscard]] ContactMemories memories() const {
    ContactMemories all = kept_;
    const auto add = [&](const Packets& p, Size k, std::int32_t i, std::int32_t j) {
      std::vector<double> memory(memory_);
      for (Size m = 0; m < memory_; ++m) memory[m] = p.memory[place(k, m, memory_)];
      if (std::any_of(memory.begin(), memory.end(), [](double v) { return v != 0; }))
        all[{i, j}] = std::move(memory);
    };
    const std::int32_t per_bead = record(1);
    for (Size k = 0; k < pairs_.count; ++k) add(pairs_, k, pairs_.i[k] / per_bead, pairs_.j[k] / per_bead);
    for (Size w = 0; w < walls_.size(); ++w)
      for (Size k = 0; k < walls_[w].count; ++k)
        add(walls_[w], k, walls_[w].i[k] / per_bead, -1 - static_cast<std::int32_t>(w));
    return all;
  }
  void keep_memories() {
    kept_ = memories();
    pairs_ = {};
    walls_.clear();
    arranged_ = false;
  }

  /// Sets the shifts to the nearest periodic images.
  void shift(const System& s) {
    const double* r = beads_.records();
    for (Size c = 0; c < dimension_; ++c) {
      const double period = s.period[dimension_ == 2 && c == 1 ? 2 : c];
      if (period == 0) continue;
      for (Size k = 0; k < pairs_.count; ++k) {
        const double apart = r[static_cast<Size>(pairs_.i[k]) + c] - r[static_cast<Size>(pairs_.j[k]) + c];
        pairs_.shift[place(k, c, dimension_)] = nearest_shift(apart, period);
      }
    }
  }
  double forces(const System& s) {
    double overlap = 0;
    const bool periodic = s.period[0] > 0 || s.period[1] > 0 || s.period[2] > 0;
    if (periodic) shift(s);
    PairArgs p{};
    p.records = beads_.records(), p.spins = beads_.spins(), p.forces = beads_.forces();
    p.i = p.force_i = pairs_.i.data(), p.j = p.force_j = pairs_.j.data();
    p.shift = periodic ? pairs_.shift.data() : nullptr;
    p.constants = pairs_.constants.data(), p.constants_step = step_of(pairs_.constants, pairs_);
    p.memory = pairs_.memory.data();
    p.packets = packets_of(pairs_), p.dt = s.dt, p.locate = plan_.locate, p.quantum = quantum_;
    if (p.packets > 0) overlap = kernels_.pairs(p);
    const Vec3 plate = s.plate_displacement();
    for (Size w = 0; w < s.walls.size(); ++w) {
      const Wall& wall = s.walls[w];
      if (!walls_[w].remembers && is_far(s, wall)) continue;
      WallArgs g{};
      g.records = p.records, g.spins = p.spins, g.forces = p.forces, g.dt = s.dt, g.locate = plan_.locate,
      g.quantum = quantum_;
      const Vec3 v = wall.moves ? plate_velocity(s) : Vec3::Zero();
      g.n[0] = wall.n.x(), g.velocity[0] = v.x();
      if (plan_.dimension == 2) {
        g.n[1] = wall.n.z(), g.velocity[1] = v.z();
      } else {
        g.n[1] = wall.n.y(), g.velocity[1] = v.y(), g.n[2] = wall.n.z(), g.velocity[2] = v.z();
      }
      g.offset = wall.moves ? wall.offset + wall.n.dot(plate) : wall.offset;
      g.bead = walls_[w].i.data(), g.packets = packets_of(walls_[w]);
      g.constants = walls_[w].constants.data(), g.constants_step = step_of(walls_[w].constants, walls_[w]);
      g.memory = walls_[w].memory.data();
      overlap = std::max(overlap, kernels_.walls(g));
      walls_[w].remembers =
          std::any_of(walls_[w].memory.begin(), walls_[w].memory.end(), [](double m) { return m != 0; });
    }
    if (s.plate_drag > 0) {
      const Vec3 v = s.plate_velocity_in_space();
      beads_.add_plate_drag(s, v.x(), v.z(), quantum_, 0, beads_.size());
    }
    return overlap;
  }
  [[nodiscard]] Vec3 plate_velocity(const System& s) const {
    if (plan_.key.velocity == Velocity::full_step)
      return (s.plate_displacement() - s.plate_displacement_before()) / s.dt;
    return s.plate_velocity_in_space();
  }
  /// Whether no bead can touch a wall, for any position of the plate.
  [[nodiscard]] bool is_far(const System& s, const Wall& wall) const {
    if (wall.moves && !s.envelope.points.empty()) return false;
    const double swing = wall.moves ? std::abs(s.drive.displacement_bound()) : 0;
    for (Size i = 0; i < beads_.size(); ++i)
      if (!(wall.n.dot(beads_.position(i)) - wall.offset - beads_.radius(i) > swing)) return false;
    return true;
  }
  [[nodiscard]] std::int64_t packets_of(const Packets& p) const {
    return static_cast<std::int64_t>(p.i.size() / width_);
  }
  [[nodiscard]] std::ptrdiff_t step_of(const std::vector<double>& numbers, const Packets& p) const {
    return p.i.empty() ? 0 : static_cast<std::ptrdiff_t>(numbers.size() / (p.i.size() / width_));
  }

  Plan plan_;
  GuardLimits limits_;
  Kernels kernels_;
  Size width_, memory_, dimension_;
  PackedBeads beads_;
  double quantum_;
  std::vector<std::int32_t> order_;
  Lines reference_;
  Packets pairs_;
  std::vector<Packets> walls_;
  ContactMemories kept_;  ///< memory from before the last arrange()
  bool arranged_ = false;
};

}  // namespace

std::unique_ptr<Solver> make_all_pairs_solver(const Plan& plan, const GuardLimits& limits,
                                              const Target& target) {
  return std::make_unique<AllPairsSolver>(plan, limits, target);
}

}  // namespace twincell::sim
