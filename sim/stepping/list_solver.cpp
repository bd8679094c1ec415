#include "sim/stepping/list_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <barrier>
#include <bit>
#include <cmath>
#include <exception>
#include <numeric>
#include <thread>

#include "core/cancellation.hpp"
#include "sim/kernels/subnormals.hpp"
#include "sim/stepping/packed_beads.hpp"
#include "sim/system/cell_grid.hpp"

namespace twincell::sim {

namespace {

using Size = std::size_t;

/// For how many steps the inner list is meant to last at most, and fewer than how many are a reason to be
/// more generous.
constexpr double kHorizon = 64, kLongHorizon = 256, kShort = 24;
constexpr double kWallSteps = 256;
/// Beads are taken in chunks of whole groups, with at least so many packets of pairs (if there are): the
/// lanes of a packet are far enough apart in space that a bead seldom stands twice in it, and what a chunk
/// needs is still in a near cache when its contact forces are done and its next step begins. With 32 packets
/// the calls cost more than is gained.
constexpr std::size_t kChunkBeads = 8 * kGroup, kChunkPackets = 128;

/// A list of contacts in packets: what a pass reads.
struct Packets {
  std::vector<std::int32_t> i, j, force_i, force_j;
  std::vector<double> memory, constants, shift;
  std::vector<std::int32_t> source;  ///< [packet][lane] where it came from; -1: nothing
  std::int64_t count = 0;            ///< packets
};

/// Up to which packet the pairs, and up to which place the beads, that are done together.
struct Chunk {
  Size packet_end, bead_end, awake_end;  ///< the last: in runs of awake beads
};

/// The beads of one thread, begin .. end, and every contact of theirs. A pair across two threads is computed
/// by both, each adding to its own bead: no two threads write to one place, and the bits are those of one
/// thread.
struct Part {
  Size begin = 0, end = 0;
  std::int32_t dummy = 0;  ///< a place behind the beads that touches nothing
  // Outer list, padded to whole packets.
  std::vector<std::int32_t> i, j;
  std::vector<double> shift, reach, constants, memory;
  std::vector<std::int32_t> record_i, record_j;  ///< where their records begin
  std::vector<Size> chunk_end;  ///< pairs of the outer list whose first bead is before the end of chunk k
  std::vector<std::uint16_t> near, touching;
  Size pairs = 0;
  Packets active;
  std::vector<std::int32_t> remembering;  ///< pairs of the outer list, since the last inner one
  Size evaluated = 0;                     ///< pairs in active
  std::vector<Chunk> chunks;  ///< of active; every pair of a bead is in its chunk or an earlier one
  std::array<std::vector<std::int32_t>, 2> dealt;
  // Beads that something may touch, and those that fly freely as long as the list holds. The latter are moved
  // when somebody wants to know where they are.
  std::vector<BeadRange> awake, quiet;
  std::vector<char> is_awake;
  std::int64_t behind = 0;  ///< steps by which the quiet ones are late
  std::vector<Packets> walls;
  double overlap = 0;
  Deviation deviation{};
  std::int64_t visits = 0, wall_visits = 0;
};

class ListSolver : public Solver {
 public:
  ListSolver(const Plan& plan, const GuardLimits& limits, const Target& target, int threads)
      : plan_(plan),
        limits_(limits),
        target_(target),
        passes_(target.find(plan.key)),
        threads_(threads),
        beads_(plan_) {
    width_ = static_cast<Size>(target.width);
    dimension_ = static_cast<Size>(plan.dimension);
    memory_ = static_cast<Size>(passes_.remembered);
    magic_ = grain_of_sums(plan);
  }

  void advance(System& s, std::int64_t steps) override;
  [[nodiscard]] std::int64_t list_builds() const override { return builds_; }
  void rebuild_every(std::int64_t n) override { rebuild_every_ = n; }
  [[nodiscard]] std::vector<ContactMemory> contacts() const override;
  void restore(std::vector<ContactMemory> contacts) override { restored_ = std::move(contacts); }
  [[nodiscard]] std::string description() const override {
    return fmt::format("{}, {} contact{} at a time", target_.name, width_, width_ == 1 ? "" : "s");
  }
  [[nodiscard]] Counters counters() const override { return counters_; }
  [[nodiscard]] Footprint footprint() const override;

 private:
  void prepare(const System& s);
  void sort_beads(const System& s);
  void adapt_skin();
  void make_outer(const System& s);
  void make_inner(Part& part);
  void make_walls(const System& s, Part& part);
  [[nodiscard]] bool outer_is_stale();
  void refresh_pairs(System& s);
  void refresh_walls(const System& s);
  void add_up_motion(const System& s);
  void wall_forces(const System& s, Part& part);
  void pair_forces(const System& s, Part& part, Size begin, Size end);
  void forces(const System& s, Part& part);
  void forces_and_integrate(const System& s, Part& part);
  void activate(const System& s, Part& part);
  void advance_to_now(Part& part);
  [[nodiscard]] Size group() const { return dimension_ == 2 ? kGroup : 1; }
  void check_overlap(System& s, bool drifted);
  void check_speed(System& s);
  void run_serial(System& s, std::int64_t steps);
  void run_parallel(System& s, std::int64_t steps);
  [[nodiscard]] std::int32_t record(std::int32_t place) const {
    return place * (dimension_ == 2 ? kRecord<2> : kRecord<3>);
  }
  [[nodiscard]] double closing(const Vec3& n, const Vec3& way, double added) const;
  [[nodiscard]] std::vector<double> broadcast(const std::vector<double>& set) const;
  /// Whether any of a contact's numbers, `stride` apart, is not 0.
  [[nodiscard]] bool remembers(const double* numbers, Size stride) const {
    for (Size m = 0; m < memory_; ++m)
      if (numbers[m * stride] != 0) return true;
    return false;
  }
  void integrate(Part& part, const BeadRange* runs, Size n, int kicks, bool drift);
  void integrate(Part& part, int kicks, bool drift) {
    part.deviation = {};
    const BeadRange all = all_of(part);
    integrate(part, &all, 1, kicks, drift);
  }
  static BeadRange all_of(const Part& part) {
    return {static_cast<std::int64_t>(part.begin), static_cast<std::int64_t>(part.end)};
  }

  Plan plan_;
  GuardLimits limits_;
  const Target& target_;
  Kernels passes_;
  int threads_;
  Size width_ = 1, dimension_ = 2, memory_ = 0;
  double magic_ = 0;

  PackedBeads beads_;
  std::vector<std::int32_t> order_, rank_;  ///< place -> bead, bead -> place
  std::vector<Part> parts_;
  std::vector<double> pair_constants_;               ///< of equal beads, broadcast over lanes
  std::vector<std::vector<double>> wall_constants_;  ///< the same for each wall
  std::vector<ContactMemory> restored_;

  double skin_ = 0, widest_skin_ = 0, usual_radius_ = 0;
  std::int64_t looks_ = 0;  ///< inner lists made from this outer one
  double since_built_ = 0,
         last_margin_ = 0;   ///< approach since the outer list was made, at most; HUGE_VAL: unknown
  std::vector<Vec3> built_;  ///< positions at the outer list's making
  // Inner list: pairs that free flight brings nearer than 2 slack within the horizon. It holds until contacts
  // have bent some bead's flight by slack, or the horizon is reached.
  double slack_ = 1e-3, horizon_ = 0, margin_ = 0, deviated_ = 0;
  std::int64_t lasted_ = 0;
  Lines reference_;
  double least_[3] = {}, most_[3] = {}, fastest_ = 0,
         speed_bound_ = 0;  ///< velocities at the last look, and since
  std::vector<double> wall_margin_, wall_approach_;
  std::vector<char> wall_stale_;
  bool all_walls_ = true, wall_refresh_ = false, pair_refresh_ = false;
  double plate_ = 0, plate_velocity_ = 0, plate_before_ = 0;
  IntegrateArgs integrate_args_{};
  std::int64_t builds_ = 0, rebuild_every_ = 0, calls_ = 0;
  Counters counters_;
};

Size packets_of(Size n, Size width) {
  return (n + width - 1) / width;
}

std::vector<double> ListSolver::broadcast(const std::vector<double>& set) const {
  std::vector<double> lanes(set.size() * width_);
  for (Size m = 0; m < set.size(); ++m)
    std::fill_n(lanes.begin() + static_cast<std::ptrdiff_t>(m * width_), width_, set[m]);
  return lanes;
}

/// Beads in the order of the cells they are in, so that neighbours in space are neighbours in memory.
void ListSolver::sort_beads(const System& s) {
  order_.resize(s.beads.size());
  std::iota(order_.begin(), order_.end(), 0);
  const double cell = 3 * usual_radius_;
  std::vector<std::array<double, 3>> key(s.beads.size());
  for (Size b = 0; b < s.beads.size(); ++b) {
    const auto whole = [&](double x) { return std::abs(x) < 1e9 ? std::floor(x / cell) : 1e9; };
    key[b] = {whole(s.beads[b].z), whole(s.beads[b].y), whole(s.beads[b].x)};
  }
  std::stable_sort(order_.begin(), order_.end(), [&](std::int32_t a, std::int32_t b) {
    return key[static_cast<Size>(a)] < key[static_cast<Size>(b)];
  });
  rank_.resize(order_.size());
  for (Size k = 0; k < order_.size(); ++k) rank_[static_cast<Size>(order_[k])] = static_cast<std::int32_t>(k);
}

void ListSolver::prepare(const System& s) {
  // Second neighbours of a hexagonal packing sit at 1.73 sigma: a skin of a quarter diameter adds no pairs
  // there. The diameter is that of the usual bead: one a hundred times larger must not make the small ones'
  // lists long.
  std::vector<double> radii;
  for (const Bead& b : s.beads) radii.push_back(b.radius);
  const double largest = *std::max_element(radii.begin(), radii.end());
  const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), middle, radii.end());
  usual_radius_ = *middle;
  const double base = kListReach * 2 * usual_radius_;
  widest_skin_ = 3 * 2 * usual_radius_;
  for (const double period : s.period)  // never two images of a bead in reach
    if (period > 0) widest_skin_ = std::min(widest_skin_, 0.5 * period - 2 * largest);
  widest_skin_ = std::max(widest_skin_, base);
  if (skin_ == 0) skin_ = base;
  if (order_.size() != s.beads.size()) {
    restored_ = restored_.empty() ? contacts() : std::move(restored_);
    sort_beads(s);
    parts_.assign(static_cast<Size>(threads_for(s.beads.size(), threads_)), {});
    for (Size p = 0; p < parts_.size(); ++p) {
      parts_[p].begin = s.beads.size() * p / parts_.size();
      parts_[p].end = s.beads.size() * (p + 1) / parts_.size();
      parts_[p].dummy = static_cast<std::int32_t>(s.beads.size() + p);
      parts_[p].walls.resize(s.walls.size());
    }
    built_.clear();
  }
  if (!beads_.agrees(s, order_)) beads_.take(s, order_, parts_.size());
  if (beads_.equal() && beads_.size() > 0 && pair_constants_.empty()) {
    const double r = beads_.radius(0);
    pair_constants_ = broadcast(contact_constants(plan_.bead, beads_.pair(0, 0), 2 * r, 1 / r, 1 / r));
    for (const ContactLaws& laws : plan_.wall_laws)
      wall_constants_.push_back(broadcast(contact_constants(laws, beads_.wall(0), r, 1 / r, 0)));
  }
}

std::vector<ContactMemory> ListSolver::contacts() const {
  std::vector<ContactMemory> all = restored_;
  const auto keep = [&](const Packets& p, Size at, std::int32_t i, std::int32_t j) {
    const Size packet = at / width_, lane = at % width_;
    ContactMemory c{i, j, std::vector<double>(memory_)};
    bool any = false;
    for (Size m = 0; m < memory_; ++m) {
      c.values[m] = p.memory[(packet * memory_ + m) * width_ + lane];
      any = any || c.values[m] != 0;
    }
    if (any) all.push_back(std::move(c));
  };
  if (memory_ == 0) return all;
  for (const Part& part : parts_) {
    for (Size r = 0; r < part.active.source.size(); ++r) {
      if (part.active.source[r] < 0) continue;
      const Size from = static_cast<Size>(part.active.source[r]);
      const std::int32_t i = part.i[from], j = part.j[from];
      // A pair across parts is known to both: the one that owns i says.
      if (static_cast<Size>(i) < part.begin || static_cast<Size>(i) >= part.end) continue;
      keep(part.active, r, order_[static_cast<Size>(i)], order_[static_cast<Size>(j)]);
    }
    for (Size w = 0; w < part.walls.size(); ++w)
      for (Size r = 0; r < part.walls[w].source.size(); ++r)
        keep(part.walls[w], r, order_[static_cast<Size>(part.walls[w].source[r])],
             -1 - static_cast<std::int32_t>(w));
  }
  std::sort(all.begin(), all.end(), [](const ContactMemory& a, const ContactMemory& b) {
    return a.i != b.i ? a.i < b.i : a.j < b.j;
  });
  return all;
}

Solver::Footprint ListSolver::footprint() const {
  const auto bytes = [](const auto&... v) { return ((v.capacity() * sizeof(v[0])) + ...); };
  const auto held = [&](const Packets& p) {
    return bytes(p.i, p.j, p.force_i, p.force_j, p.memory, p.constants, p.shift, p.source);
  };
  Footprint f;
  f.beads = beads_.bytes() + bytes(order_, rank_, built_) + reference_.bytes();
  for (const Part& part : parts_) {
    f.listed += part.pairs;
    f.pairs += bytes(part.i, part.j, part.shift, part.reach, part.constants, part.memory, part.record_i,
                     part.record_j, part.near, part.touching, part.remembering, part.chunk_end, part.chunks) +
               held(part.active);
    for (const Packets& wall : part.walls) {
      f.listed += wall.source.size();
      f.pairs += held(wall);
    }
  }
  return f;
}

/// Beads have moved, against their mean, so far that an unlisted pair may be within the inner margin.
bool ListSolver::outer_is_stale() {
  if (built_.size() != beads_.size()) return true;
  Vec3 mean = Vec3::Zero();
  for (Size k = 0; k < beads_.size(); ++k) mean += beads_.position(k) - built_[k];
  mean /= static_cast<double>(std::max<Size>(1, beads_.size()));
  double first = 0, second = 0;  // squares of the two largest displacements
  for (Size k = 0; k < beads_.size(); ++k) {
    const double d = (beads_.position(k) - built_[k] - mean).squaredNorm();
    if (!(d <= first)) {
      second = first;
      first = d;
    } else if (d > second) {
      second = d;
    }
  }
  // Negated, so that a position that is not a number makes the list stale and is found at the build.
  since_built_ = std::sqrt(first) + std::sqrt(second);
  return !(since_built_ + margin_ <= skin_);
}

/// Sorted by two keys, of which the first is below n: dealt to places by the first, the few of one place by
/// the second.
template <class T, class First, class Second>
std::vector<T> in_order_of(std::vector<T> given, Size n, First first, Second second) {
  std::vector<Size> end(n + 1, 0);
  for (const T& t : given) ++end[static_cast<Size>(first(t)) + 1];
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<T> sorted(given.size());
  for (T& t : given) sorted[end[static_cast<Size>(first(t))]++] = std::move(t);
  for (Size k = 0, begin = 0; k < n; begin = end[k++])
    std::sort(sorted.begin() + static_cast<std::ptrdiff_t>(begin),
              sorted.begin() + static_cast<std::ptrdiff_t>(end[k]),
              [&](const T& a, const T& b) { return second(a) < second(b); });
  return sorted;
}

/// A wide skin makes outer lists rare and long. Best is where making them costs as much as going through
/// them, which is some hundred times cheaper per pair than the search is per bead: a dense bed keeps to its
/// first shell, a dilute gas looks far ahead.
void ListSolver::adapt_skin() {
  constexpr double kSearch = 400;
  Size listed = 0;
  for (const Part& part : parts_) listed += part.pairs;
  const double search = kSearch * static_cast<double>(beads_.size()),
               looks = static_cast<double>(looks_) * static_cast<double>(listed);
  if (looks_ == 0) return;
  if (search > 2 * looks) skin_ *= 1.25;
  if (looks > 2 * search) skin_ *= 0.8;
  skin_ = std::clamp(skin_, 0.2 * usual_radius_, widest_skin_);
}

void ListSolver::make_outer(const System& given) {
  adapt_skin();
  looks_ = 0;
  System s = given;  // the search wants positions by bead
  beads_.give(s, order_);
  check_motion(s, limits_);
  std::vector<ContactMemory> remembered = contacts();
  restored_.clear();
  struct Found {
    std::int32_t i, j;
    Vec3 shift;
  };
  std::vector<Found> found;
  for_each_near_pair(s.beads, s.dimension, s.period, skin_,
                     [&](std::int32_t a, std::int32_t b, double, const Vec3& shift) {
                       // The bead of the lower number is i, whatever the order in memory: a remembered vector
                       // keeps its sign.
                       found.push_back({rank_[static_cast<Size>(a)], rank_[static_cast<Size>(b)], shift});
                     });
  found = in_order_of(
      std::move(found), beads_.size(), [](const Found& f) { return std::min(f.i, f.j); },
      [](const Found& f) { return std::max(f.i, f.j); });
  // Where the contacts of bead i begin among those remembered.
  std::vector<std::size_t> first(s.beads.size() + 1, 0);
  for (const ContactMemory& m : remembered) ++first[static_cast<Size>(m.i) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  const bool periodic = s.period[0] > 0 || s.period[1] > 0 || s.period[2] > 0;
  for (Part& part : parts_) {
    const auto mine = [&](std::int32_t k) {
      return static_cast<Size>(k) >= part.begin && static_cast<Size>(k) < part.end;
    };
    part.i.clear(), part.j.clear(), part.shift.clear(), part.reach.clear(), part.constants.clear(),
        part.memory.clear(), part.remembering.clear();
    std::vector<const Found*> own;
    for (const Found& f : found)
      if (mine(f.i) || mine(f.j)) own.push_back(&f);
    part.pairs = own.size();
    part.chunk_end.clear();
    Size reached = 0;
    throw_if_cancelled();
    for (Size end = part.begin; end < part.end;) {
      end = std::min(end + kChunkBeads, part.end);
      const auto before = [&](const Found& f) { return static_cast<Size>(std::min(f.i, f.j)) < end; };
      while (reached < own.size() && before(*own[reached])) ++reached;
      part.chunk_end.push_back(reached);
    }
    const Size packets = packets_of(own.size(), width_), padded = packets * width_;
    part.i.assign(padded, part.dummy), part.j.assign(padded, part.dummy);
    part.near.assign(packets, 0);
    part.touching.assign(packets, 0);
    if (periodic) part.shift.assign(padded * dimension_, 0);
    part.memory.assign(own.size() * memory_, 0);
    part.reach.assign(beads_.equal() ? 0 : padded, 0);
    for (Size p = 0; p < own.size(); ++p) {
      const Found& f = *own[p];
      const Size a = static_cast<Size>(f.i), b = static_cast<Size>(f.j), packet = p / width_,
                 lane = p % width_;
      part.i[p] = f.i, part.j[p] = f.j;
      if (periodic)
        for (Size c = 0; c < dimension_; ++c)
          part.shift[(packet * dimension_ + c) * width_ + lane] =
              f.shift[dimension_ == 2 && c == 1 ? 2 : static_cast<int>(c)];
      if (!beads_.equal()) {
        const double ra = beads_.radius(a), rb = beads_.radius(b);
        const auto set = contact_constants(plan_.bead, beads_.pair(a, b), ra + rb, 1 / ra, 1 / rb);
        part.constants.insert(part.constants.end(), set.begin(), set.end());
        part.reach[p] = ra + rb;
      }
      if (memory_ > 0 && !remembered.empty()) {
        const std::int32_t i = order_[a], j = order_[b];
        const auto of_i = remembered.begin() + static_cast<std::ptrdiff_t>(first[static_cast<Size>(i)]),
                   end = remembered.begin() + static_cast<std::ptrdiff_t>(first[static_cast<Size>(i) + 1]);
        const auto at = std::find_if(of_i, end, [&](const ContactMemory& m) { return m.j == j; });
        if (at != end) {
          std::copy(at->values.begin(), at->values.end(),
                    part.memory.begin() + static_cast<std::ptrdiff_t>(p * memory_));
          part.remembering.push_back(static_cast<std::int32_t>(p));
        }
      }
    }
    part.record_i.resize(padded), part.record_j.resize(padded);
    for (Size p = 0; p < padded; ++p)
      part.record_i[p] = record(part.i[p]), part.record_j[p] = record(part.j[p]);
    part.active = {};
    // Wall contacts are carried over by make_walls; what was restored enters here.
    for (Size w = 0; w < part.walls.size(); ++w) {
      Packets kept;
      for (const ContactMemory& m : remembered)
        if (m.j == -1 - static_cast<std::int32_t>(w) && mine(rank_[static_cast<Size>(m.i)]))
          kept.source.push_back(rank_[static_cast<Size>(m.i)]);
      std::sort(kept.source.begin(), kept.source.end());
      kept.count = static_cast<std::int64_t>(packets_of(kept.source.size(), width_));
      kept.memory.assign(static_cast<Size>(kept.count) * memory_ * width_, 0);
      for (const ContactMemory& m : remembered) {
        if (m.j != -1 - static_cast<std::int32_t>(w) || !mine(rank_[static_cast<Size>(m.i)])) continue;
        const Size at = static_cast<Size>(
            std::lower_bound(kept.source.begin(), kept.source.end(), rank_[static_cast<Size>(m.i)]) -
            kept.source.begin());
        const Size packet = at / width_, lane = at % width_;
        for (Size v = 0; v < memory_; ++v) kept.memory[(packet * memory_ + v) * width_ + lane] = m.values[v];
      }
      part.walls[w] = std::move(kept);
    }
  }
  built_.resize(beads_.size());
  for (Size k = 0; k < beads_.size(); ++k) built_[k] = beads_.position(k);
  since_built_ = 0;
  wall_refresh_ = all_walls_ = true;
  ++builds_;
}

/// The pairs of the outer list with a gap below margin_, dealt out so that the lanes of a packet are far
/// apart in space: then one bead seldom stands twice in a packet.
void ListSolver::make_inner(Part& part) {
  Packets& a = part.active;
  // What the old list remembers goes back to the pairs.
  for (Size packet = 0, at = 0; memory_ > 0 && packet < static_cast<Size>(a.count); ++packet)
    for (Size lane = 0; lane < width_; ++lane, ++at) {
      if (a.source[at] < 0) continue;
      const Size pair = static_cast<Size>(a.source[at]);
      const double* from = a.memory.data() + packet * memory_ * width_ + lane;
      for (Size m = 0; m < memory_; ++m) part.memory[pair * memory_ + m] = from[m * width_];
      if (remembers(from, width_)) part.remembering.push_back(a.source[at]);
    }
  NearPairArgs scan{};
  scan.records = beads_.records();
  scan.i = part.record_i.data(), scan.j = part.record_j.data();
  scan.reach = beads_.equal() ? pair_constants_.data() : part.reach.data();
  scan.reach_step = beads_.equal() ? 0 : static_cast<std::ptrdiff_t>(width_);
  scan.shift = part.shift.empty() ? nullptr : part.shift.data();
  scan.packets = static_cast<std::int64_t>(part.near.size());
  scan.margin = 2 * slack_;
  scan.horizon = horizon_;
  scan.near = part.near.data();
  scan.touching = part.touching.data();
  passes_.scan(scan);
  // A pair that has just parted may still have to settle or forget what it remembers.
  for (const std::int32_t pair : part.remembering) {
    const Size r = static_cast<Size>(pair);
    part.near[r / width_] = static_cast<std::uint16_t>(part.near[r / width_] | 1U << r % width_);
  }
  part.remembering.clear();

  // Those in contact first: packets of pairs that are merely near are passed over after a look at their
  // distances.
  a.source.clear(), part.chunks.clear();
  part.evaluated = 0;
  const auto collect = [&](Size begin, Size end, std::vector<std::int32_t>& to, auto bits_of) {
    for (Size k = begin / width_; k * width_ < end; ++k) {
      unsigned bits = bits_of(k);
      if (k * width_ < begin) bits &= ~0U << (begin - k * width_);
      if ((k + 1) * width_ > end) bits &= (1U << (end - k * width_)) - 1;
      for (; bits != 0; bits &= bits - 1)
        to.push_back(static_cast<std::int32_t>(k * width_ + static_cast<Size>(std::countr_zero(bits))));
    }
  };
  Size from = 0, bead_end = part.begin;
  for (Size c = 0; c < part.chunk_end.size(); ++c) {
    const Size to = part.chunk_end[c];
    bead_end = std::min(bead_end + kChunkBeads, part.end);
    collect(from, to, part.dealt[0], [&](Size k) -> unsigned { return part.touching[k]; });
    collect(from, to, part.dealt[1],
            [&](Size k) -> unsigned { return part.near[k] & ~static_cast<unsigned>(part.touching[k]); });
    from = to;
    const Size n = part.dealt[0].size() + part.dealt[1].size();
    if (n < kChunkPackets * width_ && c + 1 < part.chunk_end.size()) continue;
    for (std::vector<std::int32_t>& dealt : part.dealt) {
      const Size first = a.source.size();
      a.source.resize(first + packets_of(dealt.size(), width_) * width_, -1);
      Size at = first, lane = 0;
      for (const std::int32_t pair : dealt) {
        a.source[at] = pair;
        at += width_;
        if (at >= a.source.size()) at = first + ++lane;
      }
      dealt.clear();
    }
    part.evaluated += n;
    part.chunks.push_back({a.source.size() / width_, bead_end, 0});
  }
  const Size padded = a.source.size(), count = padded / width_;
  const bool many = parts_.size() > 1, shifted = !part.shift.empty();
  const Size constants = part.pairs == 0 ? 0 : part.constants.size() / part.pairs;
  a.count = static_cast<std::int64_t>(count);
  a.i.resize(padded), a.j.resize(padded);
  if (many) a.force_i.resize(padded), a.force_j.resize(padded);
  a.memory.resize(padded * memory_);
  a.constants.resize(padded * constants);
  a.shift.resize(shifted ? padded * dimension_ : 0);
  const auto own = [&](std::int32_t k) {
    return static_cast<Size>(k) >= part.begin && static_cast<Size>(k) < part.end ? k : part.dummy;
  };
  for (Size packet = 0, at = 0; packet < count; ++packet)
    for (Size lane = 0; lane < width_; ++lane, ++at) {
      const auto set = [&](std::vector<double>& numbers, Size of, auto value) {
        for (Size m = 0; m < of; ++m) numbers[(packet * of + m) * width_ + lane] = value(m);
      };
      if (a.source[at] < 0) {
        a.i[at] = a.j[at] = record(part.dummy);
        if (many) a.force_i[at] = a.force_j[at] = record(part.dummy);
        set(a.memory, memory_, [](Size) { return 0.0; });
        set(a.constants, constants, [](Size) { return 1.0; });
        if (shifted) set(a.shift, dimension_, [](Size) { return 0.0; });
        continue;
      }
      const Size pair = static_cast<Size>(a.source[at]);
      a.i[at] = part.record_i[pair], a.j[at] = part.record_j[pair];
      if (many) a.force_i[at] = record(own(part.i[pair])), a.force_j[at] = record(own(part.j[pair]));
      set(a.memory, memory_, [&](Size m) { return part.memory[pair * memory_ + m]; });
      set(a.constants, constants, [&](Size m) { return part.constants[pair * constants + m]; });
      if (shifted)
        set(a.shift, dimension_,
            [&](Size c) { return part.shift[(pair / width_ * dimension_ + c) * width_ + pair % width_]; });
    }
}

/// Beads near each wall.
void ListSolver::make_walls(const System& s, Part& part) {
  for (Size w = 0; w < part.walls.size(); ++w) {
    if (!wall_stale_[w]) continue;
    const Wall& wall = s.walls[w];
    const double offset = offset_now(s, wall);
    Packets old = std::move(part.walls[w]);
    Packets near;
    Size known = 0;
    const bool flat = dimension_ == 2;
    const double inward[3] = {wall.n.x(), flat ? wall.n.z() : wall.n.y(), flat ? 0 : wall.n.z()};
    const std::ptrdiff_t stride = record(1);
    const double* at = beads_.records() + stride * static_cast<std::ptrdiff_t>(part.begin);
    for (Size k = part.begin; k < part.end; ++k, at += stride) {
      double height = at[0] * inward[0] + at[1] * inward[1] - offset;
      if (!flat) height += at[2] * inward[2];
      bool listed = !(height - beads_.radius(k) >= wall_margin_[w]);
      if (known < old.source.size() && static_cast<Size>(old.source[known]) == k) {
        const Size packet = known / width_, lane = known % width_;
        listed = listed || remembers(old.memory.data() + packet * memory_ * width_ + lane, width_);
        ++known;
      }
      if (listed) near.source.push_back(static_cast<std::int32_t>(k));
    }
    const Size n = near.source.size(), count = packets_of(n, width_), padded = count * width_;
    near.count = static_cast<std::int64_t>(count);
    near.i.assign(padded, record(part.dummy));
    near.memory.assign(padded * memory_, 0);
    const Size constants =
        beads_.equal() ? 0 : contact_constants(plan_.wall_laws[w], beads_.wall(0), 1, 1, 0).size();
    near.constants.assign(padded * constants, 1);
    Size before = 0;
    for (Size r = 0; r < n; ++r) {
      const Size packet = r / width_, lane = r % width_;
      const Size k = static_cast<Size>(near.source[r]);
      near.i[packet * width_ + lane] = record(near.source[r]);
      while (before < old.source.size() && old.source[before] < near.source[r]) ++before;
      if (before < old.source.size() && old.source[before] == near.source[r]) {
        const Size old_packet = before / width_, old_lane = before % width_;
        for (Size m = 0; m < memory_; ++m)
          near.memory[(packet * memory_ + m) * width_ + lane] =
              old.memory[(old_packet * memory_ + m) * width_ + old_lane];
      }
      if (constants > 0) {
        const auto set =
            contact_constants(plan_.wall_laws[w], beads_.wall(k), beads_.radius(k), 1 / beads_.radius(k), 0);
        for (Size m = 0; m < constants; ++m)
          near.constants[(packet * constants + m) * width_ + lane] = set[m];
      }
    }
    part.walls[w] = std::move(near);
  }
}

/// Of two velocities, at most the length of their difference, and the largest component.
double spread(const VelocityRange& range) {
  double s = 0;
  for (int k = 0; k < 3; ++k) s += (range.most[k] - range.least[k]) * (range.most[k] - range.least[k]);
  return std::sqrt(s);
}
double fastest(const VelocityRange& range) {
  double s = 0;
  for (int k = 0; k < 3; ++k) s = std::max({s, -range.least[k], range.most[k]});
  return s;
}

double length(const double* v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

void ListSolver::refresh_pairs(System& s) {
  // Velocities from which free flight is computed.
  VelocityRange range{};
  for (Size p = 0; p < parts_.size(); ++p) {
    const VelocityRange own = passes_.range({beads_.records(), reference_.data(), all_of(parts_[p])});
    for (int k = 0; k < 3; ++k) {
      range.least[k] = p == 0 ? own.least[k] : std::min(range.least[k], own.least[k]);
      range.most[k] = p == 0 ? own.most[k] : std::max(range.most[k], own.most[k]);
    }
  }
  fastest_ = fastest(range);
  for (int k = 0; k < 3; ++k) least_[k] = range.least[k], most_[k] = range.most[k];
  // A list that did not last was too strict with what contacts do to free flight; one that lasted easily too
  // generous.
  if (lasted_ < kShort)
    slack_ *= 2;
  else if (deviated_ < 0.25 * slack_)
    slack_ *= 0.5;
  slack_ = std::clamp(slack_, 1e-5 * skin_, 0.1 * skin_);
  // A bed in flight has few pairs to look at: making the list is then the greater cost.
  Size active = 0, listed = 0;
  for (const Part& part : parts_) active += part.evaluated, listed += part.pairs;
  const double horizon_steps = 4 * active < listed ? kLongHorizon : kHorizon;
  // Not so far ahead that beads could come in from beyond the outer list.
  horizon_ = std::min(horizon_steps * s.dt, 0.5 * skin_ / std::max(spread(range), 1e-300));
  margin_ = horizon_ * spread(range) + 2 * slack_;
  // What any two beads may have approached since the outer list was made is at most what they may have in
  // each stretch between looks; only when that no longer suffices are displacements measured.
  since_built_ += last_margin_;
  last_margin_ = margin_;
  if (rebuild_every_ > 0 && calls_ % rebuild_every_ == 0) built_.clear(), since_built_ = HUGE_VAL;
  if (!(since_built_ + margin_ <= skin_) && outer_is_stale()) make_outer(s);
  deviated_ = 0;
  lasted_ = 0;
  ++looks_;
  ++counters_.near_refreshes;
}

/// How fast beads may close in on a wall that moves by `way` per time: those of the last look, what contacts
/// and gravity have added since.
double ListSolver::closing(const Vec3& n, const Vec3& way, double added) const {
  double c = added;
  for (int k = 0; k < static_cast<int>(dimension_); ++k) {
    const int axis = dimension_ == 2 && k == 1 ? 2 : k;
    c += std::max(-n[axis] * (least_[k] - way[axis]), -n[axis] * (most_[k] - way[axis]));
  }
  return std::max(0.0, c);
}

void ListSolver::refresh_walls(const System& s) {
  for (Size w = 0; w < s.walls.size(); ++w) {
    wall_stale_[w] = all_walls_ || !(wall_approach_[w] <= wall_margin_[w]);
    if (!wall_stale_[w]) continue;
    Vec3 v = Vec3::Zero();
    if (s.walls[w].moves) v[static_cast<int>(s.drive.axis)] = plate_velocity_;
    wall_margin_[w] =
        std::clamp(kWallSteps * s.dt * (closing(s.walls[w].n, v, 0) + 0.1), 1e-5 * skin_, skin_);
    wall_approach_[w] = 0;
  }
  all_walls_ = false;
}

/// Which groups of beads are in a contact list.
void ListSolver::activate(const System& s, Part& part) {
  const Size n = (part.end - part.begin + group() - 1) / group();
  // Where most groups would be awake it does not pay to tell them apart; drag acts on all.
  const bool all = s.plate_drag > 0 || 2 * part.evaluated * group() > part.end - part.begin;
  part.is_awake.assign(n, all ? 1 : 0);
  const auto wake = [&](std::int32_t place) {
    const Size k = static_cast<Size>(place);
    if (k >= part.begin && k < part.end) part.is_awake[(k - part.begin) / group()] = 1;
  };
  for (const std::int32_t pair : part.active.source) {
    if (pair < 0 || all) continue;
    wake(part.i[static_cast<Size>(pair)]);
    wake(part.j[static_cast<Size>(pair)]);
  }
  for (const Packets& wall : part.walls)
    for (const std::int32_t bead : wall.source) wake(bead);
  part.awake.clear(), part.quiet.clear();
  Size g = 0;
  for (Chunk& chunk : part.chunks) {
    const Size of_before = part.awake.size();  // runs of awake beads end with their chunk
    for (Size begin = part.begin + g * group(); g < n && begin < chunk.bead_end; ++g, begin += group()) {
      const bool awake = part.is_awake[g] != 0;
      std::vector<BeadRange>& runs = awake ? part.awake : part.quiet;
      const auto first = static_cast<std::int64_t>(begin),
                 end = static_cast<std::int64_t>(std::min(begin + group(), part.end));
      if (runs.size() > (awake ? of_before : 0) && runs.back().end == first)
        runs.back().end = end;
      else
        runs.push_back({first, end});
    }
    chunk.awake_end = part.awake.size();
  }
}

/// Moves quiet beads to the present step.
void ListSolver::advance_to_now(Part& part) {
  if (part.behind > 0 && !part.quiet.empty()) {
    FreeFlightArgs a{};
    a.records = beads_.records();
    a.runs = part.quiet.data();
    a.n_runs = static_cast<std::int64_t>(part.quiet.size());
    a.steps = part.behind;
    a.dt = integrate_args_.dt;
    for (int k = 0; k < 3; ++k) a.gravity[k] = integrate_args_.gravity[k];
    passes_.fly(a);
  }
  part.behind = 0;
}

void ListSolver::integrate(Part& part, const BeadRange* runs, Size n, int kicks, bool drift) {
  IntegrateArgs a = integrate_args_;
  a.runs = runs;
  a.n_runs = static_cast<std::int64_t>(n);
  a.kicks = kicks;
  a.drift = drift;
  a.reference = reference_.data();
  const double t = static_cast<double>(lasted_ + (kicks == 2 ? 1 : 0)) * a.dt;
  for (int k = 0; k < 3; ++k) a.fallen[k] = t * a.gravity[k];
  const Deviation own = passes_.integrate(a);
  for (int k = 0; k < 3; ++k) part.deviation.most[k] = std::max(part.deviation.most[k], own.most[k]);
}

/// After a drift: what may have approached what, and whether the lists still hold.
void ListSolver::add_up_motion(const System& s) {
  double deviation[3] = {0, 0, 0};
  for (const Part& part : parts_)
    for (int k = 0; k < 3; ++k) deviation[k] = std::max(deviation[k], part.deviation.most[k]);
  const double strayed = length(deviation);
  deviated_ += s.dt * strayed;
  ++lasted_;
  const bool forced = rebuild_every_ > 0 && ++calls_ % rebuild_every_ == 0;
  // Negated comparisons: what is not a number must not pass.
  pair_refresh_ = forced || !(deviated_ <= slack_ && static_cast<double>(lasted_) * s.dt < horizon_);
  wall_refresh_ = all_walls_ = forced;
  const double added = strayed + static_cast<double>(lasted_) * s.dt * s.gravity.norm();
  speed_bound_ = fastest_ + added;
  // A wall's own way is counted as it went, not by its speed at one end of the step.
  plate_before_ = plate_;
  plate_ = s.plate_height(), plate_velocity_ = s.plate_velocity();
  const Vec3 way = ((plate_ - plate_before_) / s.dt) * Vec3::Unit(static_cast<int>(s.drive.axis));
  for (Size w = 0; w < s.walls.size(); ++w) {
    const Wall& wall = s.walls[w];
    const Vec3 v = wall.moves ? way : Vec3::Zero();
    wall_approach_[w] += s.dt * closing(wall.n, v, added);
    wall_refresh_ = wall_refresh_ || !(wall_approach_[w] <= wall_margin_[w]);
  }
}

void ListSolver::pair_forces(const System& s, Part& part, Size begin, Size end) {
  Packets& a = part.active;
  const Size lane = begin * width_;
  PairArgs p{};
  p.records = beads_.records();
  p.spins = beads_.spins();
  p.forces = beads_.forces();
  p.i = a.i.data() + lane, p.j = a.j.data() + lane;
  p.force_i = parts_.size() > 1 ? a.force_i.data() + lane : p.i,
  p.force_j = parts_.size() > 1 ? a.force_j.data() + lane : p.j;
  p.memory = a.memory.data() + lane * memory_;
  if (beads_.equal()) {
    p.constants = pair_constants_.data();
  } else {
    p.constants_step = static_cast<std::ptrdiff_t>(a.constants.size()) / a.count;
    p.constants = a.constants.data() + p.constants_step * static_cast<std::ptrdiff_t>(begin);
  }
  p.shift = a.shift.empty() ? nullptr : a.shift.data() + lane * dimension_;
  p.packets = static_cast<std::int64_t>(end - begin);
  p.dt = s.dt;
  p.locate = plan_.locate;
  p.magic = magic_;
  part.overlap = std::max(part.overlap, passes_.pairs(p));
  part.visits += p.packets;
}

/// Contacts with walls, and drag.
void ListSolver::wall_forces(const System& s, Part& part) {
  part.overlap = 0;
  for (Size w = 0; w < part.walls.size(); ++w) {
    Packets& near = part.walls[w];
    if (near.count == 0) continue;
    const Wall& wall = s.walls[w];
    WallArgs g{};
    g.records = beads_.records(), g.spins = beads_.spins(), g.forces = beads_.forces();
    g.bead = near.i.data();
    g.memory = near.memory.data();
    g.constants = beads_.equal() ? wall_constants_[w].data() : near.constants.data();
    g.constants_step = beads_.equal() ? 0 : static_cast<std::ptrdiff_t>(near.constants.size()) / near.count;
    g.packets = near.count;
    const int axis = static_cast<int>(s.drive.axis);
    Vec3 v = Vec3::Zero();
    if (wall.moves)
      v[axis] = plan_.key.velocity == Velocity::full_step ? (plate_ - plate_before_) / s.dt : plate_velocity_;
    if (dimension_ == 2) {
      g.n[0] = wall.n.x(), g.n[1] = wall.n.z();
      g.velocity[0] = v.x(), g.velocity[1] = v.z();
    } else {
      for (int k = 0; k < 3; ++k) g.n[k] = wall.n[k], g.velocity[k] = v[k];
    }
    g.offset = wall.moves ? wall.offset + wall.n[axis] * plate_ : wall.offset;
    g.dt = s.dt;
    g.locate = plan_.locate;
    g.magic = magic_;
    part.overlap = std::max(part.overlap, passes_.walls(g));
    part.wall_visits += near.count;
  }
  if (s.plate_drag > 0) {
    const Vec3 v = plate_velocity_ * Vec3::Unit(static_cast<int>(s.drive.axis));
    beads_.add_plate_drag(s, v.x(), v.z(), part.begin, part.end);
  }
}

void ListSolver::forces(const System& s, Part& part) {
  wall_forces(s, part);
  if (part.active.count > 0) pair_forces(s, part, 0, static_cast<Size>(part.active.count));
}

/// All forces, and behind them the next step of every bead whose contacts are done: its record, force and
/// neighbours are still in the first-level cache.
void ListSolver::forces_and_integrate(const System& s, Part& part) {
  wall_forces(s, part);
  part.deviation = {};
  Size packet = 0, awake = 0;
  for (const Chunk& chunk : part.chunks) {
    if (chunk.packet_end > packet) pair_forces(s, part, packet, chunk.packet_end);
    if (chunk.awake_end > awake) integrate(part, part.awake.data() + awake, chunk.awake_end - awake, 2, true);
    packet = chunk.packet_end, awake = chunk.awake_end;
  }
  ++part.behind;
}

/// \param drifted beads have since moved on by a step
void ListSolver::check_overlap(System& s, bool drifted) {
  double overlap = 0;
  for (const Part& part : parts_) overlap = std::max(overlap, part.overlap);
  if (overlap <= limits_.overlap) return;
  for (Part& part : parts_) advance_to_now(part);
  if (drifted) beads_.drift(-s.dt);
  beads_.give(s, order_);
  explain_overlap(s, limits_);
}

void ListSolver::check_speed(System& s) {
  if (speed_bound_ * s.dt <= limits_.travel_per_step) return;
  for (Part& part : parts_) advance_to_now(part);
  beads_.give(s, order_);
  check_motion(s, limits_);
}

void ListSolver::run_serial(System& s, std::int64_t steps) {
  Part& part = parts_[0];
  integrate(part, 1, true);
  for (std::int64_t k = 0; k < steps; ++k) {
    throw_if_cancelled();
    ++s.step;
    add_up_motion(s);
    const bool last = k + 1 == steps, refresh = pair_refresh_ || wall_refresh_;
    if (refresh || last) advance_to_now(part);
    if (pair_refresh_) {
      refresh_pairs(s);
      make_inner(part);
    }
    if (wall_refresh_) {
      refresh_walls(s);
      make_walls(s, part);
    }
    if (refresh) activate(s, part);
    check_speed(s);
    last ? forces(s, part) : forces_and_integrate(s, part);
    check_overlap(s, !last);
  }
  integrate(part, 1, false);
}

void ListSolver::run_parallel(System& s, std::int64_t steps) {
  // Two meetings a step: positions are new; forces are complete. What one thread does for all happens in the
  // meeting.
  std::exception_ptr failure;
  bool moved = true;  // otherwise: forces are complete
  bool stop = false;
  const auto meet = [&]() noexcept {
    try {
      if (moved) {
        throw_if_cancelled();
        ++s.step;
        add_up_motion(s);
        if (pair_refresh_) refresh_pairs(s);
        if (wall_refresh_) refresh_walls(s);
        check_speed(s);
      } else {
        check_overlap(s, false);
      }
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
      if (!stop) {
        if (pair_refresh_) make_inner(part);
        if (wall_refresh_) make_walls(s, part);
        forces(s, part);
      }
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

void ListSolver::advance(System& s, std::int64_t steps) {
  if (s.beads.empty() || steps <= 0) {
    s.step += std::max<std::int64_t>(0, steps);
    return;
  }
  check_motion(s, limits_);
  const FlushSubnormals flush;
  const bool known = s.forces_known && s.forces.size() == s.beads.size();
  s.forces_known = known;
  prepare(s);
  integrate_args_ = beads_.integrate_args(s);
  wall_margin_.resize(s.walls.size(), 0), wall_approach_.resize(s.walls.size(), 0);
  wall_stale_.resize(s.walls.size(), 1);
  all_walls_ = true;
  plate_ = s.plate_height(), plate_velocity_ = s.plate_velocity(), plate_before_ = s.plate_height_before();
  // Lists are checked at every call: the plate and the beads may have been moved by other hands.
  since_built_ = HUGE_VAL;
  reference_.resize(static_cast<Size>(record(1)) / 2 * s.beads.size());
  lasted_ = static_cast<std::int64_t>(kShort);
  refresh_pairs(s);
  refresh_walls(s);
  for (Part& part : parts_) {
    make_inner(part);
    make_walls(s, part);
    activate(s, part);
  }
  if (!known) {
    for (Part& part : parts_) forces(s, part);
    check_overlap(s, false);
  }
  if (parts_.size() == 1)
    run_serial(s, steps);
  else
    run_parallel(s, steps);
  counters_.steps += steps;
  for (Part& part : parts_) {
    counters_.pair_visits += part.visits * static_cast<std::int64_t>(width_);
    counters_.wall_visits += part.wall_visits * static_cast<std::int64_t>(width_);
    part.visits = part.wall_visits = 0;
  }
  beads_.give(s, order_);
  check_motion(s, limits_);
}

}  // namespace

std::unique_ptr<Solver> make_list_solver(const Plan& plan, const GuardLimits& limits, const Target& target,
                                         int threads) {
  return std::make_unique<ListSolver>(plan, limits, target, threads);
}

}  // namespace twincell::sim
