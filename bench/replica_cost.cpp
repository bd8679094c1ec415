// Beds that differ in the seed, one in each lane of the SIMD vectors, next to the list solver.
//
// usage: replica_cost WIDTH GAMMA
//
// The beds are those of Fortini & Huang 2015, N = 4 WIDTH^2, from a random start, after a period of the
// drive. Ten pieces of the next period are advanced by both, in turn. A pair of places is visited if it is
// near in any bed, so the cost depends on how alike the beds are:
//
// - "matched": at the start of each piece the beads of all beds are assigned to those of the first bed, with
//   the least sum of squared distances, outside the measured time;
// - "alike": all beds are the first one, so that no pair is visited for the sake of another bed.
//
// Prints one line: nanoseconds of processor time per bead and step, the ratios (list solver over replicas,
// sums over the pieces), the ratio without the time in which the replicas build their lists, visited pairs
// per bead and step, and whether every bed has the bits of the list solver.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/cpu_clock.hpp"
#include "core/error.hpp"
#include "sim/contact/contact.hpp"
#include "sim/kernels/simd_highway.hpp"
#include "sim/kernels/subnormals.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/starts.hpp"
#include "sim/start/start.hpp"
#include "sim/stepping/listed_beads.hpp"

namespace twincell::sim::HWY_NAMESPACE {
namespace {

using V = Pack;
using Size = std::size_t;
using Order = std::vector<std::int32_t>;  ///< the bead in each place
constexpr Size kLanes = Pack::kLanes;

/// The laws and the velocities of the first paper's beds with the default integrator.
using Laws = LawSet<LinearSpringDashpot, SpringSlider, NoRolling>;
constexpr Velocity kVelocity = Velocity::full_step;
constexpr int kMemory = kRemembered<Laws, kVelocity, 2>;

/// One number of each bed.
struct alignas(64) Numbers {
  double c[kLanes] = {};
  [[nodiscard]] HWY_INLINE V get() const { return V(hn::Load(All(), c)); }
  HWY_INLINE void set(V v) { hn::Store(v.raw, All(), c); }
};
struct BeadNumbers {
  Numbers x, z, vx, vz, spin, fx, fz, q;
};
using Memory = std::array<Numbers, kMemory>;

bool remembers(const Memory& memory) {
  return std::any_of(memory.begin(), memory.end(),
                     [](const Numbers& m) { return any(abs(m.get()) > V(0.0)); });
}

/// A copy of each bed at one instant.
struct Beds {
  std::vector<System> systems;
  std::vector<std::vector<ContactMemory>> contacts;
};

/// The solver of beds in lanes: an outer list of the pairs that are near in any bed, and an inner list of
/// those that may touch within the next kHorizon steps. Unlike the list solver, it does not check that the
/// inner list holds for so long; the comparison of the bits does.
class Replicas {
 public:
  Replicas(const Plan& plan, const Beds& beds, const std::vector<Order>& orders);
  /// \param clock a bed, of which the drive and the walls are used and the step is advanced
  void advance(System& clock, std::int64_t steps);
  [[nodiscard]] bool agrees(const System& s, Size lane, const Order& order) const;
  [[nodiscard]] double list_seconds() const { return list_seconds_; }
  [[nodiscard]] double visits() const { return visits_; }

 private:
  static constexpr double kSkin = 0.25, kSlack = 0.02;
  static constexpr std::int64_t kHorizon = 32;
  struct Pair {
    Size i, j;
  };
  struct NearPair {
    Size j, pair;
  };
  void build_outer();
  void refresh(const System& s);
  HWY_NOINLINE void pair_forces(const System& s);
  HWY_NOINLINE void wall_forces(const System& s, const Vec3& before);
  template <int kKicks, bool kDrift>
  HWY_NOINLINE void integrate(const System& s);

  const Plan& plan_;
  std::vector<BeadNumbers> beads_, listed_;
  std::vector<double> of_pairs_;
  std::vector<std::vector<double>> of_walls_;
  double quantum_, inv_mass_, turn_;
  std::vector<Pair> outer_;
  std::vector<Memory> memory_;
  std::vector<NearPair> near_;
  std::vector<Size> first_;  ///< of each bead's pairs in near_
  std::vector<std::vector<Memory>> wall_memory_;
  std::vector<std::vector<Size>> near_walls_;
  double list_seconds_ = 0, visits_ = 0;
};

Replicas::Replicas(const Plan& plan, const Beds& beds, const std::vector<Order>& orders)
    : plan_(plan), quantum_(rounding_constant(plan)) {
  const System& first = beds.systems[0];
  const Size n = first.beads.size();
  beads_.resize(n);
  near_walls_.resize(first.walls.size());
  wall_memory_.assign(first.walls.size(), std::vector<Memory>(n));
  PackedBeads packed(plan);
  std::map<std::pair<Size, Size>, Memory> remembered;
  for (Size lane = 0; lane < kLanes; ++lane) {
    packed.load(beds.systems[lane], orders[lane], 0);
    Order place(n);
    for (Size k = 0; k < n; ++k) {
      place[static_cast<Size>(orders[lane][k])] = static_cast<std::int32_t>(k);
      const double *r = packed.records() + 4 * k, *f = packed.forces() + 4 * k;
      BeadNumbers& b = beads_[k];
      b.x.c[lane] = r[0], b.z.c[lane] = r[1], b.vx.c[lane] = r[2], b.vz.c[lane] = r[3];
      b.fx.c[lane] = f[0], b.fz.c[lane] = f[1], b.q.c[lane] = f[2];
      b.spin.c[lane] = packed.spins()[k];
    }
    for (const ContactMemory& c : beds.contacts[lane]) {
      const auto i = static_cast<Size>(place[static_cast<Size>(c.i)]);
      const auto j = c.j < 0 ? 0 : static_cast<Size>(place[static_cast<Size>(c.j)]);
      Memory& m = c.j < 0 ? wall_memory_[static_cast<Size>(-1 - c.j)][i] : remembered[std::minmax(i, j)];
      for (Size k = 0; k < m.size(); ++k) m[k].c[lane] = c.values[k];
    }
  }
  of_pairs_ = pair_constants(plan, packed, 0, 0);
  for (Size w = 0; w < first.walls.size(); ++w) of_walls_.push_back(wall_constants(plan, packed, w, 0));
  const IntegrateArgs args = packed.integrate_args(first);
  inv_mass_ = args.inv_mass[2], turn_ = args.turn[0];
  for (const auto& [pair, memory] : remembered) {
    outer_.push_back({pair.first, pair.second});
    memory_.push_back(memory);
  }
  build_outer();
}

void Replicas::build_outer() {
  std::map<std::pair<Size, Size>, Memory> remembered;
  for (Size k = 0; k < outer_.size(); ++k)
    if (remembers(memory_[k])) remembered[{outer_[k].i, outer_[k].j}] = memory_[k];
  outer_.clear();
  memory_.clear();
  const double reach = of_pairs_[constant::kReach] + kSkin;
  for (Size i = 0; i < beads_.size(); ++i)
    for (Size j = i + 1; j < beads_.size(); ++j) {
      const V dx = beads_[i].x.get() - beads_[j].x.get(), dz = beads_[i].z.get() - beads_[j].z.get();
      const auto was = remembered.find({i, j});
      if (was == remembered.end() && !any(fma(dx, dx, dz * dz) < V(reach * reach))) continue;
      outer_.push_back({i, j});
      memory_.push_back(was == remembered.end() ? Memory{} : was->second);
    }
  listed_ = beads_;
}

void Replicas::refresh(const System& s) {
  const double t = static_cast<double>(kHorizon) * s.dt;
  // The beads of each bed may have moved together: only the motion relative to its mean counts.
  const auto largest = [&](auto component, auto since) HWY_ATTR {
    V sum(0.0), most(0.0);
    const auto moved = [&](Size b, Numbers BeadNumbers::*c) HWY_ATTR {
      return since ? (beads_[b].*c).get() - (listed_[b].*c).get() : (beads_[b].*c).get();
    };
    for (Size b = 0; b < beads_.size(); ++b) sum = sum + moved(b, component);
    const V mean = sum / V(static_cast<double>(beads_.size()));
    for (Size b = 0; b < beads_.size(); ++b) most = max(abs(moved(b, component) - mean), most);
    return HighwayLanes::largest(most);
  };
  const double way = std::hypot(largest(&BeadNumbers::x, true), largest(&BeadNumbers::z, true)) +
                     t * std::hypot(largest(&BeadNumbers::vx, false), largest(&BeadNumbers::vz, false));
  if (2 * (way + kSlack) > kSkin) build_outer();
  near_.clear();
  first_.assign(beads_.size() + 1, 0);
  const V reach(of_pairs_[constant::kReach] + kSlack), time(t);
  Size k = 0;
  for (Size i = 0; i < beads_.size(); ++i) {
    const BeadNumbers& a = beads_[i];
    for (; k < outer_.size() && outer_[k].i == i; ++k) {
      const BeadNumbers& b = beads_[outer_[k].j];
      const V dx = a.x.get() - b.x.get(), dz = a.z.get() - b.z.get();
      const V closing = fma(dx, a.vx.get() - b.vx.get(), dz * (a.vz.get() - b.vz.get()));
      const V r2 = fma(dx, dx, dz * dz), r = sqrt(r2);
      if (any(fma(time, min(closing, V(0.0)), r2) < r * reach) || remembers(memory_[k]))
        near_.push_back({outer_[k].j, k});
    }
    first_[i + 1] = near_.size();
  }
  for (Size w = 0; w < s.walls.size(); ++w) {
    near_walls_[w].clear();
    const Wall& wall = s.walls[w];
    const V nx(wall.n.x()), nz(wall.n.z()), offset(offset_now(s, wall));
    const double margin = (wall.moves ? s.drive.velocity_bound() * t : 0) + kSlack;
    for (Size b = 0; b < beads_.size(); ++b) {
      const BeadNumbers& a = beads_[b];
      const V height = fma(a.x.get(), nx, a.z.get() * nz) - offset;
      const V speed = fma(a.vx.get(), nx, a.vz.get() * nz);
      if (any(fma(time, min(speed, V(0.0)), height) < V(of_walls_[w][constant::kReach] + margin)) ||
          remembers(wall_memory_[w][b]))
        near_walls_[w].push_back(b);
    }
  }
}

/// The pairs of a bead follow each other, so its numbers and the sum of its forces stay in registers.
void Replicas::pair_forces(const System& s) {
  const V dt(s.dt), quantum(quantum_);
  V c[Layout<Laws>::kCount];
  for (int m = 0; m < Layout<Laws>::kCount; ++m) c[m] = V(of_pairs_[static_cast<Size>(m)]);
  for (Size i = 0; i < beads_.size(); ++i) {
    if (first_[i] == first_[i + 1]) continue;
    BeadNumbers& own = beads_[i];
    const V x = own.x.get(), z = own.z.get(), vx = own.vx.get(), vz = own.vz.get(), spin = own.spin.get();
    V fx = own.fx.get(), fz = own.fz.get(), q = own.q.get();
    for (Size k = first_[i]; k < first_[i + 1]; ++k) {
      BeadNumbers& other = beads_[near_[k].j];
      Memory& kept = memory_[near_[k].pair];
      const V d[2] = {x - other.x.get(), z - other.z.get()};
      const V r2 = fma(d[1], d[1], d[0] * d[0]);
      if (!any(either(r2<c[constant::kEdge], abs(kept[Laws::kMemory<2>].get())> V(0.0)))) {
        for (Numbers& m : kept) m.set(V(0.0));
        continue;
      }
      const V inv_r = inverse_sqrt_near_one(r2 * c[constant::kInvReachSquared]) * c[constant::kInvReach];
      ContactKinematics<V, 2> a;
      a.overlap = nfma(r2, inv_r, c[constant::kReach]);
      a.n[0] = d[0] * inv_r, a.n[1] = d[1] * inv_r;
      a.v[0] = vx - other.vx.get(), a.v[1] = vz - other.vz.get();
      a.s[0] = spin + other.spin.get();
      V memory[kMemory];
      for (Size m = 0; m < kept.size(); ++m) memory[m] = kept[m].get();
      const ContactLoad<V, 2> load = act<Laws, kVelocity, V, 2>(a, c, dt, plan_.locate, memory);
      for (Size m = 0; m < kept.size(); ++m) kept[m].set(memory[m]);
      const V f[3] = {rounded(load.f[0], quantum), rounded(load.f[1], quantum), rounded(load.q[0], quantum)};
      fx = fx + f[0], fz = fz + f[1], q = q + f[2];
      other.fx.set(other.fx.get() - f[0]);
      other.fz.set(other.fz.get() - f[1]);
      other.q.set(other.q.get() + f[2]);
    }
    own.fx.set(fx), own.fz.set(fz), own.q.set(q);
  }
  visits_ += static_cast<double>(near_.size() * kLanes);
}

void Replicas::wall_forces(const System& s, const Vec3& before) {
  const V dt(s.dt), quantum(quantum_);
  for (Size w = 0; w < s.walls.size(); ++w) {
    const Wall& wall = s.walls[w];
    V c[Layout<Laws>::kCount];
    for (int m = 0; m < Layout<Laws>::kCount; ++m) c[m] = V(of_walls_[w][static_cast<Size>(m)]);
    const Vec3 v = wall.moves ? Vec3((s.plate_displacement() - before) / s.dt) : Vec3::Zero();
    const V nx(wall.n.x()), nz(wall.n.z()), offset(offset_now(s, wall)), wall_vx(v.x()), wall_vz(v.z());
    for (const Size b : near_walls_[w]) {
      BeadNumbers& own = beads_[b];
      ContactKinematics<V, 2> a;
      a.overlap = c[constant::kReach] - fma(own.z.get(), nz, fma(own.x.get(), nx, -offset));
      a.n[0] = nx, a.n[1] = nz;
      a.v[0] = own.vx.get() - wall_vx, a.v[1] = own.vz.get() - wall_vz;
      a.s[0] = own.spin.get();
      Memory& kept = wall_memory_[w][b];
      V memory[kMemory];
      for (Size m = 0; m < kept.size(); ++m) memory[m] = kept[m].get();
      const ContactLoad<V, 2> load = act<Laws, kVelocity, V, 2>(a, c, dt, plan_.locate, memory);
      for (Size m = 0; m < kept.size(); ++m) kept[m].set(memory[m]);
      own.fx.set(own.fx.get() + rounded(load.f[0], quantum));
      own.fz.set(own.fz.get() + rounded(load.f[1], quantum));
      own.q.set(own.q.get() + rounded(load.q[0], quantum));
    }
  }
}

template <int kKicks, bool kDrift>
void Replicas::integrate(const System& s) {
  const V half(s.dt / 2), dt(s.dt), gx(s.gravity.x()), gz(s.gravity.z()), inv_mass(inv_mass_),
      turn(-(s.dt / 2) * turn_);
  for (BeadNumbers& b : beads_) {
    const V ax = fma(b.fx.get(), inv_mass, gx), az = fma(b.fz.get(), inv_mass, gz), kick = turn * b.q.get();
    V vx = b.vx.get(), vz = b.vz.get(), spin = b.spin.get();
    for (int k = 0; k < kKicks; ++k) vx = fma(half, ax, vx), vz = fma(half, az, vz), spin = spin + kick;
    b.vx.set(vx), b.vz.set(vz), b.spin.set(spin);
    if constexpr (kDrift) {
      b.x.set(fma(vx, dt, b.x.get())), b.z.set(fma(vz, dt, b.z.get()));
      b.fx.set(V(0.0)), b.fz.set(V(0.0)), b.q.set(V(0.0));
    }
  }
}

void Replicas::advance(System& clock, std::int64_t steps) {
  const FlushSubnormals flush;
  for (std::int64_t k = 0; k < steps; ++k) {
    k == 0 ? integrate<1, true>(clock) : integrate<2, true>(clock);
    const Vec3 before = clock.plate_displacement();
    ++clock.step;
    if (k % kHorizon == 0) {
      const double begin = thread_cpu_seconds();
      refresh(clock);
      list_seconds_ += thread_cpu_seconds() - begin;
    }
    wall_forces(clock, before);
    pair_forces(clock);
  }
  integrate<1, false>(clock);
}

bool Replicas::agrees(const System& s, Size lane, const Order& order) const {
  for (Size k = 0; k < beads_.size(); ++k) {
    const Bead& b = s.beads[static_cast<Size>(order[k])];
    const BeadNumbers& own = beads_[k];
    if (b.x != own.x.c[lane] || b.z != own.z.c[lane] || b.vx != own.vx.c[lane] || b.vz != own.vz.c[lane])
      return false;
  }
  return true;
}

/// The beads of `of` that take the places of the beads of `model`: the Hungarian method, with distances cut
/// off at a diameter.
Order matched(const std::vector<Bead>& model, const Order& order, const std::vector<Bead>& of) {
  const Size n = model.size();
  std::vector<double> row(n + 1), column(n + 1);
  std::vector<Size> taken(n + 1), way(n + 1);  // row of each column; 0: none
  const auto cost = [&](Size i, Size j) {
    const Bead& a = model[static_cast<Size>(order[i - 1])];
    const double dx = a.x - of[j - 1].x, dz = a.z - of[j - 1].z;
    return std::min(dx * dx + dz * dz, 1 + 0.01 * (dx * dx + dz * dz));
  };
  for (Size i = 1; i <= n; ++i) {
    std::vector<double> least(n + 1, HUGE_VAL);
    std::vector<bool> used(n + 1);
    taken[0] = i;
    Size at = 0;
    do {
      used[at] = true;
      Size next = 0;
      double step = HUGE_VAL;
      for (Size j = 1; j <= n; ++j) {
        if (used[j]) continue;
        const double reduced = cost(taken[at], j) - row[taken[at]] - column[j];
        if (reduced < least[j]) least[j] = reduced, way[j] = at;
        if (least[j] < step) step = least[j], next = j;
      }
      for (Size j = 0; j <= n; ++j) {
        if (used[j])
          row[taken[j]] += step, column[j] -= step;
        else
          least[j] -= step;
      }
      at = next;
    } while (taken[at] != 0);
    for (; at != 0; at = way[at]) taken[at] = taken[way[at]];
  }
  Order found(n);
  for (Size j = 1; j <= n; ++j) found[taken[j] - 1] = static_cast<std::int32_t>(j - 1);
  return found;
}

/// What one way to fill the lanes costs, summed over the pieces.
struct Cost {
  double seconds = 0, list_seconds = 0, visits = 0;
  bool same_bits = true;

  void add(const Plan& plan, const Beds& beds, const std::vector<Order>& orders,
           const std::vector<const System*>& truth, std::int64_t steps) {
    Replicas replicas(plan, beds, orders);
    System clock = beds.systems[0];
    const double begin = thread_cpu_seconds();
    replicas.advance(clock, steps);
    seconds += thread_cpu_seconds() - begin;
    list_seconds += replicas.list_seconds();
    visits += replicas.visits();
    for (Size lane = 0; lane < kLanes; ++lane)
      same_bits = same_bits && replicas.agrees(*truth[lane], lane, orders[lane]);
  }
};

void run(int width, double gamma) {
  const std::string text = fmt::format(
      "preset = \"fortini-huang-2015\"\n[beads]\ncount = {}\n[cell]\nwidth = {}\n[drive]\ngamma = {}\n"
      "[start]\nkind = \"random\"\n",
      4 * width * width, width, gamma);
  const Plan plan = make_plan(read_scene_text(text, "bed"));
  constexpr std::int64_t kPieces = 10, kOfEach = 4;  // a fourth of each tenth of a period is measured
  const std::int64_t steps = plan.steps_per_period / (kPieces * kOfEach);
  Beds now;
  std::vector<std::unique_ptr<Solver>> solvers;
  for (Size lane = 0; lane < kLanes; ++lane) {
    const Scene scene = read_scene_text(text, "bed", {fmt::format("start.seed={}", 1 + lane)});
    now.systems.push_back(make_system(scene, plan));
    now.systems.back().beads = make_start(scene).beads;
    solvers.push_back(make_solver(plan, {.overlap = kOverlapBound, .travel_per_step = kTravelBound}));
    solvers.back()->advance(now.systems.back(), plan.steps_per_period);
  }
  const auto list_visits = [&] {
    double sum = 0;
    for (const auto& solver : solvers) sum += static_cast<double>(solver->counters().pair_visits);
    return sum;
  };
  Cost of_matched, of_alike;
  double seconds = 0, visits = 0;
  for (std::int64_t piece = 0; piece < kPieces; ++piece) {
    now.contacts.clear();
    for (const auto& solver : solvers) now.contacts.push_back(solver->contacts());
    const Beds begun = now;
    visits -= list_visits();
    const double begin = thread_cpu_seconds();
    for (Size lane = 0; lane < kLanes; ++lane) solvers[lane]->advance(now.systems[lane], steps);
    seconds += thread_cpu_seconds() - begin;
    visits += list_visits();

    std::vector<Order> orders = {BeadOrder::by_cells(begun.systems[0].beads, 1.5).bead};
    std::vector<const System*> truth;
    for (Size lane = 0; lane < kLanes; ++lane) {
      truth.push_back(&now.systems[lane]);
      if (lane > 0) orders.push_back(matched(begun.systems[0].beads, orders[0], begun.systems[lane].beads));
    }
    of_matched.add(plan, begun, orders, truth, steps);
    of_alike.add(plan,
                 {std::vector<System>(kLanes, begun.systems[0]),
                  std::vector<std::vector<ContactMemory>>(kLanes, begun.contacts[0])},
                 std::vector<Order>(kLanes, orders[0]), std::vector<const System*>(kLanes, truth[0]), steps);
    for (Size lane = 0; lane < kLanes; ++lane)
      solvers[lane]->advance(now.systems[lane], plan.steps_per_period / kPieces - steps);
  }
  const Size n = now.systems[0].beads.size();
  const double work = static_cast<double>(kPieces * steps) * static_cast<double>(n * kLanes);
  fmt::print(
      "{{\"beads\": {}, \"gamma\": {}, \"list_ns\": {:.3g}, \"matched_ns\": {:.3g}, \"alike_ns\": {:.3g}, "
      "\"ratio_matched\": {:.2f}, \"ratio_matched_without_lists\": {:.2f}, \"ratio_alike\": {:.2f}, "
      "\"list_visits\": {:.2f}, \"matched_visits\": {:.2f}, \"alike_visits\": {:.2f}, \"same_bits\": {}}}\n",
      n, gamma, 1e9 * seconds / work, 1e9 * of_matched.seconds / work, 1e9 * of_alike.seconds / work,
      seconds / of_matched.seconds, seconds / (of_matched.seconds - of_matched.list_seconds),
      seconds / of_alike.seconds, visits / work, of_matched.visits / work, of_alike.visits / work,
      of_matched.same_bits && of_alike.same_bits);
}

}  // namespace
}  // namespace twincell::sim::HWY_NAMESPACE

int main(int argc, char** argv) {
  using namespace twincell;
  if (argc != 3) {
    std::fputs("usage: replica_cost WIDTH GAMMA\n", stderr);
    return 2;
  }
  if (!sim::available(sim::SolverKind::avx512)) {
    std::fputs("replica_cost: this processor has no AVX-512.\n", stderr);
    return 2;
  }
  try {
    sim::HWY_NAMESPACE::run(std::stoi(argv[1]), std::stod(argv[2]));
    return 0;
  } catch (const Error& e) {
    std::fprintf(stderr, "replica_cost: %s\n", e.what());
    return static_cast<int>(e.exit_code());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "replica_cost: %s\n", e.what());
    return 1;
  }
}
