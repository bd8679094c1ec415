#pragma once
/// \file
/// The device kernel: one block of threads advances one bed by many steps. The same source runs on a graphics
/// card and on the processor. An execution space states how the beads are divided among threads:
///
///     space.for_each(n, f)    every f(0) ... f(n - 1), in any order and by any thread; then all threads wait
///     space.any(n, f)         the same, and whether f returned true somewhere, known to all threads
///     space.once(f)           f() by one thread; then all threads wait
///     space.sort(n, f, list)  the same as for_each; each i for which f returns Sorted::front or back is put
///                             at that end of list[n], in any order; their numbers, known to all threads
///
/// Between these calls every thread executes the same statements and writes nothing.
///
/// A step has three parts, with a barrier after each. In the first, the listed pairs that touch are
/// collected, and the beads that touch a wall. In the second, every contact is computed once, by any thread,
/// and its force is stored. In the third, each bead sums the forces of its contacts and moves. With the
/// kernels of simd_kernels.hpp the result has the bits of all other solvers. (Tried and dropped: each bead
/// computes its own contacts, so that both beads of a pair compute it; contacts in the order of the list of
/// pairs, among which 18 of the 32 threads of a warp had one.)

#include "sim/contact/plate_drag.hpp"
#include "sim/device/bed.hpp"
#include "sim/device/storing_lanes.hpp"
#include "sim/kernels/simd_kernels.hpp"
#include "sim/system/nearest_image.hpp"

namespace twincell::sim {

/// Where Space::sort() puts an index, and how many it put at each end.
enum class Sorted : std::int32_t { out, front, back };
struct SortedCounts {
  std::int32_t front, back;
};

template <class Space, class Laws, int D, Velocity kVelocity>
class BedKernel {
 public:
  BedKernel(const Space& space, const DeviceBed& bed) : space_(space), bed_(bed), report_(*bed_.report) {}

  /// Advances the bed to its last stop and stores its state at every stop.
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
  template <class T>
  static T* aligned(T* array) {
    return static_cast<T*>(__builtin_assume_aligned(array, 64));
  }
  [[nodiscard]] const double* record_of(std::int32_t b) const { return aligned(bed_.records) + record(b); }
  struct Place {
    double r[D];
    double operator[](int c) const { return r[c]; }
  };
  [[nodiscard]] Place place_of(std::int32_t b) const {
    Place place;
    ScalarLanes::numbers<D>(record_of(b), place.r);
    return place;
  }
  [[nodiscard]] double* force_of(std::int32_t b) const { return aligned(bed_.forces) + record(b); }
  [[nodiscard]] double* force_of_pair(std::int32_t pair) const {
    return aligned(bed_.pair_forces) + std::ptrdiff_t{kForce} * pair;
  }
  /// The beads of a pair, the lower number first.
  [[nodiscard]] const std::int32_t* beads_of(std::int32_t pair) const {
    return aligned(bed_.pair_beads) + 2 * pair;
  }

  /// Keeps the state for the transfer.
  /// \param failed see BedReport
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
    const Place at = place_of(b);
    const double* before = bed_.listed_at + D * b;
    for (int c = 0; c < D; ++c) {
      const double moved = at[c] - before[c] - carried_[c];
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
    constexpr std::int32_t kMaxSample = 32;  // beads
    const std::int32_t sample = bed_.beads < kMaxSample ? bed_.beads : kMaxSample;
    double sum[D] = {};
    for (std::int32_t k = 0; k < sample; ++k) {
      const std::int32_t b = k * bed_.beads / sample;
      for (int c = 0; c < D; ++c) sum[c] += place_of(b)[c] - bed_.listed_at[D * b + c];
    }
    for (int c = 0; c < D; ++c) carried_[c] = sum[c] / sample;
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
  /// the bead is left in first_pair.
  /// \returns whether the slots sufficed
  bool list_neighbours_of(std::int32_t b) {
    std::int32_t old = 0, used = 0, higher = 0;
    const std::int32_t olds = bed_.neighbours[list_][b];
    std::int32_t old_other = olds > 0 ? bed_.partner[list_][slot(b, 0)] : bed_.beads;
    double at[D];
    for (int c = 0; c < D; ++c) at[c] = bed_.listed_at[D * b + c] = place_of(b)[c];
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
      bed_.was_touched[pair] = 1;
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
    const Place there = place_of(other);
    for (int c = 0; c < D; ++c) {
      double apart = b < other ? at[c] - there[c] : there[c] - at[c];  // the same for both beads
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
    const std::int32_t all = pairs_ + bed_.beads;
    const SortedCounts n = space_.sort(all, bed_.touching, [&](std::int32_t k) {
      if (k < pairs_) return is_touched(k) ? Sorted::front : Sorted::out;
      add_drag(k - pairs_, plate);
      return touches_wall(k - pairs_, plate) ? Sorted::back : Sorted::out;
    });
    // Walls begin with a warp of their own: threads of one warp that take different ways wait for each other.
    const std::int32_t walls = (n.front + kWarp - 1) / kWarp * kWarp;
    return !space_.any(walls + n.back, [&](std::int32_t k) {
      if (k >= walls)
        return wall_contacts(bed_.touching[all - 1 - (k - walls)] - pairs_, plate) > bed_.overlap_bound;
      return k < n.front && pair_contact(bed_.touching[k]) > bed_.overlap_bound;
    });
  }

  /// Whether pair_kernel() has something to compute for this pair. If not, the pair has no memory from now on
  /// and its stored force is not read.
  [[nodiscard]] bool is_touched(std::int32_t pair) {
    const std::int32_t lower = beads_of(pair)[0], higher = beads_of(pair)[1];
    const Place from = place_of(higher), to = place_of(lower);
    double r2 = 0;
    for (int c = 0; c < D; ++c) {
      double d = to[c] - from[c];
      if (bed_.periodic) d = d + nearest_shift(d, bed_.period[c]);
      r2 = c == 0 ? d * d : fma(d, d, r2);
    }
    bool touched = r2 < constants_of(lower, higher)[constant::kEdge];
    if constexpr (kVelocity == Velocity::full_step)
      touched = touched || bed_.memory[list_][memory_place(Laws::template kMemory<D>, pair)] != 0;
    if (!touched && bed_.was_touched[pair] != 0)
      for (int m = 0; m < kMemory; ++m) bed_.memory[list_][memory_place(m, pair)] = 0;
    bed_.was_touched[pair] = touched ? 1 : 0;
    return touched;
  }

  void add_pair_forces(std::int32_t b) {
    const std::int32_t used = bed_.neighbours[list_][b];
    double* force = force_of(b);
    double sum[kForce] = {};
    for (std::int32_t k = 0; k < used; ++k) {
      const std::int32_t pair = bed_.pair[list_][slot(b, k)];
      if (bed_.was_touched[pair] == 0) continue;
      double of_pair[kForce];
      for (int c = 0; c < kForce; c += 2) ScalarLanes::numbers<2>(force_of_pair(pair) + c, of_pair + c);
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

  /// Computes the contact of a pair and stores its force.
  /// \returns the overlap
  double pair_contact(std::int32_t pair) {
    const std::int32_t lower = beads_of(pair)[0], higher = beads_of(pair)[1];
    const std::int32_t i = record(lower), j = record(higher), at = 0;
    double shift[D] = {};
    if (bed_.periodic)
      for (int c = 0; c < D; ++c)
        shift[c] = nearest_shift(place_of(lower)[c] - place_of(higher)[c], bed_.period[c]);
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
    for (int c = 0; c < kForce; c += 2)
      ScalarLanes::store(ScalarLanes::Two{force[c], force[c + 1]}, force_of_pair(pair) + c);
    return overlap;
  }

  void add_drag(std::int32_t b, const double* plate) {
    if constexpr (D == 2)
      if (bed_.has_drag)
        for (int c = 0; c < D; ++c)
          force_of(b)[c] +=
              plate_drag_force(bed_.drag[b], record_of(b)[kRecord<D> / 2 + c], plate[3 + c], bed_.quantum);
  }

  /// Whether a bead touches a wall or remembers one.
  [[nodiscard]] bool touches_wall(std::int32_t b, const double* plate) const {
    bool touches = false;
    for (std::int32_t w = 0; w < bed_.walls; ++w) touches = touches || has_wall_contact(b, w, plate);
    return touches;
  }
  [[nodiscard]] bool has_wall_contact(std::int32_t b, std::int32_t w, const double* plate) const {
    const Place at = place_of(b);
    const double* normal = bed_.normals + 3 * w;
    double height = fma(at[0], normal[0], -plate[6 + w]);
    for (int c = 1; c < D; ++c) height = fma(at[c], normal[c], height);
    bool known = false;
    for (int m = 0; m < kMemory; ++m) known = known || bed_.wall_memory[wall_memory_place(b, w, m)] != 0;
    return wall_constants_of(b, w)[constant::kReach] - height > 0 || known;
  }
  [[nodiscard]] const double* wall_constants_of(std::int32_t b, std::int32_t w) const {
    return bed_.wall_constants + std::ptrdiff_t{kCount} * (bed_.kinds * w + bed_.kind[b]);
  }

  /// Adds the forces of the walls to a bead.
  /// \returns the largest overlap
  double wall_contacts(std::int32_t b, const double* plate) {
    double overlap = 0;
    for (std::int32_t w = 0; w < bed_.walls; ++w)
      if (has_wall_contact(b, w, plate)) overlap = max(overlap, wall_contact(b, w, plate));
    return overlap;
  }

  /// Adds the force of a wall to bead b.
  /// \returns the overlap
  double wall_contact(std::int32_t b, std::int32_t w, const double* plate) {
    const std::int32_t i = record(b);
    WallArgs g{};
    for (int c = 0; c < D; ++c) g.n[c] = bed_.normals[3 * w + c];
    for (int c = 0; c < D; ++c) g.velocity[c] = bed_.moves[w] != 0 ? plate[c] : 0;
    g.offset = plate[6 + w];
    g.constants = wall_constants_of(b, w);
    double memory[kMemory + 1];
    for (int m = 0; m < kMemory; ++m) memory[m] = bed_.wall_memory[wall_memory_place(b, w, m)];
    g.records = aligned(bed_.records), g.spins = bed_.spins, g.forces = aligned(bed_.forces);
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
