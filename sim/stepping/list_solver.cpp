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

/// Largest number of steps for which an inner list is built (kLongHorizon if few pairs are near). If a list
/// lasts fewer than kShort steps, the slack is increased.
constexpr double kHorizon = 64, kLongHorizon = 256, kShort = 24;
constexpr double kWallSteps = 256;
/// Beads are processed in chunks of whole groups, each with at least kChunkPackets packets of pairs (if there
/// are so many). The lanes of a packet are then far enough apart in space that a packet seldom contains a
/// bead twice. The data of a chunk are still in a near cache when its contact forces are complete and its
/// next step begins. With 32 packets, the cost of the calls exceeds the gain.
constexpr std::size_t kChunkBeads = 8 * kGroup, kChunkPackets = 128;

/// A list of contacts in packets: the input of a kernel.
struct Packets {
  std::vector<std::int32_t> i, j, force_i, force_j;
  std::vector<double> memory, constants, shift;
  std::vector<std::int32_t> source;  ///< [packet][lane] pair of the outer list, or bead; -1: padding
  std::int64_t count = 0;            ///< packets
};

/// Pairs and beads that are processed together, up to the given packet of pairs and place of a bead.
struct Chunk {
  Size packet_end, bead_end, active_end;  ///< the last: index in runs of active beads
};

/// The beads of one thread, begin .. end - 1, and all their contacts. A pair that crosses two threads is
/// computed by both, and each adds the force to its own bead. No two threads therefore write to one place,
/// and the bits are those of a single thread.
struct Part {
  Size begin = 0, end = 0;
  std::int32_t dummy = 0;  ///< place of a record after the beads that touches nothing
  // Outer list, padded to whole packets.
  std::vector<std::int32_t> i, j;
  std::vector<double> shift, reach, constants, memory;
  std::vector<std::int32_t> record_i, record_j;  ///< first numbers of their records
  std::vector<Size> chunk_end;                   ///< [chunk] end of its pairs in the outer list
  std::vector<std::uint16_t> near, touching;
  Size pairs = 0;
  Packets inner;
  std::vector<std::int32_t> remembering;  ///< pairs of the outer list with memory, since the last inner list
  Size evaluated = 0;                     ///< pairs in inner
  std::vector<Chunk> chunks;  ///< of inner; every pair of a bead is in its chunk or an earlier one
  std::array<std::vector<std::int32_t>, 2> dealt;
  // Active beads may have a contact. Inactive beads fly freely as long as the list is valid; they are
  // advanced only when their positions are needed.
  std::vector<BeadRange> active_runs, inactive_runs;
  std::vector<char> is_active;
  std::int64_t behind = 0;  ///< steps by which the inactive beads lag
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
        kernels_(target.find(plan.key)),
        threads_(threads),
        beads_(plan_) {
    width_ = static_cast<Size>(target.width);
    dimension_ = static_cast<Size>(plan.dimension);
    memory_ = static_cast<Size>(kernels_.remembered);
    quantum_ = grain_of_sums(plan);
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
  /// Whether any of a contact's remembered numbers, `stride` apart, is nonzero.
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
  Kernels kernels_;
  int threads_;
  Size width_ = 1, dimension_ = 2, memory_ = 0;
  double quantum_ = 0;

  PackedBeads beads_;
  std::vector<std::int32_t> order_, rank_;  ///< place -> bead, bead -> place
  std::vector<Part> parts_;
  std::vector<double> pair_constants_;               ///< for equal beads, broadcast over the SIMD lanes
  std::vector<std::vector<double>> wall_constants_;  ///< the same for each wall
  std::vector<ContactMemory> restored_;

  double skin_ = 0, widest_skin_ = 0, usual_radius_ = 0;
  std::int64_t looks_ = 0;  ///< inner lists built from this outer list
  double since_built_ = 0,
         last_margin_ = 0;   ///< bound on the approach since the outer list was built; HUGE_VAL: unknown
  std::vector<Vec3> built_;  ///< positions when the outer list was built
  // Inner list: pairs that free flight brings closer than 2 slack within the horizon. It remains valid until
  // contacts have deflected some bead from free flight by the slack, or until the horizon is reached.
  double slack_ = 1e-3, horizon_ = 0, margin_ = 0, deviated_ = 0;
  std::int64_t lasted_ = 0;
  Lines reference_;
  double least_[3] = {}, most_[3] = {}, fastest_ = 0,
         speed_bound_ = 0;  ///< velocity range at the last inner list, and bound on speeds since
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

/// Sorts beads by the cells that contain them, so that neighbours in space are neighbours in memory.
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
  // Second neighbours of a hexagonal packing are at 1.73 sigma, so a skin of a quarter diameter adds no pairs
  // there. The diameter is the median: one bead a hundred times larger must not lengthen the lists of the
  // small beads.
  std::vector<double> radii;
  for (const Bead& b : s.beads) radii.push_back(b.radius);
  const double largest = *std::max_element(radii.begin(), radii.end());
  const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), middle, radii.end());
  usual_radius_ = *middle;
  const double base = kListReach * 2 * usual_radius_;
  widest_skin_ = 3 * 2 * usual_radius_;
  for (const double period : s.period)  // a bead must not reach two images of another
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
  if (!beads_.agrees(s, order_)) beads_.load(s, order_, parts_.size());
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
    for (Size r = 0; r < part.inner.source.size(); ++r) {
      if (part.inner.source[r] < 0) continue;
      const Size from = static_cast<Size>(part.inner.source[r]);
      const std::int32_t i = part.i[from], j = part.j[from];
      // Both threads store a pair that crosses them; only the owner of bead i reports it.
      if (static_cast<Size>(i) < part.begin || static_cast<Size>(i) >= part.end) continue;
      keep(part.inner, r, order_[static_cast<Size>(i)], order_[static_cast<Size>(j)]);
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
               held(part.inner);
    for (const Packets& wall : part.walls) {
      f.listed += wall.source.size();
      f.pairs += held(wall);
    }
  }
  return f;
}

/// Whether beads may have moved so far, relative to their mean displacement, that an unlisted pair is within
/// the margin of the inner list.
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
  // The comparison is negated so that a NaN position makes the list stale; the build then detects it.
  since_built_ = std::sqrt(first) + std::sqrt(second);
  return !(since_built_ + margin_ <= skin_);
}

/// Sorts by two keys, of which the first is below n: a counting sort by the first key, then a comparison sort
/// of the few elements with equal first key by the second.
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

/// Adapts the skin. A wide skin makes builds of the outer list rare, but the list long. The cost is least
/// where building the list costs as much as the passes through it. Per bead the search costs some hundred
/// times as much as a pass costs per pair. A dense bed therefore keeps only its first shell, and a dilute gas
/// has a wide skin.
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
  // Search: collect all pairs within the skin.
  System s = given;  // the search needs positions by bead
  beads_.store(s, order_);
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
                       // Bead i is the one with the lower number, whatever the order in memory, so that a
                       // remembered vector keeps its sign.
                       found.push_back({rank_[static_cast<Size>(a)], rank_[static_cast<Size>(b)], shift});
                     });
  found = in_order_of(
      std::move(found), beads_.size(), [](const Found& f) { return std::min(f.i, f.j); },
      [](const Found& f) { return std::max(f.i, f.j); });
  // Remembered contacts: index of the first one of each bead i.
  std::vector<std::size_t> first(s.beads.size() + 1, 0);
  for (const ContactMemory& m : remembered) ++first[static_cast<Size>(m.i) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  const bool periodic = s.period[0] > 0 || s.period[1] > 0 || s.period[2] > 0;
  // Distribution: each thread gets the pairs of its beads, with shifts, constants and remembered numbers.
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
    part.inner = {};
    // Walls: make_walls() carries wall contacts over from list to list; restored ones are added here.
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
  // Bookkeeping: the positions of this build are the reference for the displacements.
  built_.resize(beads_.size());
  for (Size k = 0; k < beads_.size(); ++k) built_[k] = beads_.position(k);
  since_built_ = 0;
  wall_refresh_ = all_walls_ = true;
  ++builds_;
}

/// Builds the inner list: the pairs of the outer list that may touch soon. Pairs are distributed so that the
/// lanes of a packet are far apart in space; a packet then seldom contains a bead twice.
void ListSolver::make_inner(Part& part) {
  Packets& a = part.inner;
  // Memory: numbers remembered in the old inner list return to the pairs of the outer list.
  for (Size packet = 0, at = 0; memory_ > 0 && packet < static_cast<Size>(a.count); ++packet)
    for (Size lane = 0; lane < width_; ++lane, ++at) {
      if (a.source[at] < 0) continue;
      const Size pair = static_cast<Size>(a.source[at]);
      const double* from = a.memory.data() + packet * memory_ * width_ + lane;
      for (Size m = 0; m < memory_; ++m) part.memory[pair * memory_ + m] = from[m * width_];
      if (remembers(from, width_)) part.remembering.push_back(a.source[at]);
    }
  // Scan: mark the pairs that touch or that free flight brings close.
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
  kernels_.scan(scan);
  // A pair that has just separated may still have to update or clear its remembered numbers.
  for (const std::int32_t pair : part.remembering) {
    const Size r = static_cast<Size>(pair);
    part.near[r / width_] = static_cast<std::uint16_t>(part.near[r / width_] | 1U << r % width_);
  }
  part.remembering.clear();

  // Chunks: within each chunk, pairs in contact come first. Packets of pairs that are only near are skipped
  // after a distance test.
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
  // Packing: copy indices, constants, shifts and memory in the order of the packets.
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

/// Lists the beads near each wall.
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

/// Bound on the difference of any two velocities, and largest magnitude of a component.
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
  // Velocities: store the reference for free flight and find their range.
  VelocityRange range{};
  for (Size p = 0; p < parts_.size(); ++p) {
    const VelocityRange own = kernels_.range({beads_.records(), reference_.data(), all_of(parts_[p])});
    for (int k = 0; k < 3; ++k) {
      range.least[k] = p == 0 ? own.least[k] : std::min(range.least[k], own.least[k]);
      range.most[k] = p == 0 ? own.most[k] : std::max(range.most[k], own.most[k]);
    }
  }
  fastest_ = fastest(range);
  for (int k = 0; k < 3; ++k) least_[k] = range.least[k], most_[k] = range.most[k];
  // Slack: if the last list was short-lived, the slack was too small; if the deflection stayed well below it,
  // too large.
  if (lasted_ < kShort)
    slack_ *= 2;
  else if (deviated_ < 0.25 * slack_)
    slack_ *= 0.5;
  slack_ = std::clamp(slack_, 1e-5 * skin_, 0.1 * skin_);
  // Horizon: an airborne bed has few near pairs, so building the list costs more than passing through it, and
  // the horizon is longer.
  Size active = 0, listed = 0;
  for (const Part& part : parts_) active += part.evaluated, listed += part.pairs;
  const double horizon_steps = 4 * active < listed ? kLongHorizon : kHorizon;
  // The horizon is limited so that no bead can arrive from outside the outer list.
  horizon_ = std::min(horizon_steps * s.dt, 0.5 * skin_ / std::max(spread(range), 1e-300));
  margin_ = horizon_ * spread(range) + 2 * slack_;
  // Outer list: the approach of any two beads since its build is at most the sum of the margins of the inner
  // lists since. Displacements are measured only when this bound no longer suffices.
  since_built_ += last_margin_;
  last_margin_ = margin_;
  if (rebuild_every_ > 0 && calls_ % rebuild_every_ == 0) built_.clear(), since_built_ = HUGE_VAL;
  if (!(since_built_ + margin_ <= skin_) && outer_is_stale()) make_outer(s);
  deviated_ = 0;
  lasted_ = 0;
  ++looks_;
  ++counters_.near_refreshes;
}

/// Bound on the speed at which beads approach a wall that moves with velocity `way`: the velocities at the
/// last inner list, plus `added`, the change by contacts and gravity since.
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

/// Determines which groups of beads are active: those with a bead in an inner or wall list.
void ListSolver::activate(const System& s, Part& part) {
  const Size n = (part.end - part.begin + group() - 1) / group();
  // If most groups are active, a distinction does not pay. Drag acts on all beads.
  const bool all = s.plate_drag > 0 || 2 * part.evaluated * group() > part.end - part.begin;
  part.is_active.assign(n, all ? 1 : 0);
  const auto wake = [&](std::int32_t place) {
    const Size k = static_cast<Size>(place);
    if (k >= part.begin && k < part.end) part.is_active[(k - part.begin) / group()] = 1;
  };
  for (const std::int32_t pair : part.inner.source) {
    if (pair < 0 || all) continue;
    wake(part.i[static_cast<Size>(pair)]);
    wake(part.j[static_cast<Size>(pair)]);
  }
  for (const Packets& wall : part.walls)
    for (const std::int32_t bead : wall.source) wake(bead);
  part.active_runs.clear(), part.inactive_runs.clear();
  Size g = 0;
  for (Chunk& chunk : part.chunks) {
    const Size of_before = part.active_runs.size();  // runs of active beads end with their chunk
    for (Size begin = part.begin + g * group(); g < n && begin < chunk.bead_end; ++g, begin += group()) {
      const bool active = part.is_active[g] != 0;
      std::vector<BeadRange>& runs = active ? part.active_runs : part.inactive_runs;
      const auto first = static_cast<std::int64_t>(begin),
                 end = static_cast<std::int64_t>(std::min(begin + group(), part.end));
      if (runs.size() > (active ? of_before : 0) && runs.back().end == first)
        runs.back().end = end;
      else
        runs.push_back({first, end});
    }
    chunk.active_end = part.active_runs.size();
  }
}

/// Advances inactive beads to the present step.
void ListSolver::advance_to_now(Part& part) {
  if (part.behind > 0 && !part.inactive_runs.empty()) {
    FreeFlightArgs a{};
    a.records = beads_.records();
    a.runs = part.inactive_runs.data();
    a.n_runs = static_cast<std::int64_t>(part.inactive_runs.size());
    a.steps = part.behind;
    a.dt = integrate_args_.dt;
    for (int k = 0; k < 3; ++k) a.gravity[k] = integrate_args_.gravity[k];
    kernels_.fly(a);
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
  const Deviation own = kernels_.integrate(a);
  for (int k = 0; k < 3; ++k) part.deviation.most[k] = std::max(part.deviation.most[k], own.most[k]);
}

/// After a drift: updates the bounds on the approach of beads to each other and to walls, and decides which
/// lists must be refreshed.
void ListSolver::add_up_motion(const System& s) {
  double deviation[3] = {0, 0, 0};
  for (const Part& part : parts_)
    for (int k = 0; k < 3; ++k) deviation[k] = std::max(deviation[k], part.deviation.most[k]);
  const double strayed = length(deviation);
  deviated_ += s.dt * strayed;
  ++lasted_;
  const bool forced = rebuild_every_ > 0 && ++calls_ % rebuild_every_ == 0;
  // The comparisons are negated so that NaN forces a refresh.
  pair_refresh_ = forced || !(deviated_ <= slack_ && static_cast<double>(lasted_) * s.dt < horizon_);
  wall_refresh_ = all_walls_ = forced;
  const double added = strayed + static_cast<double>(lasted_) * s.dt * s.gravity.norm();
  speed_bound_ = fastest_ + added;
  // The displacement of a wall is its actual one in this step, not its velocity at one end of the step.
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
  Packets& a = part.inner;
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
  p.quantum = quantum_;
  part.overlap = std::max(part.overlap, kernels_.pairs(p));
  part.visits += p.packets;
}

/// Forces of walls, and plate drag.
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
    g.quantum = quantum_;
    part.overlap = std::max(part.overlap, kernels_.walls(g));
    part.wall_visits += near.count;
  }
  if (s.plate_drag > 0) {
    const Vec3 v = plate_velocity_ * Vec3::Unit(static_cast<int>(s.drive.axis));
    beads_.add_plate_drag(s, v.x(), v.z(), part.begin, part.end);
  }
}

void ListSolver::forces(const System& s, Part& part) {
  wall_forces(s, part);
  if (part.inner.count > 0) pair_forces(s, part, 0, static_cast<Size>(part.inner.count));
}

/// Computes all forces. The next step of a bead follows as soon as its contacts are complete, while its
/// record, force and neighbours are still in the first-level cache.
void ListSolver::forces_and_integrate(const System& s, Part& part) {
  wall_forces(s, part);
  part.deviation = {};
  Size packet = 0, active = 0;
  for (const Chunk& chunk : part.chunks) {
    if (chunk.packet_end > packet) pair_forces(s, part, packet, chunk.packet_end);
    if (chunk.active_end > active)
      integrate(part, part.active_runs.data() + active, chunk.active_end - active, 2, true);
    packet = chunk.packet_end, active = chunk.active_end;
  }
  ++part.behind;
}

/// Stops the run if an overlap exceeds the bound.
/// \param drifted the beads have already moved one step further; the drift is undone
/// for the report
void ListSolver::check_overlap(System& s, bool drifted) {
  double overlap = 0;
  for (const Part& part : parts_) overlap = std::max(overlap, part.overlap);
  if (overlap <= limits_.overlap) return;
  for (Part& part : parts_) advance_to_now(part);
  if (drifted) beads_.drift(-s.dt);
  beads_.store(s, order_);
  explain_overlap(s, limits_);
}

void ListSolver::check_speed(System& s) {
  if (speed_bound_ * s.dt <= limits_.travel_per_step) return;
  for (Part& part : parts_) advance_to_now(part);
  beads_.store(s, order_);
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
  // Two barriers per step: after the first the positions are new, after the second the forces are complete.
  // Work that one thread does for all is done in the completion function of the barrier.
  std::exception_ptr failure;
  bool moved = true;  // false: the forces are complete
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
  // Lists are refreshed at every call: the caller may have changed the plate and the beads.
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
  beads_.store(s, order_);
  check_motion(s, limits_);
}

}  // namespace

std::unique_ptr<Solver> make_list_solver(const Plan& plan, const GuardLimits& limits, const Target& target,
                                         int threads) {
  return std::make_unique<ListSolver>(plan, limits, target, threads);
}

}  // namespace twincell::sim
