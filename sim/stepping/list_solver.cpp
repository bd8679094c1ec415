#include "sim/stepping/list_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <barrier>
#include <cmath>
#include <exception>
#include <optional>
#include <thread>

#include "core/cancellation.hpp"
#include "sim/kernels/subnormals.hpp"
#include "sim/stepping/active_set.hpp"
#include "sim/stepping/inner_list.hpp"
#include "sim/stepping/listed_beads.hpp"
#include "sim/stepping/outer_list.hpp"
#include "sim/stepping/wall_lists.hpp"

namespace twincell::sim {

namespace {

using Size = std::size_t;

/// The beads of one thread and all their contacts. A pair that crosses two threads is computed by both, and
/// each adds the force to its own bead. No two threads therefore write to one place, and the bits are those
/// of a single thread.
struct Part {
  BeadShare share;
  OuterPairs outer;
  InnerPairs inner;
  WallContacts walls;
  ActiveSet active;
  bool active_stale = true;  ///< lists have been built since the active set was found
  double overlap = 0;
  Deviation deviation{};
  std::int64_t visits = 0, wall_visits = 0, moves = 0;  ///< packets, packets, beads
};

class ListSolver : public Solver {
 public:
  ListSolver(const Plan& plan, const GuardLimits& limits, const Target& target, int threads)
      : limits_(limits),
        target_(target),
        threads_(threads),
        quantum_(rounding_constant(plan)),
        beads_(plan, target) {}

  void advance(System& s, std::int64_t steps) override;
  [[nodiscard]] std::int64_t list_builds() const override { return outer_.builds(); }
  void rebuild_every(std::int64_t n) override { rebuild_every_ = n; }
  [[nodiscard]] std::vector<ContactMemory> contacts() const override;
  void restore(std::vector<ContactMemory> contacts) override { restored_ = std::move(contacts); }
  [[nodiscard]] std::string description() const override {
    return fmt::format("{}, {} contact{} at a time", target_.name, target_.width,
                       target_.width == 1 ? "" : "s");
  }
  [[nodiscard]] Counters counters() const override { return counters_; }
  [[nodiscard]] Footprint footprint() const override;

 private:
  // Preparation of a call.
  /// What the lists depend on besides the beads.
  struct Surroundings {
    double dt = 0, plate_drag = 0;
    Vec3 gravity = Vec3::Zero();
    std::array<double, 3> period{};
    std::vector<Wall> walls;
  };
  [[nodiscard]] bool is_as_left(const System& s, const PlateState& plate) const;
  void prepare(const System& s);
  void begin_lists(const System& s);
  void divide_among_threads(const System& s);
  // Lists.
  template <class Visit>
  void for_each_remembered(Visit visit) const;
  void build_outer(const System& s);
  void refresh_pairs(const System& s);
  [[nodiscard]] bool is_forced() const { return rebuild_every_ > 0 && calls_ % rebuild_every_ == 0; }
  void advance_inactive();
  // Forces and motion.
  void wall_forces(const System& s, Part& part);
  void pair_forces(const System& s, Part& part, Size begin, Size end);
  void forces(const System& s, Part& part);
  void forces_and_integrate(const System& s, Part& part);
  void integrate(Part& part, const BeadRange* runs, Size n, int kicks, bool drift);
  void integrate(Part& part, int kicks, bool drift);
  // One step.
  void add_up_motion(const System& s);
  void begin_step(System& s, bool last);
  enum class Then { nothing, next_step };
  void step(const System& s, Part& part, Then then);
  void check_overlap(System& s, bool drifted);
  void check_speed(System& s);
  // Drivers.
  void run_serial(System& s, std::int64_t steps);
  void run_parallel(System& s, std::int64_t steps);

  GuardLimits limits_;
  const Target& target_;
  int threads_;
  double quantum_;  ///< rounding constant of force sums

  ListedBeads beads_;
  OuterList outer_;
  InnerList inner_;
  WallLists walls_;
  std::vector<BeadShare> shares_;
  std::vector<Part> parts_;
  std::vector<ContactMemory> restored_;

  bool pairs_stale_ = false, walls_stale_ = false;  ///< lists to be built in this step
  double speed_bound_ = 0;                          ///< bound on speeds since the last inner list
  PlateState plate_;
  IntegrateArgs integrate_args_{};
  bool is_left_ = false;       ///< the last call ended without an error
  Surroundings surroundings_;  ///< at the last begin_lists()
  std::int64_t rebuild_every_ = 0, calls_ = 0;
  Counters counters_;
};

// --- preparation ---

/// Whether the system is as the last call left it, so that the lists go on. A run that is divided into short
/// calls, between which its velocities are only read, then builds no more lists than in one call.
bool ListSolver::is_as_left(const System& s, const PlateState& plate) const {
  if (!is_left_ || rebuild_every_ > 0 || !restored_.empty() || !(plate == plate_)) return false;
  const Surroundings& was = surroundings_;
  const auto is_same = [](const Wall& a, const Wall& b) {
    return a.n == b.n && a.offset == b.offset && a.moves == b.moves;
  };
  return s.dt == was.dt && s.plate_drag == was.plate_drag && s.gravity == was.gravity &&
         s.period == was.period &&
         std::equal(s.walls.begin(), s.walls.end(), was.walls.begin(), was.walls.end(), is_same) &&
         beads_.packed.agrees(s, beads_.order.bead);
}

void ListSolver::prepare(const System& s) {
  outer_.set_limits(s);
  if (beads_.order.bead.size() != s.beads.size()) divide_among_threads(s);
  if (!beads_.packed.agrees(s, beads_.order.bead)) beads_.packed.load(s, beads_.order.bead, parts_.size());
  beads_.set_shared_constants();
}

void ListSolver::divide_among_threads(const System& s) {
  restored_ = restored_.empty() ? contacts() : std::move(restored_);
  beads_.order = BeadOrder::by_cells(s.beads, 3 * outer_.usual_radius());
  const Size n = s.beads.size(), threads = static_cast<Size>(threads_for(n, threads_));
  shares_.assign(threads, {});
  parts_.assign(threads, {});
  for (Size p = 0; p < threads; ++p) {
    shares_[p] = {n * p / threads, n * (p + 1) / threads, static_cast<std::int32_t>(n + p)};
    parts_[p].share = shares_[p];
    parts_[p].walls.walls.resize(s.walls.size());
  }
  outer_.discard();
}

/// Calls visit(i, j, number) for every contact of the lists with a number that is not 0, with number(m) the
/// m-th of them.
template <class Visit>
void ListSolver::for_each_remembered(Visit visit) const {
  const PacketLayout& layout = beads_.layout;
  if (layout.memory == 0) return;
  const auto bead = [&](std::int32_t place) { return beads_.order.bead[static_cast<Size>(place)]; };
  const auto look_at = [&](const ContactPackets& p, Size at, std::int32_t i, std::int32_t j) {
    const double* numbers = p.memory.data() + layout.index(at, layout.memory, 0);
    if (layout.remembers(numbers, layout.width))
      visit(i, j, [&](Size m) { return numbers[m * layout.width]; });
  };
  for (const Part& part : parts_) {
    const ContactPackets& pairs = part.inner.packets;
    for (Size r = 0; r < pairs.source.size(); ++r) {
      if (pairs.source[r] < 0) continue;
      const Size from = static_cast<Size>(pairs.source[r]);
      const std::int32_t i = layout.place(part.outer.i[from]), j = layout.place(part.outer.j[from]);
      // Both threads store a pair that crosses them; only the owner of bead i reports it.
      if (part.share.owns(i)) look_at(pairs, r, bead(i), bead(j));
    }
    for (Size w = 0; w < part.walls.walls.size(); ++w) {
      const ContactPackets& wall = part.walls.walls[w];
      for (Size r = 0; r < wall.source.size(); ++r)
        look_at(wall, r, bead(wall.source[r]), -1 - static_cast<std::int32_t>(w));
    }
  }
}

std::vector<ContactMemory> ListSolver::contacts() const {
  std::vector<ContactMemory> all = restored_;
  for_each_remembered([&](std::int32_t i, std::int32_t j, const auto& number) {
    ContactMemory c{i, j, std::vector<double>(beads_.layout.memory)};
    for (Size m = 0; m < c.values.size(); ++m) c.values[m] = number(m);
    all.push_back(std::move(c));
  });
  std::sort(all.begin(), all.end(), [](const ContactMemory& a, const ContactMemory& b) {
    return a.i != b.i ? a.i < b.i : a.j < b.j;
  });
  return all;
}

Solver::Footprint ListSolver::footprint() const {
  Footprint f;
  f.beads = beads_.packed.bytes() + bytes_of(beads_.order.bead, beads_.order.place) + outer_.bytes() +
            inner_.bytes();
  for (const Part& part : parts_) {
    f.listed += part.outer.pairs;
    f.pairs += part.outer.bytes() + part.inner.bytes() + part.active.bytes();
    for (const ContactPackets& wall : part.walls.walls) {
      f.listed += wall.source.size();
      f.pairs += wall.bytes();
    }
  }
  return f;
}

// --- lists ---

void ListSolver::build_outer(const System& given) {
  Size listed = 0;
  for (const Part& part : parts_) listed += part.outer.pairs;
  outer_.adapt_skin(given.dimension, beads_.packed.size(), listed);
  std::optional<System> s = given;  // the search needs positions by bead
  beads_.packed.store(*s, beads_.order.bead);
  check_motion(*s, limits_);
  s->forces = {}, s->rim_speeds = {};
  const RememberedContacts remembered(s->beads.size(), beads_.layout.memory, [&](auto visit) {
    for (const ContactMemory& c : restored_) visit(c.i, c.j, [&](Size m) { return c.values[m]; });
    for_each_remembered(visit);
  });
  // The memory of a run is largest here, so what is no longer needed is released before the search. The
  // arrays of the outer lists are kept: the new lists are about as long, and pairs that are put into the
  // holes of old arrays would move them to new memory.
  restored_ = {};
  for (Part& part : parts_) part.inner.packets = {};
  const std::vector<NearPair> found = outer_.search(*s, beads_.order);
  s.reset();
  for (Part& part : parts_) {
    part.outer.assign(beads_, part.share, found, remembered, given.period);
    part.walls.restore(beads_, part.share, remembered);
  }
  outer_.set_reference(beads_.packed);
  walls_.discard();
}

/// Begins a new inner list, and builds the outer list if it is stale.
void ListSolver::refresh_pairs(const System& s) {
  inner_.measure_velocities(beads_, shares_);
  Size near = 0, listed = 0;
  for (const Part& part : parts_) near += part.inner.pairs, listed += part.outer.pairs;
  inner_.set_horizon(s.dt, outer_.skin(), 4 * near < listed);
  if (is_forced()) outer_.discard();
  if (outer_.is_stale(beads_.packed, inner_.margin())) {
    build_outer(s);
    inner_.limit_to(outer_.skin());
  }
  inner_.begin();
  outer_.count_inner_list();
  ++counters_.near_refreshes;
}

void ListSolver::advance_inactive() {
  for (Part& part : parts_)
    part.active.advance_inactive(beads_.kernels, beads_.packed.records(), integrate_args_.dt,
                                 integrate_args_.gravity);
}

// --- forces and motion ---

void ListSolver::pair_forces(const System& s, Part& part, Size begin, Size end) {
  ContactPackets& a = part.inner.packets;
  const PacketLayout& layout = beads_.layout;
  const Size lane = begin * layout.width;
  PairArgs p{};
  p.records = beads_.packed.records();
  p.spins = beads_.packed.spins();
  p.forces = beads_.packed.forces();
  p.i = a.i.data() + lane, p.j = a.j.data() + lane;
  p.force_i = parts_.size() > 1 ? a.force_i.data() + lane : p.i,
  p.force_j = parts_.size() > 1 ? a.force_j.data() + lane : p.j;
  p.memory = a.memory.data() + lane * layout.memory;
  if (beads_.packed.equal()) {
    p.constants = beads_.of_pairs.data();
  } else {
    p.constants_step = static_cast<std::ptrdiff_t>(a.constants.size()) / a.count;
    p.constants = a.constants.data() + p.constants_step * static_cast<std::ptrdiff_t>(begin);
  }
  p.shift = a.shift.empty() ? nullptr : a.shift.data() + lane * layout.dimension;
  p.packets = static_cast<std::int64_t>(end - begin);
  p.dt = s.dt;
  p.locate = beads_.plan.locate;
  p.quantum = quantum_;
  part.overlap = std::max(part.overlap, beads_.kernels.pairs(p));
  part.visits += p.packets;
}

/// Forces of walls, and plate drag.
void ListSolver::wall_forces(const System& s, Part& part) {
  part.overlap = 0;
  const bool equal = beads_.packed.equal();
  for (Size w = 0; w < part.walls.walls.size(); ++w) {
    ContactPackets& near = part.walls.walls[w];
    if (near.count == 0) continue;
    const Wall& wall = s.walls[w];
    WallArgs g{};
    g.records = beads_.packed.records(), g.spins = beads_.packed.spins(), g.forces = beads_.packed.forces();
    g.bead = near.i.data();
    g.memory = near.memory.data();
    g.constants = equal ? beads_.of_walls[w].data() : near.constants.data();
    g.constants_step = equal ? 0 : static_cast<std::ptrdiff_t>(near.constants.size()) / near.count;
    g.packets = near.count;
    Vec3 v = Vec3::Zero();
    if (wall.moves && beads_.plan.key.velocity == Velocity::full_step)
      v = (plate_.displacement - plate_.before) / s.dt;
    else if (wall.moves)
      v = plate_.velocity;
    if (s.dimension == 2) {
      g.n[0] = wall.n.x(), g.n[1] = wall.n.z();
      g.velocity[0] = v.x(), g.velocity[1] = v.z();
    } else {
      for (int k = 0; k < 3; ++k) g.n[k] = wall.n[k], g.velocity[k] = v[k];
    }
    g.offset = wall.moves ? wall.offset + wall.n.dot(plate_.displacement) : wall.offset;
    g.dt = s.dt;
    g.locate = beads_.plan.locate;
    g.quantum = quantum_;
    part.overlap = std::max(part.overlap, beads_.kernels.walls(g));
    part.wall_visits += near.count;
  }
  if (s.plate_drag > 0)
    beads_.packed.add_plate_drag(s, plate_.velocity.x(), plate_.velocity.z(), quantum_, part.share.begin,
                                 part.share.end);
}

void ListSolver::forces(const System& s, Part& part) {
  wall_forces(s, part);
  const Size packets = static_cast<Size>(part.inner.packets.count);
  if (packets > 0) pair_forces(s, part, 0, packets);
}

/// Computes all forces. The next step of a bead follows as soon as its contacts are complete, while its
/// record, force and neighbours are still in the first-level cache.
void ListSolver::forces_and_integrate(const System& s, Part& part) {
  wall_forces(s, part);
  part.deviation = {};
  Size packet = 0;
  for (Size c = 0; c < part.inner.chunks.size(); ++c) {
    const Chunk& chunk = part.inner.chunks[c];
    if (chunk.packet_end > packet) pair_forces(s, part, packet, chunk.packet_end);
    const ActiveSet::Runs active = part.active.in_chunk(c);
    if (active.count > 0) integrate(part, active.first, active.count, 2, true);
    packet = chunk.packet_end;
  }
  part.active.add_step();
  part.moves += part.active.size();
}

void ListSolver::integrate(Part& part, const BeadRange* runs, Size n, int kicks, bool drift) {
  IntegrateArgs a = integrate_args_;
  a.runs = runs;
  a.n_runs = static_cast<std::int64_t>(n);
  a.kicks = kicks;
  a.drift = drift;
  a.reference = inner_.reference();
  const double t = static_cast<double>(inner_.steps() + (kicks == 2 ? 1 : 0)) * a.dt;
  for (int k = 0; k < 3; ++k) a.fallen[k] = t * a.gravity[k];
  const Deviation own = beads_.kernels.integrate(a);
  for (int k = 0; k < 3; ++k) part.deviation.most[k] = std::max(part.deviation.most[k], own.most[k]);
}

void ListSolver::integrate(Part& part, int kicks, bool drift) {
  part.deviation = {};
  const BeadRange all = part.share.range();
  integrate(part, &all, 1, kicks, drift);
  part.moves += static_cast<std::int64_t>(part.share.size());
}

// --- one step ---

/// After a drift: updates the bounds on the approach of beads to each other and to walls, and decides which
/// lists must be refreshed.
void ListSolver::add_up_motion(const System& s) {
  double deviation[3] = {0, 0, 0};
  for (const Part& part : parts_)
    for (int k = 0; k < 3; ++k) deviation[k] = std::max(deviation[k], part.deviation.most[k]);
  const double strayed =
      std::sqrt(deviation[0] * deviation[0] + deviation[1] * deviation[1] + deviation[2] * deviation[2]);
  inner_.add_step(s.dt, strayed);
  if (rebuild_every_ > 0) ++calls_;
  const double added = strayed + static_cast<double>(inner_.steps()) * s.dt * s.gravity.norm();
  speed_bound_ = inner_.fastest() + added;
  plate_ = {s.plate_displacement(), s.plate_velocity_in_space(), plate_.displacement};
  walls_.add_step(s, plate_, inner_.range(), added);
  if (is_forced()) walls_.discard();
  pairs_stale_ = is_forced() || !inner_.is_valid(s.dt);
  walls_stale_ = walls_.any_stale();
}

/// The first half of a step, common to all threads: all beads have new positions; the lists are checked.
/// \param last no step follows in this call
void ListSolver::begin_step(System& s, bool last) {
  throw_if_cancelled();
  ++s.step;
  add_up_motion(s);
  if (pairs_stale_ || walls_stale_ || last) advance_inactive();
  if (pairs_stale_) {
    refresh_pairs(s);
    walls_stale_ = walls_.any_stale();  // all of them after a new outer list
  }
  if (walls_stale_) walls_.refresh(s, plate_, inner_.range(), outer_.skin());
  check_speed(s);
}

/// The second half, for the beads of one thread: builds its stale lists and computes the forces.
/// \param then whether beads make the first half of the next step as soon as their forces are complete, which
/// only a single thread can do
void ListSolver::step(const System& s, Part& part, Then then) {
  if (pairs_stale_)
    part.inner.build(beads_, part.share, part.outer, 2 * inner_.slack(), inner_.horizon(), parts_.size() > 1);
  if (walls_stale_) part.walls.build(s, beads_, part.share, walls_);
  if (then == Then::nothing) {
    part.active_stale = part.active_stale || pairs_stale_ || walls_stale_;
    return forces(s, part);
  }
  // Drag acts on all beads.
  if (pairs_stale_ || walls_stale_ || part.active_stale)
    part.active.find(beads_.layout, part.share, part.outer, part.inner, part.walls, s.plate_drag > 0);
  part.active_stale = false;
  forces_and_integrate(s, part);
}

/// Stops the run if an overlap exceeds the bound.
/// \param drifted the beads have already moved one step further; the drift is undone
/// for the report
void ListSolver::check_overlap(System& s, bool drifted) {
  double overlap = 0;
  for (const Part& part : parts_) overlap = std::max(overlap, part.overlap);
  if (overlap <= limits_.overlap) return;
  advance_inactive();
  if (drifted) beads_.packed.drift(-s.dt);
  beads_.packed.store(s, beads_.order.bead);
  explain_overlap(s, limits_);
}

void ListSolver::check_speed(System& s) {
  if (speed_bound_ * s.dt <= limits_.travel_per_step) return;
  advance_inactive();
  beads_.packed.store(s, beads_.order.bead);
  check_motion(s, limits_);
}

// --- drivers ---

void ListSolver::run_serial(System& s, std::int64_t steps) {
  Part& part = parts_[0];
  integrate(part, 1, true);
  for (std::int64_t k = 0; k < steps; ++k) {
    const bool last = k + 1 == steps;
    begin_step(s, last);
    step(s, part, last ? Then::nothing : Then::next_step);
    check_overlap(s, !last);
  }
  integrate(part, 1, false);
}

void ListSolver::run_parallel(System& s, std::int64_t steps) {
  // Two barriers per step: after the first the positions are new, after the second the forces are complete.
  // Work that one thread does for all is done in the completion function of the barrier.
  std::exception_ptr failure;
  bool moved = true;  // false: the forces are complete
  bool stop = false;
  const auto meet = [&]() noexcept {
    try {
      moved ? begin_step(s, false) : check_overlap(s, false);
      moved = !moved;
    } catch (...) {
      failure = std::current_exception();
      stop = true;
    }
  };
  std::barrier barrier(static_cast<std::ptrdiff_t>(parts_.size()), meet);
  const auto work = [&](Part& part) {
    const FlushSubnormals flush;
    for (std::int64_t k = 0; k < steps && !stop; ++k) {
      integrate(part, k == 0 ? 1 : 2, true);
      barrier.arrive_and_wait();
      if (!stop) step(s, part, Then::nothing);
      barrier.arrive_and_wait();
    }
    if (!stop) integrate(part, 1, false);
  };
  std::vector<std::thread> helpers;
  for (Size p = 1; p < parts_.size(); ++p) helpers.emplace_back([&, p] { work(parts_[p]); });
  work(parts_[0]);
  for (auto& t : helpers) t.join();
  if (failure) std::rethrow_exception(failure);
}

/// The caller may have changed the plate and the beads.
void ListSolver::begin_lists(const System& s) {
  surroundings_ = {s.dt, s.plate_drag, s.gravity, s.period, s.walls};
  outer_.distrust();
  walls_.reset(s.walls.size());
  inner_.reset(beads_.layout, s.beads.size());
  refresh_pairs(s);
  walls_.refresh(s, plate_, inner_.range(), outer_.skin());
  for (Part& part : parts_) {
    part.inner.build(beads_, part.share, part.outer, 2 * inner_.slack(), inner_.horizon(), parts_.size() > 1);
    part.walls.build(s, beads_, part.share, walls_);
    part.active_stale = true;
  }
}

void ListSolver::advance(System& s, std::int64_t steps) {
  if (s.beads.empty() || steps <= 0) {
    s.step += std::max<std::int64_t>(0, steps);
    return;
  }
  const FlushSubnormals flush;
  const bool known = s.forces_known && s.forces.size() == s.beads.size();
  s.forces_known = known;
  const PlateState plate = {s.plate_displacement(), s.plate_velocity_in_space(),
                            s.plate_displacement_before()};
  const bool goes_on = is_as_left(s, plate);
  is_left_ = false;
  if (!goes_on) {
    check_motion(s, limits_);
    prepare(s);
    integrate_args_ = beads_.packed.integrate_args(s);
    plate_ = plate;
    begin_lists(s);
  }
  if (!known) {
    for (Part& part : parts_) forces(s, part);
    check_overlap(s, false);
  }
  parts_.size() == 1 ? run_serial(s, steps) : run_parallel(s, steps);
  counters_.steps += steps;
  for (Part& part : parts_) {
    counters_.pair_visits += part.visits * target_.width;
    counters_.wall_visits += part.wall_visits * target_.width;
    counters_.bytes +=
        static_cast<double>(part.moves) * beads_.packed.bytes_per_step() +
        static_cast<double>(part.visits * target_.width) * bytes_per_contact(part.inner.packets);
    part.visits = part.wall_visits = part.moves = 0;
  }
  beads_.packed.store(s, beads_.order.bead);
  check_motion(s, limits_);
  is_left_ = true;
}

}  // namespace

std::unique_ptr<Solver> make_list_solver(const Plan& plan, const GuardLimits& limits, const Target& target,
                                         int threads) {
  return std::make_unique<ListSolver>(plan, limits, target, threads);
}

}  // namespace twincell::sim
