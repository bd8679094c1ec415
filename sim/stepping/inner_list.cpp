#include "sim/stepping/inner_list.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace twincell::sim {

namespace {

using Size = std::size_t;

/// Largest number of steps for which an inner list is built (kLongHorizon if few pairs are near). If a list
/// lasts fewer than kMinListSteps steps, the slack is increased.
constexpr double kHorizon = 64, kLongHorizon = 256;
constexpr std::int64_t kMinListSteps = 24;

/// Bound on the difference of any two velocities.
double spread(const VelocityRange& range) {
  double s = 0;
  for (int k = 0; k < 3; ++k) s += (range.most[k] - range.least[k]) * (range.most[k] - range.least[k]);
  return std::sqrt(s);
}

/// Appends the pairs begin .. end - 1 whose bits are set. \param bits_of one bit per lane of a packet
template <class Bits>
void collect(const PacketLayout& layout, Size begin, Size end, std::vector<std::int32_t>& to, Bits bits_of) {
  const Size width = layout.width;
  for (Size k = begin / width; k * width < end; ++k) {
    unsigned bits = bits_of(k);
    if (k * width < begin) bits &= ~0U << (begin - k * width);
    if ((k + 1) * width > end) bits &= (1U << (end - k * width)) - 1;
    for (; bits != 0; bits &= bits - 1)
      to.push_back(static_cast<std::int32_t>(k * width + static_cast<Size>(std::countr_zero(bits))));
  }
}

/// Marks the pairs that touch or that free flight brings close.
void find_near_pairs(ListedBeads& beads, OuterPairs& outer, double margin, double horizon) {
  const Size width = beads.layout.width;
  NearPairArgs scan{};
  scan.records = beads.packed.records();
  scan.i = outer.i.data(), scan.j = outer.j.data();
  scan.reach = beads.packed.equal() ? beads.of_pairs.data() : outer.reach.data();
  scan.reach_step = beads.packed.equal() ? 0 : static_cast<std::ptrdiff_t>(width);
  scan.shift = outer.shift.empty() ? nullptr : outer.shift.data();
  scan.packets = static_cast<std::int64_t>(outer.near.size());
  scan.margin = margin;
  scan.horizon = horizon;
  scan.near = outer.near.data();
  scan.touching = outer.touching.data();
  beads.kernels.scan(scan);
  // A pair that has just separated may still have to update or clear its remembered numbers.
  for (const std::int32_t pair : outer.remembering) {
    const Size r = static_cast<Size>(pair);
    outer.near[r / width] = static_cast<std::uint16_t>(outer.near[r / width] | 1U << r % width);
  }
  outer.remembering.clear();
}

}  // namespace

void InnerPairs::build(ListedBeads& beads, const BeadShare& share, OuterPairs& outer, double margin,
                       double horizon, bool split) {
  return_memory(beads.layout, outer);
  find_near_pairs(beads, outer, margin, horizon);
  distribute(beads.layout, share, outer);
  pack(beads.layout, share, outer, split);
}

/// Numbers remembered in the old inner list return to the pairs of the outer list.
void InnerPairs::return_memory(const PacketLayout& layout, OuterPairs& outer) const {
  const Size memory = layout.memory, width = layout.width;
  for (Size packet = 0, at = 0; memory > 0 && packet < static_cast<Size>(packets.count); ++packet)
    for (Size lane = 0; lane < width; ++lane, ++at) {
      if (packets.source[at] < 0) continue;
      const Size pair = static_cast<Size>(packets.source[at]);
      const double* from = packets.memory.data() + packet * memory * width + lane;
      for (Size m = 0; m < memory; ++m) outer.memory[pair * memory + m] = from[m * width];
      if (layout.remembers(from, width)) outer.remembering.push_back(packets.source[at]);
    }
}

/// Distributes the pairs so that the lanes of a packet are far apart in space; a packet then seldom contains
/// a bead twice. Within each chunk, pairs in contact come first. Packets of pairs that are only near are
/// skipped after a distance test.
void InnerPairs::distribute(const PacketLayout& layout, const BeadShare& share, const OuterPairs& outer) {
  std::vector<std::int32_t>& source = packets.source;
  source.clear(), chunks.clear();
  pairs = 0;
  Size most = 2 * layout.width * outer.chunk_end.size();  // padding
  for (Size k = 0; k < outer.near.size(); ++k)
    most += static_cast<Size>(std::popcount(static_cast<unsigned>(outer.near[k] | outer.touching[k])));
  resize_closely(source, most), source.clear();
  Size from = 0, bead_end = share.begin;
  for (Size c = 0; c < outer.chunk_end.size(); ++c) {
    const Size to = outer.chunk_end[c];
    bead_end = std::min(bead_end + kChunkBeads, share.end);
    collect(layout, from, to, touching_, [&](Size k) -> unsigned { return outer.touching[k]; });
    collect(layout, from, to, near_,
            [&](Size k) -> unsigned { return outer.near[k] & ~static_cast<unsigned>(outer.touching[k]); });
    from = to;
    const Size n = touching_.size() + near_.size();
    if (n < kChunkPackets * layout.width && c + 1 < outer.chunk_end.size()) continue;
    for (std::vector<std::int32_t>* kind : {&touching_, &near_}) {
      const Size first = source.size();
      source.resize(first + layout.packets(kind->size()) * layout.width, -1);
      Size at = first, lane = 0;
      for (const std::int32_t pair : *kind) {
        source[at] = pair;
        at += layout.width;
        if (at >= source.size()) at = first + ++lane;
      }
      kind->clear();
    }
    pairs += n;
    chunks.push_back({source.size() / layout.width, bead_end});
  }
}

/// Copies indices, constants, shifts and memory in the order of the packets.
void InnerPairs::pack(const PacketLayout& layout, const BeadShare& share, const OuterPairs& outer,
                      bool split) {
  ContactPackets& a = packets;
  const Size width = layout.width, dimension = layout.dimension, memory = layout.memory;
  const Size padded = a.source.size(), count = padded / width;
  const bool shifted = !outer.shift.empty();
  const Size constants = outer.pairs == 0 ? 0 : outer.constants.size() / outer.pairs;
  a.count = static_cast<std::int64_t>(count);
  resize_closely(a.i, padded), resize_closely(a.j, padded);
  if (split) resize_closely(a.force_i, padded), resize_closely(a.force_j, padded);
  resize_closely(a.memory, padded * memory);
  resize_closely(a.constants, padded * constants);
  resize_closely(a.shift, shifted ? padded * dimension : 0);
  const std::int32_t dummy = layout.record(share.dummy);
  const auto own = [&](std::int32_t record) { return share.owns(layout.place(record)) ? record : dummy; };
  for (Size packet = 0, at = 0; packet < count; ++packet)
    for (Size lane = 0; lane < width; ++lane, ++at) {
      const auto set = [&](std::vector<double>& numbers, Size of, auto value) {
        for (Size m = 0; m < of; ++m) numbers[(packet * of + m) * width + lane] = value(m);
      };
      if (a.source[at] < 0) {
        a.i[at] = a.j[at] = dummy;
        if (split) a.force_i[at] = a.force_j[at] = dummy;
        set(a.memory, memory, [](Size) { return 0.0; });
        set(a.constants, constants, [](Size) { return 1.0; });
        if (shifted) set(a.shift, dimension, [](Size) { return 0.0; });
        continue;
      }
      const Size pair = static_cast<Size>(a.source[at]);
      a.i[at] = outer.i[pair], a.j[at] = outer.j[pair];
      if (split) a.force_i[at] = own(outer.i[pair]), a.force_j[at] = own(outer.j[pair]);
      set(a.memory, memory, [&](Size m) { return outer.memory[pair * memory + m]; });
      set(a.constants, constants, [&](Size m) { return outer.constants[pair * constants + m]; });
      if (shifted)
        set(a.shift, dimension, [&](Size c) { return outer.shift[layout.index(pair, dimension, c)]; });
    }
}

void InnerList::reset(const PacketLayout& layout, Size beads) {
  reference_.resize(static_cast<Size>(layout.record(1)) / 2 * beads);
  steps_ = kMinListSteps;
}

void InnerList::measure_velocities(ListedBeads& beads, const std::vector<BeadShare>& shares) {
  for (Size p = 0; p < shares.size(); ++p) {
    const VelocityRange own =
        beads.kernels.range({beads.packed.records(), reference_.data(), shares[p].range()});
    for (int k = 0; k < 3; ++k) {
      range_.least[k] = p == 0 ? own.least[k] : std::min(range_.least[k], own.least[k]);
      range_.most[k] = p == 0 ? own.most[k] : std::max(range_.most[k], own.most[k]);
    }
  }
}

void InnerList::set_horizon(double dt, double skin, bool airborne) {
  // Slack: if the last list was short-lived, the slack was too small; if the deflection stayed well below it,
  // too large.
  if (steps_ < kMinListSteps)
    slack_ *= 2;
  else if (deviated_ < 0.25 * slack_)
    slack_ *= 0.5;
  // Horizon: an airborne bed has few near pairs, so building the list costs more than passing through it, and
  // the horizon is longer.
  horizon_ = (airborne ? kLongHorizon : kHorizon) * dt;
  limit_to(skin);
}

void InnerList::limit_to(double skin) {
  slack_ = std::clamp(slack_, 1e-5 * skin, 0.1 * skin);
  horizon_ = std::min(horizon_, 0.5 * skin / std::max(spread(range_), 1e-300));
  margin_ = horizon_ * spread(range_) + 2 * slack_;
}

void InnerList::begin() {
  deviated_ = 0;
  steps_ = 0;
}

void InnerList::add_step(double dt, double strayed) {
  deviated_ += dt * strayed;
  ++steps_;
}

bool InnerList::is_valid(double dt) const {
  return deviated_ <= slack_ && static_cast<double>(steps_) * dt < horizon_;
}

double InnerList::fastest() const {
  double s = 0;
  for (int k = 0; k < 3; ++k) s = std::max({s, -range_.least[k], range_.most[k]});
  return s;
}

}  // namespace twincell::sim
