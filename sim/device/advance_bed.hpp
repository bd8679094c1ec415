#pragma once
/// \file
/// The device kernel: one block of threads advances one bed by many steps. The same source runs on a graphics
/// card and on the processor. An execution space states how the beads are divided among threads:
///
///     space.for_each(n, f)   every f(0) ... f(n - 1), in any order and by any thread; then all threads wait
///     space.once(f)          f() by one thread; then all threads wait
///
/// Between these calls every thread executes the same statements and writes nothing.
///
/// Each bead sums the forces of its own contacts, so both beads of a pair compute it, with the same bits, and
/// nothing is added by two threads. With the kernels of simd_kernels.hpp the result has the bits of all other
/// solvers.

#include "sim/contact/plate_drag.hpp"
#include "sim/device/bed.hpp"
#include "sim/device/one_sided_lanes.hpp"
#include "sim/kernels/simd_kernels.hpp"
#include "sim/system/nearest_image.hpp"

namespace twincell::sim {

template <class Space, class Laws, int D, Velocity kVelocity>
class BedKernel {
 public:
  BedKernel(const Space& space, const DeviceBed& bed) : space_(space), bed_(bed), report_(*bed_.report) {
    IntegrateArgs& a = integrate_;
    a = {};
    a.records = bed.records, a.spins = bed.spins, a.forces = bed.forces;
    a.inv_mass = bed.inv_mass, a.turn = bed.turn, a.inertia_step = 1;
    a.spin = bed.spin, a.dt = bed.dt;
    for (int c = 0; c < D; ++c) a.gravity[c] = bed.gravity[c];
  }

  void advance() {
    list_ = static_cast<int>(report_.list);
    builds_ = report_.builds;
    for (int c = 0; c < D; ++c) carried_[c] = report_.carried[c];
    space_.once([&] { report_.failed = report_.overfull = report_.outside = report_.far = -1; });
    std::int64_t done = 0;
    if (bed_.fresh) list_neighbours(done);
    if (!bed_.known) forces(done);
    bool sound = report_.overfull < 0;
    while (sound && done < bed_.steps) {
      ++done;
      move(done, done == 1 ? 1 : 2, true);
      if (is_list_expired(done)) list_neighbours(done);
      forces(done);
      sound = report_.failed != done && report_.overfull < 0;
    }
    if (sound) move(done, 1, false);
    space_.once([&] {
      report_.steps = done;
      report_.list = list_;
      report_.builds = builds_;
      for (int c = 0; c < D; ++c) report_.carried[c] = carried_[c];
    });
  }

 private:
  static constexpr int kMemory = kRemembered<Laws, kVelocity, D>;
  static constexpr int kCount = Layout<Laws>::kCount;

  static std::int32_t record(std::int32_t b) { return kRecord<D> * b; }

  /// Notes a step in the report. Several threads may note the same one at once.
  static void mark(std::int64_t& noted, std::int64_t step) {
    __atomic_store_n(&noted, step, __ATOMIC_RELAXED);
  }

  /// Half kicks and, if `drift`, the drift of every bead.
  void move(std::int64_t step, int kicks, bool drift) {
    space_.for_each(bed_.beads, [&](std::int32_t b) {
      const BeadRange one{b, b + 1};
      IntegrateArgs a = integrate_;
      a.runs = &one, a.n_runs = 1;
      // The deviation from free flight is not used: its reference is the record of this bead, not of another.
      a.reference = bed_.records + std::ptrdiff_t{kRecord<D> / 2} * b;
      a.kicks = kicks;
      a.drift = drift;
      integrate_kernel<ScalarLanes, D>(a);
      if (drift && is_outside(b)) mark(report_.outside, step);
    });
  }

  // --- neighbours ---

  /// Whether a bead has moved so far, relative to a displacement common to all beads, that an unlisted pair
  /// may touch. Half the skin for each bead, less what rounding could take.
  [[nodiscard]] bool is_outside(std::int32_t b) const {
    const double bound = 0.499 * bed_.skin;
    double square = 0;
    for (int c = 0; c < D; ++c) {
      const double moved = bed_.records[record(b) + c] - bed_.listed_at[D * b + c] - carried_[c];
      square += moved * moved;
    }
    return !(square <= bound * bound);  // a NaN position is outside
  }

  /// Whether the list must be built. A bed that rides on its plate keeps its list: only the motion relative
  /// to the mean displacement counts, which is computed where the last one does not suffice.
  [[nodiscard]] bool is_list_expired(std::int64_t step) {
    if (bed_.rebuild_every > 0 && (bed_.step + step) % bed_.rebuild_every == 0) return true;
    if (report_.outside != step) return false;
    double sum[D] = {};
    for (std::int32_t b = 0; b < bed_.beads; ++b)
      for (int c = 0; c < D; ++c) sum[c] += bed_.records[record(b) + c] - bed_.listed_at[D * b + c];
    for (int c = 0; c < D; ++c) carried_[c] = sum[c] / bed_.beads;
    space_.for_each(bed_.beads, [&](std::int32_t b) {
      if (is_outside(b)) mark(report_.far, step);
    });
    return report_.far == step;
  }

  void list_neighbours(std::int64_t step) {
    for (double& c : carried_) c = 0;
    space_.for_each(bed_.beads, [&](std::int32_t b) { list_neighbours_of(b, step); });
    list_ = 1 - list_;
    ++builds_;
  }

  /// Lists the beads within the skin of a bead, and those with which it shares memory.
  void list_neighbours_of(std::int32_t b, std::int64_t step) {
    const std::int32_t begin = bed_.first[b], end = bed_.first[b + 1];
    std::int32_t old = begin, at = begin;
    const std::int32_t old_end = begin + bed_.neighbours[list_][b];
    for (int c = 0; c < D; ++c) bed_.listed_at[D * b + c] = bed_.records[record(b) + c];
    for (std::int32_t other = 0; other < bed_.beads; ++other) {
      if (other == b) continue;
      while (old < old_end && bed_.partner[list_][old] < other) ++old;
      const double* kept = old < old_end && bed_.partner[list_][old] == other
                               ? bed_.memory[list_] + std::ptrdiff_t{kMemory} * old
                               : nullptr;
      if (!is_within_skin(b, other) && !remembers(kept)) continue;
      if (at == end) {
        mark(report_.overfull, step);
        break;
      }
      bed_.partner[1 - list_][at] = other;
      double* memory = bed_.memory[1 - list_] + std::ptrdiff_t{kMemory} * at;
      for (int m = 0; m < kMemory; ++m) memory[m] = kept != nullptr ? kept[m] : 0;
      ++at;
    }
    bed_.neighbours[1 - list_][b] = at - begin;
  }

  [[nodiscard]] bool is_within_skin(std::int32_t a, std::int32_t b) const {
    const double far = constants_of(a < b ? a : b, a < b ? b : a)[constant::kReach] + bed_.skin;
    double square = 0;
    for (int c = 0; c < D; ++c) {
      double apart = bed_.records[record(a) + c] - bed_.records[record(b) + c];
      if (bed_.periodic) apart += nearest_shift(apart, bed_.period[c]);
      square += apart * apart;
    }
    return square < far * far;
  }

  static bool remembers(const double* memory) {
    bool any = false;
    for (int m = 0; m < kMemory; ++m) any = any || (memory != nullptr && memory[m] != 0);
    return any;
  }

  // --- forces ---

  /// Forces at the present positions, which are those of step `step` of this launch.
  void forces(std::int64_t step) {
    const double* plate = bed_.plate + step * plate_row(bed_.walls);
    space_.for_each(bed_.beads, [&](std::int32_t b) {
      double overlap = 0;
      const std::int32_t begin = bed_.first[b], end = begin + bed_.neighbours[list_][b];
      for (std::int32_t slot = begin; slot < end; ++slot) overlap = max(overlap, pair_force(b, slot));
      for (std::int32_t w = 0; w < bed_.walls; ++w) overlap = max(overlap, wall_force(b, w, plate));
      if constexpr (D == 2)
        if (bed_.has_drag)
          for (int c = 0; c < D; ++c)
            bed_.forces[record(b) + c] += plate_drag_force(
                bed_.drag[b], bed_.records[record(b) + kRecord<D> / 2 + c], plate[3 + c], bed_.quantum);
      if (overlap > bed_.overlap_bound) mark(report_.failed, step);
    });
  }

  [[nodiscard]] const double* constants_of(std::int32_t lower, std::int32_t higher) const {
    return bed_.pair_constants + std::ptrdiff_t{kCount} * (bed_.kinds * bed_.kind[lower] + bed_.kind[higher]);
  }

  /// Adds the force of a contact to bead b. \returns the overlap
  double pair_force(std::int32_t b, std::int32_t slot) {
    const std::int32_t other = bed_.partner[list_][slot];
    const std::int32_t lower = other < b ? other : b, higher = other < b ? b : other;
    const std::int32_t i = record(lower), j = record(higher);
    const std::int32_t force_i = lower == b ? i : OneSidedLanes::kOthers,
                       force_j = higher == b ? j : OneSidedLanes::kOthers;
    double shift[D] = {};
    if (bed_.periodic)
      for (int c = 0; c < D; ++c)
        shift[c] = nearest_shift(bed_.records[i + c] - bed_.records[j + c], bed_.period[c]);
    PairArgs p{};
    p.records = bed_.records, p.spins = bed_.spins, p.forces = bed_.forces;
    p.i = &i, p.j = &j, p.force_i = &force_i, p.force_j = &force_j;
    p.memory = bed_.memory[list_] + std::ptrdiff_t{kMemory} * slot;
    p.constants = constants_of(lower, higher);
    p.shift = bed_.periodic ? shift : nullptr;
    p.packets = 1;
    p.dt = bed_.dt, p.locate = bed_.locate, p.quantum = bed_.quantum;
    return pair_kernel<OneSidedLanes, Laws, D, kVelocity>(p);
  }

  /// Adds the force of a wall to bead b. \returns the overlap
  double wall_force(std::int32_t b, std::int32_t w, const double* plate) {
    const std::int32_t i = record(b);
    WallArgs g{};
    for (int c = 0; c < D; ++c) {
      g.n[c] = bed_.normals[3 * w + c];
      g.velocity[c] = bed_.moves[w] != 0 ? plate[c] : 0;
    }
    g.offset = plate[6 + w];
    g.memory = bed_.wall_memory + std::ptrdiff_t{kMemory} * (bed_.walls * b + w);
    g.constants = bed_.wall_constants + std::ptrdiff_t{kCount} * (bed_.kinds * w + bed_.kind[b]);
    // The walls are few, but most beads touch none: most calls end here.
    double height = fma(bed_.records[i], g.n[0], -g.offset);
    for (int c = 1; c < D; ++c) height = fma(bed_.records[i + c], g.n[c], height);
    if (!(g.constants[constant::kReach] - height > 0) && !remembers(g.memory)) return 0;
    g.records = bed_.records, g.spins = bed_.spins, g.forces = bed_.forces;
    g.bead = &i;
    g.packets = 1;
    g.dt = bed_.dt, g.locate = bed_.locate, g.quantum = bed_.quantum;
    return wall_kernel<OneSidedLanes, Laws, D, kVelocity>(g);
  }

  const Space& space_;
  const DeviceBed bed_;  // a copy that no store can alias
  BedReport& report_;
  IntegrateArgs integrate_;
  int list_ = 0;
  std::int64_t builds_ = 0;
  double carried_[D] = {};
};

/// Advances a bed by bed.steps steps, or up to the step at which an overlap exceeds its bound.
template <class Space, class Laws, int D, Velocity kVelocity>
void advance_bed(const Space& space, const DeviceBed& bed) {
  BedKernel<Space, Laws, D, kVelocity>(space, bed).advance();
}

}  // namespace twincell::sim
