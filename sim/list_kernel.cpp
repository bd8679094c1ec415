#include "sim/list_kernel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <barrier>
#include <bit>
#include <cmath>
#include <exception>
#include <numeric>
#include <thread>

#include "sim/cell_grid.hpp"
#include "sim/packed.hpp"

namespace twincell::sim {

namespace {

using Size = std::size_t;

/// For how many steps the inner list is meant to last at most, and fewer than how many are a reason to be
/// more generous.
constexpr double kHorizon = 64, kLongHorizon = 256, kShort = 24;
constexpr double kWallSteps = 256;
/// Pairs are dealt to packets in blocks of so many packets: the lanes of a packet are far enough apart that a
/// bead seldom stands twice in it, and near enough that a block stays in the first-level cache.
constexpr std::size_t kBlock = 32;

/// A list of contacts in packets: what a pass reads.
struct Packets {
  std::vector<std::int32_t> i, j, force_i, force_j;
  std::vector<double> memory, constants, shift;
  std::vector<std::int32_t> source;  ///< where each came from, in order
  std::int64_t count = 0;            ///< packets

  /// Packet and lane of the r-th of the list: a block is filled lane by lane.
  [[nodiscard]] std::pair<Size, Size> place(Size r, Size width) const {
    const Size block = r / (kBlock * width), first = block * kBlock;
    const Size packets = std::min(kBlock, static_cast<Size>(count) - first), within = r - first * width;
    return {first + within % packets, within / packets};
  }
  /// Calls visit(r, packet, lane) for every place r of `length`, in order, without their divisions.
  template <class Visit>
  void for_each_place(Size length, Size width, Visit visit) const {
    Size r = 0;
    for (Size first = 0; first < static_cast<Size>(count); first += kBlock) {
      const Size packets = std::min(kBlock, static_cast<Size>(count) - first);
      for (Size lane = 0; lane < width; ++lane)
        for (Size p = 0; p < packets && r < length; ++p, ++r) visit(r, first + p, lane);
    }
  }
};

/// The beads of one thread, begin .. end, and every contact of theirs. A pair across two threads is reckoned
/// by both, each adding to its own bead: no two threads write to one place, and the bits are those of one
/// thread.
struct Part {
  Size begin = 0, end = 0;
  std::int32_t dummy = 0;  ///< a place behind the beads that touches nothing
  // Outer list, padded to whole packets.
  std::vector<std::int32_t> i, j;
  std::vector<double> shift, reach, constants, memory;
  std::vector<std::int32_t> record_i, record_j;  ///< where their records begin
  std::vector<std::uint16_t> near, touching;
  Size pairs = 0;
  Packets active;
  std::vector<Packets> walls;
  double overlap = 0;
  Deviation deviation{};
  std::int64_t visits = 0, wall_visits = 0;
};

class ListKernel : public Kernel {
 public:
  ListKernel(const Plan& plan, const GuardLimits& limits, const Target& target, int threads)
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

 private:
  void prepare(const System& s);
  void sort_beads(const System& s);
  void make_outer(const System& s);
  void make_inner(Part& part);
  void make_walls(const System& s, Part& part);
  [[nodiscard]] bool outer_is_stale();
  void refresh_pairs(System& s);
  void refresh_walls(const System& s);
  void drift(System& s);
  void add_up_motion(const System& s);
  void forces(const System& s, Part& part);
  void after_forces(System& s);
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
  void integrate(Part& part, int kicks, bool drift);

  Plan plan_;
  GuardLimits limits_;
  const Target& target_;
  Passes passes_;
  int threads_;
  Size width_ = 1, dimension_ = 2, memory_ = 0;
  double magic_ = 0;

  PackedBeads beads_;
  std::vector<std::int32_t> order_, rank_;  ///< place -> bead, bead -> place
  std::vector<Part> parts_;
  std::vector<double> pair_constants_;               ///< of equal beads, broadcast over lanes
  std::vector<std::vector<double>> wall_constants_;  ///< the same for each wall
  std::vector<ContactMemory> restored_;

  double skin_ = 0, largest_radius_ = 0;
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
  bool first_kick_ = true, wall_refresh_ = false, pair_refresh_ = false;
  double plate_ = 0, plate_velocity_ = 0, plate_before_ = 0;
  IntegrateArgs integrate_args_{};
  std::int64_t builds_ = 0, rebuild_every_ = 0, calls_ = 0;
  Counters counters_;
};

Size packets_of(Size n, Size width) {
  return (n + width - 1) / width;
}

std::vector<double> ListKernel::broadcast(const std::vector<double>& set) const {
  std::vector<double> lanes(set.size() * width_);
  for (Size m = 0; m < set.size(); ++m)
    std::fill_n(lanes.begin() + static_cast<std::ptrdiff_t>(m * width_), width_, set[m]);
  return lanes;
}

/// Beads in the order of the cells they are in, so that neighbours in space are neighbours in memory.
void ListKernel::sort_beads(const System& s) {
  order_.resize(s.beads.size());
  std::iota(order_.begin(), order_.end(), 0);
  const double cell = 3 * largest_radius_;
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

void ListKernel::prepare(const System& s) {
  largest_radius_ = 0;
  for (const Bead& b : s.beads) largest_radius_ = std::max(largest_radius_, b.radius);
  // Second neighbours of a hexagonal packing sit at 1.73 sigma: a skin of a quarter diameter adds no pairs
  // there.
  skin_ = kListReach * 2 * largest_radius_;
  if (order_.size() != s.beads.size()) {
    restored_ = restored_.empty() ? contacts() : std::move(restored_);
    sort_beads(s);
    // A thread is worth its barriers from some ten thousand beads on.
    const Size most = std::max<Size>(1, s.beads.size() / 8192);
    const Size wanted =
        threads_ > 0 ? static_cast<Size>(threads_) : std::max(1U, std::thread::hardware_concurrency());
    parts_.assign(std::clamp<Size>(wanted, 1, threads_ > 0 ? std::max<Size>(1, s.beads.size()) : most), {});
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

std::vector<ContactMemory> ListKernel::contacts() const {
  std::vector<ContactMemory> all = restored_;
  const auto keep = [&](const Packets& p, Size at, std::int32_t i, std::int32_t j) {
    const auto [packet, lane] = p.place(at, width_);
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

/// Beads have moved, against their mean, so far that an unlisted pair may be within the inner margin.
bool ListKernel::outer_is_stale() {
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

void ListKernel::make_outer(const System& given) {
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
  std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
    const auto lo = std::min(a.i, a.j), mo = std::min(b.i, b.j);
    return lo != mo ? lo < mo : std::max(a.i, a.j) < std::max(b.i, b.j);
  });
  const bool periodic = s.period[0] > 0 || s.period[1] > 0 || s.period[2] > 0;
  for (Part& part : parts_) {
    const auto mine = [&](std::int32_t k) {
      return static_cast<Size>(k) >= part.begin && static_cast<Size>(k) < part.end;
    };
    part.i.clear(), part.j.clear(), part.shift.clear(), part.reach.clear(), part.constants.clear(),
        part.memory.clear();
    std::vector<const Found*> own;
    for (const Found& f : found)
      if (mine(f.i) || mine(f.j)) own.push_back(&f);
    part.pairs = own.size();
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
        const auto at =
            std::lower_bound(remembered.begin(), remembered.end(), std::pair(i, j),
                             [](const ContactMemory& m, const std::pair<std::int32_t, std::int32_t>& key) {
                               return m.i != key.first ? m.i < key.first : m.j < key.second;
                             });
        if (at != remembered.end() && at->i == i && at->j == j)
          std::copy(at->values.begin(), at->values.end(),
                    part.memory.begin() + static_cast<std::ptrdiff_t>(p * memory_));
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
        const auto [packet, lane] = kept.place(at, width_);
        for (Size v = 0; v < memory_; ++v) kept.memory[(packet * memory_ + v) * width_ + lane] = m.values[v];
      }
      part.walls[w] = std::move(kept);
    }
  }
  built_.resize(beads_.size());
  for (Size k = 0; k < beads_.size(); ++k) built_[k] = beads_.position(k);
  since_built_ = 0;
  wall_refresh_ = true;
  ++builds_;
}

/// The pairs of the outer list with a gap below margin_, dealt out so that the lanes of a packet are far
/// apart in space: then one bead seldom stands twice in a packet.
void ListKernel::make_inner(Part& part) {
  Packets& a = part.active;
  // What the old list remembers goes back to the pairs.
  if (memory_ > 0)
    a.for_each_place(a.source.size(), width_, [&](Size r, Size packet, Size lane) {
      const Size from = static_cast<Size>(a.source[r]);
      for (Size m = 0; m < memory_; ++m)
        part.memory[from * memory_ + m] = a.memory[(packet * memory_ + m) * width_ + lane];
    });
  ScanArgs scan{};
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
  for (Size r = 0; r < part.pairs && memory_ > 0; ++r)
    if (remembers(part.memory.data() + r * memory_, 1))
      part.near[r / width_] = static_cast<std::uint16_t>(part.near[r / width_] | 1U << r % width_);

  // Those in contact first: packets of pairs that are merely near are passed over after a look at their
  // distances.
  a.source.clear();
  const auto collect = [&](auto bits_of) {
    for (Size k = 0; k < part.near.size(); ++k)
      for (unsigned bits = bits_of(k); bits != 0; bits &= bits - 1)
        a.source.push_back(static_cast<std::int32_t>(k * width_ + static_cast<Size>(std::countr_zero(bits))));
  };
  collect([&](Size k) -> unsigned { return part.touching[k]; });
  collect([&](Size k) -> unsigned { return part.near[k] & ~static_cast<unsigned>(part.touching[k]); });
  const Size n = a.source.size(), count = packets_of(n, width_), padded = count * width_;
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
  a.for_each_place(padded, width_, [&](Size r, Size packet, Size lane) {
    const Size at = packet * width_ + lane;
    const auto set = [&](std::vector<double>& numbers, Size of, auto value) {
      for (Size m = 0; m < of; ++m) numbers[(packet * of + m) * width_ + lane] = value(m);
    };
    if (r >= n) {
      a.i[at] = a.j[at] = record(part.dummy);
      if (many) a.force_i[at] = a.force_j[at] = record(part.dummy);
      set(a.memory, memory_, [](Size) { return 0.0; });
      set(a.constants, constants, [](Size) { return 1.0; });
      if (shifted) set(a.shift, dimension_, [](Size) { return 0.0; });
      return;
    }
    const Size from = static_cast<Size>(a.source[r]);
    a.i[at] = part.record_i[from], a.j[at] = part.record_j[from];
    if (many) a.force_i[at] = record(own(part.i[from])), a.force_j[at] = record(own(part.j[from]));
    set(a.memory, memory_, [&](Size m) { return part.memory[from * memory_ + m]; });
    set(a.constants, constants, [&](Size m) { return part.constants[from * constants + m]; });
    if (shifted)
      set(a.shift, dimension_,
          [&](Size c) { return part.shift[(from / width_ * dimension_ + c) * width_ + from % width_]; });
  });
}

/// Beads near each wall.
void ListKernel::make_walls(const System& s, Part& part) {
  for (Size w = 0; w < part.walls.size(); ++w) {
    const Wall& wall = s.walls[w];
    const double offset = offset_now(s, wall);
    Packets old = std::move(part.walls[w]);
    Packets near;
    Size known = 0;
    for (Size k = part.begin; k < part.end; ++k) {
      while (known < old.source.size() && static_cast<Size>(old.source[known]) < k) ++known;
      const bool was = known < old.source.size() && static_cast<Size>(old.source[known]) == k;
      const auto [packet, lane] = was ? old.place(known, width_) : std::pair<Size, Size>();
      if (!(beads_.position(k).dot(wall.n) - offset - beads_.radius(k) >= wall_margin_[w]) ||
          (was && remembers(old.memory.data() + packet * memory_ * width_ + lane, width_)))
        near.source.push_back(static_cast<std::int32_t>(k));
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
      const auto [packet, lane] = near.place(r, width_);
      const Size k = static_cast<Size>(near.source[r]);
      near.i[packet * width_ + lane] = record(near.source[r]);
      while (before < old.source.size() && old.source[before] < near.source[r]) ++before;
      if (before < old.source.size() && old.source[before] == near.source[r]) {
        const auto [old_packet, old_lane] = old.place(before, width_);
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

/// Smallest and largest component of the velocities of all beads.
struct VelocityRange {
  double least[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, most[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  void include(const double* v, int n) {
    for (int k = 0; k < n; ++k) least[k] = std::min(least[k], v[k]), most[k] = std::max(most[k], v[k]);
    for (int k = n; k < 3; ++k) least[k] = most[k] = 0;
  }
  [[nodiscard]] double spread() const {
    double s = 0;
    for (int k = 0; k < 3; ++k) s += (most[k] - least[k]) * (most[k] - least[k]);
    return std::sqrt(s);
  }
  [[nodiscard]] double fastest() const {
    double s = 0;
    for (int k = 0; k < 3; ++k) s = std::max({s, -least[k], most[k]});
    return s;
  }
};

double length(const double* v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

void ListKernel::refresh_pairs(System& s) {
  // Velocities from which free flight is reckoned.
  VelocityRange range;
  const Size stride = dimension_ == 2 ? kRecord<2> : kRecord<3>, at = stride / 2;
  for (Size k = 0; k < beads_.size(); ++k) {
    const double* v = beads_.records() + stride * k + at;
    range.include(v, static_cast<int>(dimension_));
    std::copy_n(beads_.records() + stride * k + (dimension_ == 2 ? 0 : 4), 4, reference_.data() + 4 * k);
  }
  fastest_ = range.fastest();
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
  for (const Part& part : parts_) active += part.active.source.size(), listed += part.pairs;
  const double horizon_steps = 4 * active < listed ? kLongHorizon : kHorizon;
  // Not so far ahead that beads could come in from beyond the outer list.
  horizon_ = std::min(horizon_steps * s.dt, 0.5 * skin_ / std::max(range.spread(), 1e-300));
  margin_ = horizon_ * range.spread() + 2 * slack_;
  // What any two beads may have approached since the outer list was made is at most what they may have in
  // each stretch between looks; only when that no longer suffices are displacements measured.
  since_built_ += last_margin_;
  last_margin_ = margin_;
  if (rebuild_every_ > 0 && calls_ % rebuild_every_ == 0) built_.clear(), since_built_ = HUGE_VAL;
  if (!(since_built_ + margin_ <= skin_) && outer_is_stale()) make_outer(s);
  deviated_ = 0;
  lasted_ = 0;
  ++counters_.near_refreshes;
}

/// How fast beads may close in on a wall that moves by `way` per time: those of the last look, what contacts
/// and gravity have added since.
double ListKernel::closing(const Vec3& n, const Vec3& way, double added) const {
  double c = added;
  for (int k = 0; k < static_cast<int>(dimension_); ++k) {
    const int axis = dimension_ == 2 && k == 1 ? 2 : k;
    c += std::max(-n[axis] * (least_[k] - way[axis]), -n[axis] * (most_[k] - way[axis]));
  }
  return std::max(0.0, c);
}

void ListKernel::refresh_walls(const System& s) {
  for (Size w = 0; w < s.walls.size(); ++w) {
    Vec3 v = Vec3::Zero();
    if (s.walls[w].moves) v[static_cast<int>(s.drive.axis)] = plate_velocity_;
    wall_margin_[w] =
        std::clamp(kWallSteps * s.dt * (closing(s.walls[w].n, v, 0) + 0.1), 1e-5 * skin_, skin_);
    wall_approach_[w] = 0;
  }
}

void ListKernel::integrate(Part& part, int kicks, bool drift) {
  IntegrateArgs a = integrate_args_;
  a.begin = static_cast<std::int64_t>(part.begin), a.end = static_cast<std::int64_t>(part.end);
  a.kicks = kicks;
  a.drift = drift;
  a.reference = reference_.data();
  const double t = static_cast<double>(lasted_ + (kicks == 2 ? 1 : 0)) * a.dt;
  for (int k = 0; k < 3; ++k) a.fallen[k] = t * a.gravity[k];
  part.deviation = passes_.integrate(a);
}

/// After a drift: what may have approached what, and whether the lists still hold.
void ListKernel::add_up_motion(const System& s) {
  double deviation[3] = {0, 0, 0};
  for (const Part& part : parts_)
    for (int k = 0; k < 3; ++k) deviation[k] = std::max(deviation[k], part.deviation.most[k]);
  const double strayed = length(deviation);
  deviated_ += s.dt * strayed;
  ++lasted_;
  const bool forced = rebuild_every_ > 0 && ++calls_ % rebuild_every_ == 0;
  // Negated comparisons: what is not a number must not pass.
  pair_refresh_ = forced || !(deviated_ <= slack_ && static_cast<double>(lasted_) * s.dt < horizon_);
  wall_refresh_ = forced;
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

void ListKernel::forces(const System& s, Part& part) {
  PairArgs p{};
  p.records = beads_.records();
  p.spins = beads_.spins();
  p.forces = beads_.forces();
  Packets& a = part.active;
  p.i = a.i.data(), p.j = a.j.data();
  p.force_i = parts_.size() > 1 ? a.force_i.data() : p.i,
  p.force_j = parts_.size() > 1 ? a.force_j.data() : p.j;
  p.memory = a.memory.data();
  p.constants = beads_.equal() ? pair_constants_.data() : a.constants.data();
  p.constants_step =
      beads_.equal() || a.count == 0 ? 0 : static_cast<std::ptrdiff_t>(a.constants.size()) / a.count;
  p.shift = a.shift.empty() ? nullptr : a.shift.data();
  p.packets = a.count;
  p.dt = s.dt;
  p.locate = plan_.locate;
  p.magic = magic_;
  part.overlap = a.count > 0 ? passes_.pairs(p) : 0;
  part.visits += a.count;
  for (Size w = 0; w < part.walls.size(); ++w) {
    Packets& near = part.walls[w];
    if (near.count == 0) continue;
    const Wall& wall = s.walls[w];
    WallArgs g{};
    g.records = p.records, g.spins = p.spins, g.forces = p.forces;
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

void ListKernel::after_forces(System& s) {
  double overlap = 0;
  for (const Part& part : parts_) overlap = std::max(overlap, part.overlap);
  if (overlap <= limits_.overlap && speed_bound_ * s.dt <= limits_.travel_per_step) return;
  beads_.give(s, order_);
  if (!(overlap <= limits_.overlap)) explain_overlap(s, limits_);
  check_motion(s, limits_);
}

void ListKernel::run_serial(System& s, std::int64_t steps) {
  Part& part = parts_[0];
  for (std::int64_t k = 0; k < steps; ++k) {
    integrate(part, k == 0 ? 1 : 2, true);
    ++s.step;
    add_up_motion(s);
    if (pair_refresh_) {
      refresh_pairs(s);
      make_inner(part);
    }
    if (wall_refresh_) {
      refresh_walls(s);
      make_walls(s, part);
    }
    forces(s, part);
    after_forces(s);
  }
  integrate(part, 1, false);
}

void ListKernel::run_parallel(System& s, std::int64_t steps) {
  // Two meetings a step: positions are new; forces are complete. What one thread does for all happens in the
  // meeting.
  std::exception_ptr failure;
  bool moved = true;  // otherwise: forces are complete
  bool stop = false;
  const auto meet = [&]() noexcept {
    try {
      if (moved) {
        ++s.step;
        add_up_motion(s);
        if (pair_refresh_) refresh_pairs(s);
        if (wall_refresh_) refresh_walls(s);
      } else {
        after_forces(s);
      }
      moved = !moved;
    } catch (...) {
      failure = std::current_exception();
      stop = true;
    }
  };
  std::barrier barrier(static_cast<std::ptrdiff_t>(parts_.size()), meet);
  const auto work = [&](Part& part) {
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

void ListKernel::advance(System& s, std::int64_t steps) {
  if (s.beads.empty() || steps <= 0) {
    s.step += std::max<std::int64_t>(0, steps);
    return;
  }
  check_motion(s, limits_);
  const bool known = s.forces_known && s.forces.size() == s.beads.size();
  s.forces_known = known;
  prepare(s);
  integrate_args_ = beads_.integrate_args(s);
  wall_margin_.resize(s.walls.size(), 0), wall_approach_.resize(s.walls.size(), 0);
  plate_ = s.plate_height(), plate_velocity_ = s.plate_velocity(), plate_before_ = s.plate_height_before();
  // Lists are checked at every call: the plate and the beads may have been moved by other hands.
  since_built_ = HUGE_VAL;  // beads may have been moved by other hands
  reference_.resize(4 * s.beads.size());
  lasted_ = static_cast<std::int64_t>(kShort);
  refresh_pairs(s);
  refresh_walls(s);
  for (Part& part : parts_) {
    make_inner(part);
    make_walls(s, part);
  }
  if (!known) {
    for (Part& part : parts_) forces(s, part);
    after_forces(s);
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

std::unique_ptr<Kernel> make_list_kernel(const Plan& plan, const GuardLimits& limits, const Target& target,
                                         int threads) {
  return std::make_unique<ListKernel>(plan, limits, target, threads);
}

}  // namespace twincell::sim
