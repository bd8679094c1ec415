#pragma once
/// \file
/// Implementation of the kernels for any kind of lanes. A Lanes class (simd_scalar.hpp, simd_highway.hpp)
/// provides a type V of several numbers with the operations of laws/scalar_arithmetic.hpp, a Row of four
/// numbers, and the transfers between the records of beads and V.

#include <array>
#include <cmath>
#include <type_traits>
#include <utility>
#include <variant>

#include "sim/contact/contact.hpp"
#include "sim/kernels/kernels.hpp"

#ifndef TWINCELL_LANES
#define TWINCELL_LANES  ///< attribute by which a lambda is compiled for the instruction set of the lanes
#endif

namespace twincell::sim {

/// Contacts of listed pairs. A contact is one long chain of dependent operations. A processor hides the
/// latency by starting the next contacts, if these are within its window of some hundred instructions. A few
/// packets at a time therefore pass through three short stages: gather the relative motion of the two beads,
/// compute the contacts, scatter the forces. (Tried and dropped: all in one loop, a third slower; two packets
/// in parallel in one loop, slower still for lack of registers.)
template <class Lanes, class Laws, int D, Velocity kVelocity>
double pair_kernel(const PairArgs& args) {
  const PairArgs p = args;  // a copy that no store can alias
  using V = typename Lanes::V;
  constexpr int K = kTurns<D>, kCount = Layout<Laws>::kCount, W = Lanes::kWidth;
  constexpr int kMemory = kRemembered<Laws, kVelocity, D>;
  constexpr bool kTurn = Laws::Tangential::kActs, kRoll = Laws::Rolling::kActs;
  // Numbers of a contact between the stages: its kinematics, then its load in the same place.
  constexpr int kRollAt = 2 * D, kKept = std::max(kRollAt + (kRoll ? K : 0), D + (kRoll ? 2 : 1) * K);
  constexpr int kStage = W == 1 ? 1 : 16;  // packets
  alignas(64) double stage[kStage * W * kKept];
  // Packets that may have a contact. The constants are kept as a pointer: the compiler would otherwise
  // address each of them by base and index, which processors split in two.
  struct Live {
    std::int64_t packet;
    const double* constants;
  } live[kStage];
  // With one packet at a time this is 0 to the compiler, which then keeps the numbers in registers.
  const auto place = [](int n) TWINCELL_LANES { return kStage == 1 ? 0 : n; };
  if constexpr (kStage == 1)  // the compiler does not see that they are written before they are read
    for (double& number : stage) number = 0;
  const V dt(p.dt), quantum(p.quantum);
  V largest(0.0);
  for (std::int64_t begin = 0; begin < p.packets; begin += kStage) {
    const std::int64_t end = begin + kStage < p.packets ? begin + kStage : p.packets;
    int n = 0;
    // Gather: collect the relative motion and skip packets without a contact.
    for (std::int64_t k = begin; k < end; ++k) {
      const std::int32_t *i = p.i + W * k, *j = p.j + W * k;
      V d[D], v[D];
      Lanes::template difference<D>(p.records, i, j, d, v);
      if (p.shift != nullptr)
        for (int c = 0; c < D; ++c) d[c] = d[c] + Lanes::load(p.shift + W * (D * k + c));
      const double* constants = p.constants + p.constants_step * k;
      V r2 = d[0] * d[0];
      for (int c = 1; c < D; ++c) r2 = fma(d[c], d[c], r2);
      double* kept = p.memory + W * kMemory * k;
      // A pair that separated within this step still has to update its remembered numbers.
      auto of_interest = r2 < Lanes::load(constants + W * constant::kEdge);
      if constexpr (kVelocity == Velocity::full_step)
        of_interest = either(of_interest, abs(Lanes::load(kept + W * Laws::template kMemory<D>)) > V(0.0));
      if (!any(of_interest)) {
        for (int m = 0; m < kMemory; ++m) Lanes::store(V(0.0), kept + W * m);
        continue;
      }
      double* to = stage + W * kKept * place(n);
      for (int c = 0; c < D; ++c) {
        Lanes::store(d[c], to + W * c);
        Lanes::store(v[c], to + W * (D + c));
      }
      if constexpr (kRoll) {
        V s_i[K], s_j[K];
        Lanes::template spins<D>(p.spins, i, s_i);
        Lanes::template spins<D>(p.spins, j, s_j);
        for (int m = 0; m < K; ++m)  // antisymmetric under i <-> j
          Lanes::store(s_i[m] * Lanes::load(constants + W * constant::kInvRadiusI) -
                           s_j[m] * Lanes::load(constants + W * constant::kInvRadiusJ),
                       to + W * (kRollAt + m));
      }
      live[place(n++)] = {k, constants};
    }
    // Compute: evaluate the laws for the packets that may have a contact.
    for (int at = 0; at < n; ++at) {
      double* numbers = stage + W * kKept * place(at);
      const auto [k, constants] = live[place(at)];
      double* kept = p.memory + W * kMemory * k;
      V c[kCount], d[D];
      for (int m = 0; m < kCount; ++m) c[m] = Lanes::load(constants + W * m);
      ContactKinematics<V, D> a;
      for (int m = 0; m < D; ++m) {
        d[m] = Lanes::load(numbers + W * m);
        a.v[m] = Lanes::load(numbers + W * (D + m));
      }
      V r2 = d[0] * d[0];
      for (int m = 1; m < D; ++m) r2 = fma(d[m], d[m], r2);
      const V inv_r = inverse_sqrt_near_one(r2 * c[constant::kInvReachSquared]) * c[constant::kInvReach];
      a.overlap = nfma(r2, inv_r, c[constant::kReach]);
      largest = max(a.overlap, largest);  // max(NaN, x) is x: dummies do not count
      for (int m = 0; m < D; ++m) a.n[m] = d[m] * inv_r;
      if constexpr (kTurn) Lanes::template spin_sums<D>(p.spins, p.i + W * k, p.j + W * k, a.s);
      if constexpr (kRoll)
        for (int m = 0; m < K; ++m) a.w[m] = Lanes::load(numbers + W * (kRollAt + m));
      V memory[kMemory + 1];
      for (int m = 0; m < kMemory; ++m) memory[m] = Lanes::load(kept + W * m);
      const ContactLoad<V, D> act_on = act<Laws, kVelocity, V, D>(a, c, dt, p.locate, memory);
      for (int m = 0; m < kMemory; ++m) Lanes::store(memory[m], kept + W * m);
      for (int m = 0; m < D; ++m) Lanes::store(act_on.f[m], numbers + W * m);
      for (int m = 0; m < K; ++m) {
        if constexpr (kTurn && !kRoll) Lanes::store(act_on.q[m], numbers + W * (D + m));
        if constexpr (kRoll) {
          Lanes::store(act_on.q[m] + act_on.q_i[m], numbers + W * (D + m));
          Lanes::store(act_on.q[m] + act_on.q_j[m], numbers + W * (D + K + m));
        }
      }
    }
    // Scatter: add the rounded forces to the beads.
    for (int at = 0; at < n; ++at) {
      const std::int64_t k = live[place(at)].packet;
      const double* numbers = stage + W * kKept * place(at);
      const auto share = [&](int m) TWINCELL_LANES { return rounded(Lanes::load(numbers + W * m), quantum); };
      V f[D], q_i[K], q_j[K];
      for (int m = 0; m < D; ++m) f[m] = share(m);
      for (int m = 0; m < K; ++m) {
        q_i[m] = q_j[m] = V(0.0);
        if constexpr (kTurn) q_i[m] = q_j[m] = share(D + m);
        if constexpr (kRoll) q_j[m] = share(D + K + m);
      }
      Lanes::template add<D, kTurn, kRoll>(p.forces, p.force_i + W * k, p.force_j + W * k, f, q_i, q_j);
    }
  }
  return Lanes::largest(largest);
}

/// Contacts of listed beads with one wall.
template <class Lanes, class Laws, int D, Velocity kVelocity>
double wall_kernel(const WallArgs& args) {
  const WallArgs p = args;
  using V = typename Lanes::V;
  constexpr int K = kTurns<D>, kCount = Layout<Laws>::kCount, W = Lanes::kWidth;
  constexpr int kMemory = kRemembered<Laws, kVelocity, D>;
  const V dt(p.dt), quantum(p.quantum), offset(p.offset);
  V largest(0.0);
  for (std::int64_t k = 0; k < p.packets; ++k) {
    const std::int32_t* bead = p.bead + W * k;
    const double* constants = p.constants + p.constants_step * k;
    V c[kCount];
    for (int m = 0; m < kCount; ++m) c[m] = Lanes::load(constants + W * m);
    V r[D];
    ContactKinematics<V, D> a;
    Lanes::template columns<D>(p.records, bead, r, a.v);
    V height = fma(r[0], V(p.n[0]), -offset);
    for (int m = 1; m < D; ++m) height = fma(r[m], V(p.n[m]), height);
    a.overlap = c[constant::kReach] - height;
    largest = max(a.overlap, largest);
    for (int m = 0; m < D; ++m) {
      a.n[m] = V(p.n[m]);
      a.v[m] = a.v[m] - V(p.velocity[m]);
    }
    if constexpr (Laws::Tangential::kActs) {
      V s[K];
      Lanes::template spins<D>(p.spins, bead, s);
      for (int m = 0; m < K; ++m) {
        a.s[m] = s[m];
        if constexpr (Laws::Rolling::kActs) a.w[m] = s[m] * c[constant::kInvRadiusI];
      }
    }
    double* kept = p.memory + W * kMemory * k;
    V memory[kMemory + 1];
    for (int m = 0; m < kMemory; ++m) memory[m] = Lanes::load(kept + W * m);
    ContactLoad<V, D> act_on = act<Laws, kVelocity, V, D>(a, c, dt, p.locate, memory);
    for (int m = 0; m < kMemory; ++m) Lanes::store(memory[m], kept + W * m);
    if constexpr (Laws::Rolling::kActs)
      for (int m = 0; m < K; ++m) act_on.q[m] = act_on.q[m] + act_on.q_i[m];
    for (V& f : act_on.f) f = rounded(f, quantum);
    for (V& q : act_on.q) q = rounded(q, quantum);
    Lanes::template add_one<D, Laws::Tangential::kActs>(p.forces, bead, act_on.f, act_on.q);
  }
  return Lanes::largest(largest);
}

/// Velocity Verlet: half kicks v += (dt/2) a, drift r += dt v. Two successive half kicks are not merged, so
/// the bits do not depend on how a run is divided into calls.
template <class Lanes, int D, int kKicks, bool kDrift>
Deviation integrate(const IntegrateArgs& args) {
  using Row = typename Lanes::Row;
  const IntegrateArgs p = args;  // a copy that no store can alias
  const double h = p.dt / 2;
  const Row h_row = Row::all(h), zero = Row::all(0);
  [[maybe_unused]] const Row gravity = D == 2 ? Row::high(p.gravity[0], p.gravity[1]) : Row::three(p.gravity);
  const Row dt_row = D == 2 ? Row::low(p.dt) : Row::all(p.dt);
  Row most = zero;
  const Row fallen = D == 2 ? Row::high(p.fallen[0], p.fallen[1]) : Row::three(p.fallen);
  const auto one = [&](std::int64_t b) TWINCELL_LANES {
    double* record = p.records + kRecord<D> * b;
    double* force = p.forces + kForceRecord<D> * b;
    const Row inv_m = Row::load(p.inv_mass + p.inertia_step * 4 * b);
    const double turn = p.turn[p.inertia_step * b];
    if constexpr (D == 2) {
      // Velocities are the upper half of a record; so are accelerations.
      const Row a = fma(Row::load(force).swapped(), inv_m, gravity);
      const double spin_kick = -h * turn * force[2];
      Row v = Row::load(record);
      double spin = p.spins[b];
      for (int k = 0; k < kKicks; ++k) {
        v = fma(h_row, a, v);
        spin += spin_kick;
      }
      Row next = v;
      if constexpr (kDrift) {
        next = fma(v.swapped(), dt_row, next);
        zero.store(force);
      }
      next.store(record);
      if (p.spin) p.spins[b] = spin;
      most = max(most, abs(v - (Row::high(p.reference[2 * b], p.reference[2 * b + 1]) + fallen)));
    } else {
      const Row a = fma(Row::load(force), inv_m, gravity);
      const Row spin_kick = Row::all(-h * turn) * Row::load(force + 4);
      double* spin = p.spins + 4 * b;
      Row v = Row::load(record + 4), s = Row::load(spin);
      for (int k = 0; k < kKicks; ++k) {
        v = fma(h_row, a, v);
        s = s + spin_kick;
      }
      v.store(record + 4);
      if (p.spin) s.store(spin);
      if constexpr (kDrift) {
        fma(dt_row, v, Row::load(record)).store(record);
        zero.store(force);
        zero.store(force + 4);
      }
      most = max(most, abs(v - (Row::load(p.reference + 4 * b) + fallen)));
    }
  };
  if constexpr (D == 2 && Lanes::kBlock > 0) {
    most = max(most, Lanes::template integrate_blocks<kKicks, kDrift>(p, h_row, dt_row, gravity, fallen));
    // Beads that do not fill a block.
    for (std::int64_t k = 0; k < p.n_runs; ++k)
      for (std::int64_t b = Lanes::end_of_blocks(p.runs[k]); b < p.runs[k].end; ++b) one(b);
  } else {
    for (std::int64_t k = 0; k < p.n_runs; ++k)
      for (std::int64_t b = p.runs[k].begin; b < p.runs[k].end; ++b) one(b);
  }
  alignas(64) double high[4];
  most.store(high);
  if constexpr (D == 2) return {{high[2], high[3], 0}};
  return {{high[0], high[1], high[2]}};
}

template <class Lanes, int D>
Deviation integrate_kernel(const IntegrateArgs& p) {
  if (!p.drift) return integrate<Lanes, D, 1, false>(p);
  return p.kicks == 2 ? integrate<Lanes, D, 2, true>(p) : integrate<Lanes, D, 1, true>(p);
}

/// Free flight: the operations of integrate() with contact forces of 0, for several steps.
template <class Lanes, int D>
void free_flight_kernel(const FreeFlightArgs& args) {
  using Row = typename Lanes::Row;
  const FreeFlightArgs p = args;
  const Row h = Row::all(p.dt / 2), dt = D == 2 ? Row::low(p.dt) : Row::all(p.dt);
  const Row gravity = D == 2 ? Row::high(p.gravity[0], p.gravity[1]) : Row::three(p.gravity);
  // Several beads at a time, because each step of a bead depends on the one before.
  constexpr int kTogether = 4;
  const auto fly = [&](double* const* record, int n) TWINCELL_LANES {
    Row v[kTogether], r[kTogether];
    for (int k = 0; k < kTogether; ++k) {
      v[k] = Row::load(record[k < n ? k : 0] + (D == 2 ? 0 : 4));
      if constexpr (D == 3) r[k] = Row::load(record[k < n ? k : 0]);
    }
    for (std::int64_t step = 0; step < p.steps; ++step)
      for (int k = 0; k < kTogether; ++k) {
        v[k] = fma(h, gravity, v[k]);
        v[k] = fma(h, gravity, v[k]);
        if constexpr (D == 2)
          v[k] = fma(v[k].swapped(), dt, v[k]);
        else
          r[k] = fma(dt, v[k], r[k]);
      }
    for (int k = 0; k < n; ++k) {
      v[k].store(record[k] + (D == 2 ? 0 : 4));
      if constexpr (D == 3) r[k].store(record[k]);
    }
  };
  double* record[kTogether];
  int n = 0;
  for (std::int64_t k = 0; k < p.n_runs; ++k) {
    std::int64_t b = p.runs[k].begin;
    if constexpr (D == 2 && Lanes::kBlock > 0)
      for (; b + kGroup <= p.runs[k].end; b += kGroup) Lanes::fly_group(p, h, dt, gravity, b);
    for (; b < p.runs[k].end; ++b) {
      record[n++] = p.records + kRecord<D> * b;
      if (n == kTogether) fly(record, n), n = 0;
    }
  }
  if (n > 0) fly(record, n);
}

template <class Lanes, int D>
VelocityRange velocity_range_kernel(const VelocityRangeArgs& args) {
  using Row = typename Lanes::Row;
  const VelocityRangeArgs p = args;
  Row least = Row::all(HUGE_VAL), most = Row::all(-HUGE_VAL);
  std::int64_t b = p.beads.begin;
  if constexpr (D == 2 && Lanes::kBlock > 0) b = Lanes::range_blocks(p, least, most);
  for (; b < p.beads.end; ++b) {
    const double* record = p.records + kRecord<D> * b;
    const Row v = Row::load(record + (D == 2 ? 0 : 4));
    // min(NaN, x) and max(NaN, x) are x.
    least = min(v, least);
    most = max(v, most);
    if constexpr (D == 2) {
      p.reference[2 * b] = record[2];
      p.reference[2 * b + 1] = record[3];
    } else {
      v.store(p.reference + 4 * b);
    }
  }
  alignas(64) double low[4], high[4];
  least.store(low);
  most.store(high);
  if constexpr (D == 2) return {{low[2], low[3], 0}, {high[2], high[3], 0}};
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

/// Marks the listed pairs that may come close within the horizon (NearPairArgs).
template <class Lanes, int D>
void near_pair_kernel(const NearPairArgs& p) {
  using V = typename Lanes::V;
  constexpr int W = Lanes::kWidth;
  for (std::int64_t k = 0; k < p.packets; ++k) {
    V d[D], v[D];
    Lanes::template difference<D>(p.records, p.i + W * k, p.j + W * k, d, v);
    if (p.shift != nullptr)
      for (int c = 0; c < D; ++c) d[c] = d[c] + Lanes::load(p.shift + W * (D * k + c));
    V r2 = d[0] * d[0];
    for (int c = 1; c < D; ++c) r2 = fma(d[c], d[c], r2);
    V closing = d[0] * v[0];
    for (int c = 1; c < D; ++c) closing = fma(d[c], v[c], closing);
    const V reach = Lanes::load(p.reach + p.reach_step * k), r = sqrt(r2);
    const auto touching = r < reach;
    const auto near = fma(V(p.horizon), min(closing, V(0.0)), r2) < r * (reach + V(p.margin));
    p.touching[k] = static_cast<std::uint16_t>(Lanes::bits(touching));
    p.near[k] = static_cast<std::uint16_t>(Lanes::bits(near));
  }
}

/// Table of the kernels of every combination of laws, one table per dimension.
template <class Lanes>
struct KernelTable {
  static constexpr std::size_t kNormals = std::variant_size_v<NormalAxis>;
  static constexpr std::size_t kTangentials = std::variant_size_v<TangentialAxis>;
  static constexpr std::size_t kRollings = std::variant_size_v<RollingAxis>;

  template <int D, Velocity kVelocity, std::size_t kIndex>
  static constexpr Kernels entry() {
    using N = std::variant_alternative_t<kIndex / (kTangentials * kRollings), NormalAxis>;
    using T = std::variant_alternative_t<kIndex / kRollings % kTangentials, TangentialAxis>;
    using R = std::variant_alternative_t<kIndex % kRollings, RollingAxis>;
    // Beads that do not rotate have no rolling resistance.
    using Laws = std::conditional_t<T::kActs, LawSet<N, T, R>, LawSet<N, T, NoRolling>>;
    return {&pair_kernel<Lanes, Laws, D, kVelocity>,
            &wall_kernel<Lanes, Laws, D, kVelocity>,
            &integrate_kernel<Lanes, D>,
            &free_flight_kernel<Lanes, D>,
            &velocity_range_kernel<Lanes, D>,
            &near_pair_kernel<Lanes, D>,
            kRemembered<Laws, kVelocity, D>};
  }
  template <int D, Velocity kVelocity, std::size_t... kIndex>
  static Kernels pick(std::size_t index, std::index_sequence<kIndex...>) {
    static constexpr Kernels kAll[] = {entry<D, kVelocity, kIndex>()...};
    return kAll[index];
  }
  static Kernels find(const KernelKey& key) { return key.dimension == 2 ? find_in<2>(key) : find_in<3>(key); }
  template <int D>
  static Kernels find_in(const KernelKey& key);
};
/// Instantiates all kernels of a dimension. It is not inline, so that a file can leave a dimension to another
/// file (`extern template`) and two cores compile one instruction set.
template <class Lanes>
template <int D>
Kernels KernelTable<Lanes>::find_in(const KernelKey& key) {
  constexpr auto kEach = std::make_index_sequence<kNormals * kTangentials * kRollings>();
  const std::size_t index = (key.normal * kTangentials + key.tangential) * kRollings + key.rolling;
  return key.velocity == Velocity::full_step ? pick<D, Velocity::full_step>(index, kEach)
                                             : pick<D, Velocity::half_step>(index, kEach);
}

}  // namespace twincell::sim
