#pragma once
/// \file
/// The device kernel: one block of threads advances one bed by many steps. The same source runs on a graphics
/// card and on the processor. An execution space states how the beads are divided among threads:
///
///     space.for_each(n, f)   every f(0) ... f(n - 1), in any order and by any thread; then all threads wait
///     space.any(n, f)        the same, and whether f returned true somewhere, known to all threads
///     space.once(f)          f() by one thread; then all threads wait
///
/// Between these calls every thread executes the same statements and writes nothing.
///
/// A step has two parts, with a barrier after each. In the first, every contact is computed once, by any
/// thread, and its force is stored. In the second, each bead sums the forces of its contacts and moves. With
/// the kernels of simd_kernels.hpp the result has the bits of all other solvers. (Tried and dropped: each
/// bead computes its own contacts, so that both beads of a pair compute it.)

#include "sim/contact/plate_drag.hpp"
#include "sim/device/bed.hpp"
#include "sim/device/storing_lanes.hpp"
#include "sim/kernels/simd_kernels.hpp"
#include "sim/system/nearest_image.hpp"

namespace twincell::sim {

template <class Space, class Laws, int D, Velocity kVelocity>
class BedKernel {
 public:
  BedKernel(const Space& space, const DeviceBed& bed) : space_(space), bed_(bed), report_(*bed_.report) {}

  void advance() {
    list_ = static_cast<int>(report_.list);
    builds_ = report_.builds;
    for (int c = 0; c < D; ++c) carried_[c] = report_.carried[c];
    pairs_ = static_cast<std::int32_t>(report_.pairs);
    std::int64_t done = 0;
    bool sound = !bed_.fresh || list_neighbours();
    bool summed = bed_.known;  // the forces of the present positions have been summed
    if (sound && !summed) sound = contacts(done);
    for (std::int64_t stop = 0; sound && stop <= bed_.last_stop; ++stop) {
      for (int kicks = 1; sound && done < bed_.stops[stop]; kicks = 2) {
        ++done;
        const bool moved = move(kicks, true, !summed);
        summed = false;
        sound = (!is_list_expired(done, moved) || list_neighbours()) && contacts(done);
      }
      if (!sound) break;
      move(1, false, !summed);
      summed = true;
      report(stop, done, false);
    }
    if (!sound) report(bed_.last_stop, done, true);
  }

 private:
  static constexpr int kMemory = kRemembered<Laws, kVelocity, D>;
  static constexpr int kCount = Layout<Laws>::kCount;
  static constexpr int kForce = kContactForce<D>;

  static std::int32_t record(std::int32_t b) { return kRecord<D> * b; }
  /// An array as its layout aligns it (bed_memory.cpp), so that a card reads two numbers at once.
  static double* aligned(double* array) { return static_cast<double*>(__builtin_assume_aligned(array, 64)); }

  /// Keeps the state for the transfer. \param failed see BedReport
  void report(std::int64_t stop, std::int64_t steps, bool failed) {
    space_.once([&] {
      report_.steps = steps;
      report_.failed = failed;
      report_.pairs = pairs_;
      report_.list = list_;
      report_.builds = builds_;
      for (int c = 0; c < D; ++c) report_.carried[c] = carried_[c];
    });
    std::byte* to = bed_.states + kWord * bed_.state_words * stop;
    space_.for_each(static_cast<std::int32_t>(bed_.state_words),
                    [&](std::int32_t k) { __builtin_memcpy(to + kWord * k, bed_.state + kWord * k, kWord); });
  }

  /// Half kicks and, if `drift`, the drift of every bead; before, if `sum`, the sum of the stored forces.
  /// \returns whether a bead moved so far that is_outside()
  bool move(int kicks, bool drift, bool sum) {
    return space_.any(bed_.beads, [&](std::int32_t b) {
      if (sum) add_pair_forces(b);
      const BeadRange one{b, b + 1};
      IntegrateArgs a{};
      a.records = aligned(bed_.records), a.spins = bed_.spins, a.forces = aligned(bed_.forces);
      a.inv_mass = aligned(bed_.inv_mass), a.turn = bed_.turn, a.inertia_step = 1;
      a.spin = bed_.spin, a.dt = bed_.dt;
      for (int c = 0; c < D; ++c) a.gravity[c] = bed_.gravity[c];
      a.runs = &one, a.n_runs = 1;
      // The deviation from free flight is not used: its reference is the record of this bead, not of another.
      a.reference = bed_.records + std::ptrdiff_t{kRecord<D> / 2} * b;
      a.kicks = kicks;
      a.drift = drift;
      integrate_kernel<ScalarLanes, D>(a);
      return drift && is_outside(b);
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
  /// to a common displacement counts. Any will do; that of some beads is taken where the last one does not.
  /// \param moved what move() returned
  [[nodiscard]] bool is_list_expired(std::int64_t step, bool moved) {
    if (bed_.rebuild_every > 0 && (bed_.step + step) % bed_.rebuild_every == 0) return true;
    if (!moved) return false;
    constexpr std::int32_t kMost = 32;
    const std::int32_t some = bed_.beads < kMost ? bed_.beads : kMost;
    double sum[D] = {};
    for (std::int32_t k = 0; k < some; ++k) {
      const std::int32_t b = k * bed_.beads / some;
      for (int c = 0; c < D; ++c) sum[c] += bed_.records[record(b) + c] - bed_.listed_at[D * b + c];
    }
    for (int c = 0; c < D; ++c) carried_[c] = sum[c] / some;
    return space_.any(bed_.beads, [&](std::int32_t b) { return is_outside(b); });
  }

  /// Lists the beads within the skin of each bead, and those with which it shares memory, then the pairs.
  /// \returns whether the places sufficed
  bool list_neighbours() {
    for (double& c : carried_) c = 0;
    if (space_.any(bed_.beads, [&](std::int32_t b) { return !list_neighbours_of(b); })) return false;
    // Running sums of the numbers of pairs: in parts, of the parts, in parts again.
    space_.for_each(kParts, [&](std::int32_t part) {
      std::int32_t pairs = 0;
      for (std::int32_t b = begin_of(part); b < begin_of(part + 1); ++b) pairs += bed_.first_pair[b];
      bed_.part_pairs[part] = pairs;
    });
    pairs_ = 0;
    for (std::int32_t part = 0; part < kParts; ++part) pairs_ += bed_.part_pairs[part];
    space_.for_each(kParts, [&](std::int32_t part) {
      std::int32_t pairs = 0;
      for (std::int32_t before = 0; before < part; ++before) pairs += bed_.part_pairs[before];
      for (std::int32_t b = begin_of(part); b < begin_of(part + 1); ++b) {
        const std::int32_t of_bead = bed_.first_pair[b];
        bed_.first_pair[b] = pairs;
        pairs += of_bead;
      }
    });
    space_.for_each(bed_.beads, [&](std::int32_t b) { list_pairs_of(b); });
    list_ = 1 - list_;
    ++builds_;
    return true;
  }

  [[nodiscard]] std::int32_t begin_of(std::int32_t part) const { return bed_.beads * part / kParts; }

  /// Slot k of a bead.
  [[nodiscard]] std::int32_t slot(std::int32_t b, std::int32_t k) const {
    return slot_place(bed_.beads, b, k);
  }

  /// Lists the neighbours of a bead in the list that is not in use. Their number with a higher number than
  /// the bead is left in first_pair. \returns whether the slots sufficed
  bool list_neighbours_of(std::int32_t b) {
    std::int32_t old = 0, used = 0, higher = 0;
    const std::int32_t olds = bed_.neighbours[list_][b];
    std::int32_t old_other = olds > 0 ? bed_.partner[list_][slot(b, 0)] : bed_.beads;
    double at[D];
    for (int c = 0; c < D; ++c) at[c] = bed_.listed_at[D * b + c] = bed_.records[record(b) + c];
    for (std::int32_t other = 0; other < bed_.beads; ++other) {
      if (other == b) continue;
      while (old_other < other) {
        ++old;
        old_other = old < olds ? bed_.partner[list_][slot(b, old)] : bed_.beads;
      }
      const bool known = old_other == other;
      if (!is_within_skin(at, b, other) && !(known && remembers(list_, bed_.pair[list_][slot(b, old)])))
        continue;
      if (used == bed_.slots) return false;
      bed_.partner[1 - list_][slot(b, used)] = other;
      // The pair of the old list, whose memory list_pairs_of() takes.
      bed_.pair[1 - list_][slot(b, used)] = known ? bed_.pair[list_][slot(b, old)] : -1;
      if (other > b) ++higher;
      ++used;
    }
    bed_.neighbours[1 - list_][b] = used;
    bed_.first_pair[b] = higher;
    return true;
  }

  /// Lists the pairs of a bead with beads of higher numbers, and finds those with beads of lower numbers.
  void list_pairs_of(std::int32_t b) {
    const int next = 1 - list_;
    const std::int32_t used = bed_.neighbours[next][b];
    std::int32_t pair = bed_.first_pair[b];
    for (std::int32_t k = 0; k < used; ++k) {
      const std::int32_t other = bed_.partner[next][slot(b, k)];
      if (other < b) {
        // Only partner and first_pair of the other bead are read, which no thread writes now.
        std::int32_t at = 0;
        while (bed_.partner[next][slot(other, at)] < other) ++at;
        const std::int32_t lowest = at;
        while (bed_.partner[next][slot(other, at)] < b) ++at;
        bed_.pair[next][slot(b, k)] = bed_.first_pair[other] + (at - lowest);
        continue;
      }
      const std::int32_t old = bed_.pair[next][slot(b, k)];
      for (int m = 0; m < kMemory; ++m)
        bed_.memory[next][memory_place(m, pair)] = old >= 0 ? bed_.memory[list_][memory_place(m, old)] : 0;
      bed_.pair[next][slot(b, k)] = pair;
      bed_.pair_beads[2 * pair] = b, bed_.pair_beads[2 * pair + 1] = other;
      ++pair;
    }
  }

  [[nodiscard]] std::int32_t memory_place(int m, std::int32_t pair) const {
    return pair_place(bed_.most_pairs, pair, m);
  }

  /// \param at position of bead b
  [[nodiscard]] bool is_within_skin(const double* at, std::int32_t b, std::int32_t other) const {
    const double far =
        constants_of(b < other ? b : other, b < other ? other : b)[constant::kReach] + bed_.skin;
    double square = 0;
    for (int c = 0; c < D; ++c) {
      const double there = bed_.records[record(other) + c];
      double apart = b < other ? at[c] - there : there - at[c];  // the same for both beads
      if (bed_.periodic) apart += nearest_shift(apart, bed_.period[c]);
      square += apart * apart;
    }
    return square < far * far;
  }

  [[nodiscard]] bool remembers(int list, std::int32_t pair) const {
    bool any = false;
    for (int m = 0; m < kMemory; ++m) any = any || bed_.memory[list][memory_place(m, pair)] != 0;
    return any;
  }

  // --- forces ---

  /// Computes every contact at the present positions, which are those of step `step` of this launch. The
  /// forces of pairs are stored, those of walls and of drag added to the bead.
  /// \returns whether all overlaps are within their bound
  bool contacts(std::int64_t step) {
    const double* plate = bed_.plate + step * plate_row(bed_.walls);
    return !space_.any(pairs_ + bed_.beads, [&](std::int32_t k) {
      const double overlap = k < pairs_ ? pair_contact(k) : wall_contacts(k - pairs_, plate);
      return overlap > bed_.overlap_bound;
    });
  }

  void add_pair_forces(std::int32_t b) {
    const std::int32_t used = bed_.neighbours[list_][b];
    double* force = aligned(bed_.forces) + record(b);
    double sum[kForce] = {};
    for (std::int32_t k = 0; k < used; ++k) {
      const double* of_pair =
          aligned(bed_.pair_forces) + std::ptrdiff_t{kForce} * bed_.pair[list_][slot(b, k)];
      const double sign = bed_.partner[list_][slot(b, k)] > b ? 1 : -1;
      for (int c = 0; c < D; ++c) sum[c] += sign * of_pair[c];
      if constexpr (Laws::Tangential::kActs)
        for (int c = D; c < D + kTurns<D>; ++c) sum[c] += of_pair[c];
    }
    for (int c = 0; c < D; ++c) force[c] += sum[c];
    if constexpr (Laws::Tangential::kActs)
      for (int c = 0; c < kTurns<D>; ++c) force[kTorque<D> + c] += sum[D + c];
  }

  [[nodiscard]] const double* constants_of(std::int32_t lower, std::int32_t higher) const {
    if (bed_.kinds == 1) return bed_.pair_constants;
    return bed_.pair_constants + std::ptrdiff_t{kCount} * (bed_.kinds * bed_.kind[lower] + bed_.kind[higher]);
  }

  /// Computes the contact of a pair and stores its force. \returns the overlap
  double pair_contact(std::int32_t pair) {
    const std::int32_t lower = bed_.pair_beads[2 * pair], higher = bed_.pair_beads[2 * pair + 1];
    const std::int32_t i = record(lower), j = record(higher), at = 0;
    double shift[D] = {};
    if (bed_.periodic)
      for (int c = 0; c < D; ++c)
        shift[c] = nearest_shift(bed_.records[i + c] - bed_.records[j + c], bed_.period[c]);
    double force[kForce] = {};  // stays 0 if there is no contact
    double memory[kMemory + 1];
    for (int m = 0; m < kMemory; ++m) memory[m] = bed_.memory[list_][memory_place(m, pair)];
    PairArgs p{};
    p.records = aligned(bed_.records), p.spins = bed_.spins, p.forces = force;
    p.i = &i, p.j = &j, p.force_i = &at, p.force_j = &at;
    p.memory = memory;
    p.constants = constants_of(lower, higher);
    p.shift = bed_.periodic ? shift : nullptr;
    p.packets = 1;
    p.dt = bed_.dt, p.locate = bed_.locate, p.quantum = bed_.quantum;
    const double overlap = pair_kernel<StoringLanes, Laws, D, kVelocity>(p);
    for (int m = 0; m < kMemory; ++m) bed_.memory[list_][memory_place(m, pair)] = memory[m];
    double* of_pair = aligned(bed_.pair_forces) + std::ptrdiff_t{kForce} * pair;
    for (int c = 0; c < kForce; ++c) of_pair[c] = force[c];
    return overlap;
  }

  /// Adds the forces of the walls and of drag to a bead. \returns the largest overlap
  double wall_contacts(std::int32_t b, const double* plate) {
    double overlap = 0;
    for (std::int32_t w = 0; w < bed_.walls; ++w) overlap = max(overlap, wall_contact(b, w, plate));
    if constexpr (D == 2)
      if (bed_.has_drag)
        for (int c = 0; c < D; ++c)
          bed_.forces[record(b) + c] += plate_drag_force(
              bed_.drag[b], bed_.records[record(b) + kRecord<D> / 2 + c], plate[3 + c], bed_.quantum);
    return overlap;
  }

  /// Adds the force of a wall to bead b. \returns the overlap
  double wall_contact(std::int32_t b, std::int32_t w, const double* plate) {
    const std::int32_t i = record(b);
    WallArgs g{};
    for (int c = 0; c < D; ++c) g.n[c] = bed_.normals[3 * w + c];
    g.offset = plate[6 + w];
    g.constants = bed_.wall_constants + std::ptrdiff_t{kCount} * (bed_.kinds * w + bed_.kind[b]);
    double memory[kMemory + 1];
    bool known = false;
    for (int m = 0; m < kMemory; ++m) {
      memory[m] = bed_.wall_memory[wall_memory_place(b, w, m)];
      known = known || memory[m] != 0;
    }
    // The walls are few, but most beads touch none: most calls end here.
    double height = fma(bed_.records[i], g.n[0], -g.offset);
    for (int c = 1; c < D; ++c) height = fma(bed_.records[i + c], g.n[c], height);
    if (!(g.constants[constant::kReach] - height > 0) && !known) return 0;
    for (int c = 0; c < D; ++c) g.velocity[c] = bed_.moves[w] != 0 ? plate[c] : 0;
    g.records = bed_.records, g.spins = bed_.spins, g.forces = bed_.forces;
    g.memory = memory;
    g.bead = &i;
    g.packets = 1;
    g.dt = bed_.dt, g.locate = bed_.locate, g.quantum = bed_.quantum;
    const double overlap = wall_kernel<ScalarLanes, Laws, D, kVelocity>(g);
    for (int m = 0; m < kMemory; ++m) bed_.wall_memory[wall_memory_place(b, w, m)] = memory[m];
    return overlap;
  }
  [[nodiscard]] std::int32_t wall_memory_place(std::int32_t b, std::int32_t w, int m) const {
    return wall_place(bed_.beads, kMemory, b, w, m);
  }

  const Space& space_;
  const DeviceBed& bed_;  // on a card in the memory of the block, which is faster than a copy of each thread
  BedReport& report_;
  int list_ = 0;
  std::int32_t pairs_ = 0;
  std::int64_t builds_ = 0;
  double carried_[D] = {};
};

/// Advances a bed to its last stop, or up to the step at which an overlap exceeds its bound.
template <class Space, class Laws, int D, Velocity kVelocity>
void advance_bed(const Space& space, const DeviceBed& bed) {
  BedKernel<Space, Laws, D, kVelocity>(space, bed).advance();
}

}  // namespace twincell::sim
