#include "sim/stepping/outer_list.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/cancellation.hpp"
#include "sim/system/cell_grid.hpp"

namespace twincell::sim {

namespace {

using Size = std::size_t;

/// Sorts by two keys, of which the first is below n, without a second array: each element is swapped to the
/// place that a counting sort by the first key gives it, and a comparison sort orders the few elements with
/// equal first key by the second. Where no two elements agree in both keys, the result is unique.
template <class T, class First, class Second>
void sort_by(std::vector<T>& all, Size n, First first, Second second) {
  const auto bin = [&](const T& t) { return static_cast<Size>(first(t)); };
  std::vector<Size> next(n + 1, 0);  // place of the next element of each bin
  for (const T& t : all) ++next[bin(t) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  const std::vector<Size> begin = next;
  for (Size k = 0; k < n; ++k) {
    while (next[k] < begin[k + 1]) {
      T& t = all[next[k]];
      const Size home = bin(t);
      if (home != k) std::swap(t, all[next[home]]);
      ++next[home];
    }
    std::sort(all.begin() + static_cast<std::ptrdiff_t>(begin[k]),
              all.begin() + static_cast<std::ptrdiff_t>(begin[k + 1]),
              [&](const T& x, const T& y) { return second(x) < second(y); });
  }
}

bool is_own(const BeadShare& share, const NearPair& pair) {
  return share.owns(pair.i) || share.owns(pair.j);
}

double base_skin(double usual_radius) {
  return kListReach * 2 * usual_radius;
}

}  // namespace

void OuterPairs::divide_into_chunks(const BeadShare& share, const std::vector<NearPair>& found) {
  chunk_end.clear();
  Size reached = 0;
  auto next = found.begin();
  for (Size end = share.begin; end < share.end;) {
    end = std::min(end + kChunkBeads, share.end);
    for (; next != found.end() && static_cast<Size>(std::min(next->i, next->j)) < end; ++next)
      if (is_own(share, *next)) ++reached;
    chunk_end.push_back(reached);
  }
}

void OuterPairs::assign(const ListedBeads& beads, const BeadShare& share, const std::vector<NearPair>& found,
                        const RememberedContacts& remembered, const std::array<double, 3>& period) {
  const PacketLayout& layout = beads.layout;
  const PackedBeads& packed = beads.packed;
  const bool periodic = period[0] > 0 || period[1] > 0 || period[2] > 0;
  throw_if_cancelled();
  divide_into_chunks(share, found);
  pairs = chunk_end.empty() ? 0 : chunk_end.back();
  const Size packets = layout.packets(pairs), padded = packets * layout.width;
  assign_closely(i, padded, layout.record(share.dummy)),
      assign_closely(j, padded, layout.record(share.dummy));
  assign_closely<std::uint16_t>(near, packets, 0), assign_closely<std::uint16_t>(touching, packets, 0);
  assign_closely<double>(shift, periodic ? padded * layout.dimension : 0, 0);
  assign_closely<double>(memory, pairs * layout.memory, 0);
  assign_closely<double>(reach, packed.equal() ? 0 : padded, 0);
  remembering.clear();
  if (packed.equal() || pairs == 0) constants.clear();
  Size at = 0;
  for (const NearPair& f : found) {
    if (!is_own(share, f)) continue;
    const Size p = at++;
    const Size a = static_cast<Size>(f.i), b = static_cast<Size>(f.j);
    i[p] = layout.record(f.i), j[p] = layout.record(f.j);
    if (periodic)
      for (Size c = 0; c < layout.dimension; ++c) {
        const Size axis = layout.dimension == 2 && c == 1 ? 2 : c;
        shift[layout.index(p, layout.dimension, c)] = f.images[axis] * period[axis];
      }
    if (!packed.equal()) {
      const double ra = packed.radius(a), rb = packed.radius(b);
      const auto set = pair_constants(beads.plan, packed, a, b);
      if (p == 0) resize_closely(constants, pairs * set.size());
      std::copy(set.begin(), set.end(), constants.begin() + static_cast<std::ptrdiff_t>(p * set.size()));
      reach[p] = ra + rb;
    }
    if (layout.memory == 0 || remembered.empty()) continue;
    if (const double* numbers = remembered.find(beads.order.bead[a], beads.order.bead[b])) {
      std::copy_n(numbers, layout.memory, memory.begin() + static_cast<std::ptrdiff_t>(p * layout.memory));
      remembering.push_back(static_cast<std::int32_t>(p));
    }
  }
}

void OuterList::set_limits(const System& s) {
  // Second neighbours of a hexagonal packing are at 1.73 sigma, so a skin of a quarter diameter adds no pairs
  // there. The diameter is the median: one bead a hundred times larger must not lengthen the lists of the
  // small beads.
  std::vector<double> radii;
  for (const Bead& b : s.beads) radii.push_back(b.radius);
  const double largest = *std::max_element(radii.begin(), radii.end());
  const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), middle, radii.end());
  usual_radius_ = *middle;
  const double base = base_skin(usual_radius_);
  widest_skin_ = 3 * 2 * usual_radius_;
  for (const double period : s.period)  // a bead must not reach two images of another
    if (period > 0) widest_skin_ = std::min(widest_skin_, 0.5 * period - 2 * largest);
  widest_skin_ = std::max(widest_skin_, base);
  if (skin_ == 0) skin_ = base;
}

void OuterList::distrust() {
  approach_ = HUGE_VAL;
}

void OuterList::discard() {
  built_.clear();
  distrust();
}

bool OuterList::is_stale(const PackedBeads& beads, double margin) {
  // The approach of any two beads since the build is at most the sum of the margins of the inner lists since.
  // Displacements are measured only when this bound no longer suffices.
  approach_ += last_margin_;
  last_margin_ = margin;
  return !(approach_ + margin <= skin_) && have_crossed(beads, margin);
}

/// Whether beads may have moved so far, relative to their mean displacement, that an unlisted pair is within
/// the margin of the inner list.
bool OuterList::have_crossed(const PackedBeads& beads, double margin) {
  if (built_.size() != beads.size()) return true;
  Vec3 mean = Vec3::Zero();
  for (Size k = 0; k < beads.size(); ++k) mean += beads.position(k) - built_[k];
  mean /= static_cast<double>(std::max<Size>(1, beads.size()));
  double first = 0, second = 0;  // squares of the two largest displacements
  for (Size k = 0; k < beads.size(); ++k) {
    const double d = (beads.position(k) - built_[k] - mean).squaredNorm();
    if (!(d <= first)) {
      second = first;
      first = d;
    } else if (d > second) {
      second = d;
    }
  }
  // The comparison is negated so that a NaN position makes the list stale; the build then detects it.
  approach_ = std::sqrt(first) + std::sqrt(second);
  return !(approach_ + margin <= skin_);
}

/// A wide skin makes builds of the outer list rare, but the list long. The cost is least where building the
/// list costs as much as the passes through it. Per bead the search costs some hundred times as much as a
/// pass costs per pair. A dense bed therefore keeps only its first shell, and a dilute gas has a wide skin.
void OuterList::adapt_skin(int dimension, Size beads, Size listed) {
  constexpr double kSearch = 400;
  const double search = kSearch * static_cast<double>(beads),
               passes = static_cast<double>(inner_lists_) * static_cast<double>(listed);
  if (inner_lists_ == 0) return;
  inner_lists_ = 0;
  if (search > 2 * passes && 3 * listed < 2 * most_listed_pairs(dimension) * beads) skin_ *= 1.25;
  if (passes > 2 * search) skin_ *= 0.8;
  skin_ = std::clamp(skin_, 0.2 * usual_radius_, widest_skin_);
}

std::vector<NearPair> OuterList::search(const System& s, const BeadOrder& order) {
  const Size most = most_listed_pairs(s.dimension) * s.beads.size();
  const double base = base_skin(usual_radius_);
  for (;;) {
    std::vector<NearPair> found = pairs_within_skin(s, order);
    if (found.size() <= most || skin_ <= base) return found;
    skin_ = std::max(0.8 * skin_, base);
  }
}

std::vector<NearPair> OuterList::pairs_within_skin(const System& s, const BeadOrder& order) {
  std::vector<NearPair> found;
  found.reserve(found_ + found_ / 16);
  for_each_near_pair(
      s.beads, s.dimension, s.period, skin_, [&](std::int32_t a, std::int32_t b, double, const Vec3& shift) {
        // Bead i is the one with the lower number, whatever the order in memory, so that a
        // remembered vector keeps its sign.
        NearPair pair{order.place[static_cast<Size>(a)], order.place[static_cast<Size>(b)], {}};
        for (int k = 0; k < 3; ++k)
          if (const double p = s.period[static_cast<Size>(k)]; p > 0)
            pair.images[static_cast<Size>(k)] = static_cast<std::int32_t>(std::lround(shift[k] / p));
        found.push_back(pair);
      });
  found_ = found.size();
  sort_by(
      found, s.beads.size(), [](const NearPair& f) { return std::min(f.i, f.j); },
      [](const NearPair& f) { return std::max(f.i, f.j); });
  return found;
}

void OuterList::set_reference(const PackedBeads& beads) {
  built_.resize(beads.size());
  for (Size k = 0; k < beads.size(); ++k) built_[k] = beads.position(k);
  approach_ = 0;
  ++builds_;
}

}  // namespace twincell::sim
