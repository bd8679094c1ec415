#pragma once
/// \file
/// The text of the passes, for any kind of lanes. Lanes (lanes_scalar.hpp, lanes_highway.hpp) bring a type V
/// of so many numbers with the operations of laws/real.hpp, a Row of four numbers, and the moves between
/// beads' records and V.

#include <array>
#include <utility>
#include <variant>

#include "sim/passes.hpp"

namespace twincell::sim {

/// Contacts of listed pairs.
template <class Lanes, class Laws, int D, Velocity kVelocity>
double pair_pass(const PairArgs& args) {
  const PairArgs p = args;  // a copy that no store can alias
  using V = typename Lanes::V;
  constexpr int K = kTurns<D>, kCount = Layout<Laws>::kCount, W = Lanes::kWidth;
  constexpr int kMemory = kRemembered<Laws, kVelocity, D>;
  const V dt(p.dt), magic(p.magic);
  V largest(0.0);
  for (std::int64_t k = 0; k < p.packets; ++k) {
    const std::int32_t *i = p.i + W * k, *j = p.j + W * k;
    V d[D];
    Approach<V, D> a;
    Lanes::template difference<D>(p.records, i, j, d, a.v);
    if (p.shift != nullptr)
      for (int c = 0; c < D; ++c) d[c] = d[c] + Lanes::load(p.shift + W * (D * k + c));
    const double* constants = p.constants + p.constants_step * k;
    const V reach = Lanes::load(constants + W * constant::kReach);
    V r2 = d[0] * d[0];
    for (int c = 1; c < D; ++c) r2 = fma(d[c], d[c], r2);
    double* kept = p.memory + W * kMemory * k;
    // A pair that parted within this step may still have something to settle, so look a step further then.
    V edge = reach;
    if constexpr (kVelocity == Velocity::full_step) {
      V fastest = abs(a.v[0]);
      for (int c = 1; c < D; ++c) fastest = fastest + abs(a.v[c]);
      edge = fma(dt, fastest, reach);
    }
    if (!any(r2 < edge * edge)) {
      for (int m = 0; m < kMemory; ++m) Lanes::store(V(0.0), kept + W * m);
      continue;
    }
    V c[kCount];
    for (int m = 0; m < kCount; ++m) c[m] = Lanes::load(constants + W * m);
    const V inv_reach = c[constant::kInvReach];
    const V inv_r = inverse_sqrt_near_one(r2 * (inv_reach * inv_reach)) * inv_reach;
    a.overlap = nfma(r2, inv_r, reach);
    for (int m = 0; m < D; ++m) a.n[m] = d[m] * inv_r;
    if constexpr (Laws::Tangential::kActs) {
      Lanes::template spin_sums<D>(p.spins, i, j, a.s);
      if constexpr (Laws::Rolling::kActs) {
        V s_i[K], s_j[K];
        Lanes::template spins<D>(p.spins, i, s_i);
        Lanes::template spins<D>(p.spins, j, s_j);
        for (int m = 0; m < K; ++m)
          a.w[m] =
              s_i[m] * c[constant::kInvRadiusI] - s_j[m] * c[constant::kInvRadiusJ];  // odd under i <-> j
      }
    }
    V memory[kMemory + 1];
    for (int m = 0; m < kMemory; ++m) memory[m] = Lanes::load(kept + W * m);
    Action<V, D> act_on = act<Laws, kVelocity, V, D>(a, c, dt, p.locate, magic, memory);
    for (int m = 0; m < kMemory; ++m) Lanes::store(memory[m], kept + W * m);
    largest = max(largest, act_on.overlap);
    V q_i[K], q_j[K];
    for (int m = 0; m < K; ++m) {
      q_i[m] = Laws::Rolling::kActs ? act_on.q[m] + act_on.q_i[m] : act_on.q[m];
      q_j[m] = Laws::Rolling::kActs ? act_on.q[m] + act_on.q_j[m] : act_on.q[m];
    }
    Lanes::template add<D, Laws::Tangential::kActs, Laws::Rolling::kActs>(
        p.forces, p.force_i + W * k, p.force_j + W * k, act_on.f, q_i, q_j);
  }
  return Lanes::largest(largest);
}

/// Contacts of listed beads with one wall.
template <class Lanes, class Laws, int D, Velocity kVelocity>
double wall_pass(const WallArgs& args) {
  const WallArgs p = args;
  using V = typename Lanes::V;
  constexpr int K = kTurns<D>, kCount = Layout<Laws>::kCount, W = Lanes::kWidth;
  constexpr int kMemory = kRemembered<Laws, kVelocity, D>;
  const V dt(p.dt), magic(p.magic), offset(p.offset);
  V largest(0.0);
  for (std::int64_t k = 0; k < p.packets; ++k) {
    const std::int32_t* bead = p.bead + W * k;
    const double* constants = p.constants + p.constants_step * k;
    V c[kCount];
    for (int m = 0; m < kCount; ++m) c[m] = Lanes::load(constants + W * m);
    V r[D];
    Approach<V, D> a;
    Lanes::template columns<D>(p.records, bead, r, a.v);
    V height = fma(r[0], V(p.n[0]), -offset);
    for (int m = 1; m < D; ++m) height = fma(r[m], V(p.n[m]), height);
    a.overlap = c[constant::kReach] - height;
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
    Action<V, D> act_on = act<Laws, kVelocity, V, D>(a, c, dt, p.locate, magic, memory);
    for (int m = 0; m < kMemory; ++m) Lanes::store(memory[m], kept + W * m);
    largest = max(largest, act_on.overlap);
    if constexpr (Laws::Rolling::kActs)
      for (int m = 0; m < K; ++m) act_on.q[m] = act_on.q[m] + act_on.q_i[m];
    Lanes::template add_one<D, Laws::Tangential::kActs>(p.forces, bead, act_on.f, act_on.q);
  }
  return Lanes::largest(largest);
}

/// Velocity Verlet: half kicks v += (dt/2) a, drift r += dt v. Two half kicks in a row are kept apart, so
/// that where a run is cut into pieces does not show.
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
  std::int64_t b = p.begin;
  if constexpr (D == 2 && Lanes::kBlock > 0)
    b = Lanes::template integrate_blocks<kKicks, kDrift>(p, h_row, dt_row, gravity, fallen, most);
  for (; b < p.end; ++b) {
    double* record = p.records + kRecord<D> * b;
    double* force = p.forces + kForceRecord<D> * b;
    const Row inv_m = Row::load(p.inv_mass + p.inertia_step * 4 * b);
    const double turn = p.turn[p.inertia_step * b];
    if constexpr (D == 2) {
      // Velocities are the upper half of a record, and so are accelerations.
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
      most = max(most, abs(v - (Row::load(p.reference + 4 * b) + fallen)));
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
  }
  alignas(64) double high[4];
  most.store(high);
  if constexpr (D == 2) return {{high[2], high[3], 0}};
  return {{high[0], high[1], high[2]}};
}

template <class Lanes, int D>
Deviation integrate_pass(const IntegrateArgs& p) {
  if (!p.drift) return integrate<Lanes, D, 1, false>(p);
  return p.kicks == 2 ? integrate<Lanes, D, 2, true>(p) : integrate<Lanes, D, 1, true>(p);
}

/// Marks listed pairs that may come near.
template <class Lanes, int D>
void scan_pass(const ScanArgs& p) {
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

/// The passes of every product of laws, in one table per dimension.
template <class Lanes>
struct PassTable {
  static constexpr std::size_t kNormals = std::variant_size_v<NormalAxis>;
  static constexpr std::size_t kTangentials = std::variant_size_v<TangentialAxis>;
  static constexpr std::size_t kRollings = std::variant_size_v<RollingAxis>;

  template <int D, Velocity kVelocity, std::size_t kIndex>
  static constexpr Passes entry() {
    using N = std::variant_alternative_t<kIndex / (kTangentials * kRollings), NormalAxis>;
    using T = std::variant_alternative_t<kIndex / kRollings % kTangentials, TangentialAxis>;
    using R = std::variant_alternative_t<kIndex % kRollings, RollingAxis>;
    // Beads that do not turn cannot resist rolling.
    using Laws = std::conditional_t<T::kActs, LawSet<N, T, R>, LawSet<N, T, NoRolling>>;
    return {&pair_pass<Lanes, Laws, D, kVelocity>, &wall_pass<Lanes, Laws, D, kVelocity>,
            &integrate_pass<Lanes, D>, &scan_pass<Lanes, D>, kRemembered<Laws, kVelocity, D>};
  }
  template <int D, Velocity kVelocity, std::size_t... kIndex>
  static Passes pick(std::size_t index, std::index_sequence<kIndex...>) {
    static constexpr Passes kAll[] = {entry<D, kVelocity, kIndex>()...};
    return kAll[index];
  }
  template <int D>
  static Passes find(const PassKey& key) {
    constexpr auto kEach = std::make_index_sequence<kNormals * kTangentials * kRollings>();
    const std::size_t index = (key.normal * kTangentials + key.tangential) * kRollings + key.rolling;
    return key.velocity == Velocity::full_step ? pick<D, Velocity::full_step>(index, kEach)
                                               : pick<D, Velocity::half_step>(index, kEach);
  }
};

}  // namespace twincell::sim
