#include "sim/stepping/wall_lists.hpp"

#include <algorithm>

namespace twincell::sim {

namespace {

using Size = std::size_t;

/// Steps for which a wall list is built.
constexpr double kWallSteps = 256;

/// Bound on the speed at which beads approach a wall that moves with velocity v: the velocities at the last
/// inner list, plus `added`, the change by contacts and gravity since.
double closing_speed(const System& s, const Vec3& n, const Vec3& v, const VelocityRange& range,
                     double added) {
  double c = added;
  for (int k = 0; k < s.dimension; ++k) {
    const int axis = s.dimension == 2 && k == 1 ? 2 : k;
    c += std::max(-n[axis] * (range.least[k] - v[axis]), -n[axis] * (range.most[k] - v[axis]));
  }
  return std::max(0.0, c);
}

}  // namespace

void WallLists::reset(Size walls) {
  margin_.resize(walls, 0), approach_.resize(walls, 0);
  stale_.resize(walls, 1);
  all_ = true;
}

void WallLists::add_step(const System& s, const PlateState& plate, const VelocityRange& range, double added) {
  // The displacement of a wall is its actual one in this step, not its velocity at one end of the step.
  const Vec3 moved = (plate.displacement - plate.before) / s.dt;
  for (Size w = 0; w < s.walls.size(); ++w) {
    const Vec3 v = s.walls[w].moves ? moved : Vec3::Zero();
    approach_[w] += s.dt * closing_speed(s, s.walls[w].n, v, range, added);
  }
}

bool WallLists::any_stale() const {
  if (all_) return true;
  for (Size w = 0; w < margin_.size(); ++w)
    if (!(approach_[w] <= margin_[w])) return true;  // negated: NaN makes a list stale
  return false;
}

void WallLists::refresh(const System& s, const PlateState& plate, const VelocityRange& range, double skin) {
  for (Size w = 0; w < s.walls.size(); ++w) {
    stale_[w] = all_ || !(approach_[w] <= margin_[w]);
    if (!stale_[w]) continue;
    const Vec3 v = s.walls[w].moves ? plate.velocity : Vec3::Zero();
    margin_[w] = std::clamp(kWallSteps * s.dt * (closing_speed(s, s.walls[w].n, v, range, 0) + 0.1),
                            1e-5 * skin, skin);
    approach_[w] = 0;
  }
  all_ = false;
}

void WallContacts::restore(const ListedBeads& beads, const BeadShare& share,
                           const RememberedContacts& remembered) {
  const PacketLayout& layout = beads.layout;
  for (Size w = 0; w < walls.size(); ++w) {
    const auto for_each_here = [&](auto visit) {
      remembered.at_wall(w, [&](std::int32_t bead, const double* numbers) {
        const std::int32_t place = beads.order.place[static_cast<Size>(bead)];
        if (share.owns(place)) visit(place, numbers);
      });
    };
    ContactPackets kept;
    for_each_here([&](std::int32_t place, const double*) { kept.source.push_back(place); });
    std::sort(kept.source.begin(), kept.source.end());
    const Size packets = layout.packets(kept.source.size());
    kept.count = static_cast<std::int64_t>(packets);
    kept.memory.assign(packets * layout.memory * layout.width, 0);
    for_each_here([&](std::int32_t place, const double* numbers) {
      const Size at = static_cast<Size>(std::lower_bound(kept.source.begin(), kept.source.end(), place) -
                                        kept.source.begin());
      for (Size v = 0; v < layout.memory; ++v) kept.memory[layout.index(at, layout.memory, v)] = numbers[v];
    });
    walls[w] = std::move(kept);
  }
}

void WallContacts::build(const System& s, ListedBeads& beads, const BeadShare& share,
                         const WallLists& lists) {
  const PacketLayout& layout = beads.layout;
  const bool flat = layout.dimension == 2;
  for (Size w = 0; w < walls.size(); ++w) {
    if (!lists.is_stale(w)) continue;
    const Wall& wall = s.walls[w];
    const double offset = offset_now(s, wall), margin = lists.margin(w);
    const ContactPackets old = std::move(walls[w]);
    ContactPackets near;
    Size known = 0;
    const double inward[3] = {wall.n.x(), flat ? wall.n.z() : wall.n.y(), flat ? 0 : wall.n.z()};
    const std::ptrdiff_t stride = layout.record(1);
    const double* at = beads.packed.records() + stride * static_cast<std::ptrdiff_t>(share.begin);
    for (Size k = share.begin; k < share.end; ++k, at += stride) {
      double height = at[0] * inward[0] + at[1] * inward[1] - offset;
      if (!flat) height += at[2] * inward[2];
      bool listed = !(height - beads.packed.radius(k) >= margin);
      if (known < old.source.size() && static_cast<Size>(old.source[known]) == k) {
        listed = listed ||
                 layout.remembers(old.memory.data() + layout.index(known, layout.memory, 0), layout.width);
        ++known;
      }
      if (listed) near.source.push_back(static_cast<std::int32_t>(k));
    }
    pack(beads, share, w, old, near);
    walls[w] = std::move(near);
  }
}

/// Copies indices, constants and memory in the order of the packets.
void WallContacts::pack(ListedBeads& beads, const BeadShare& share, Size w, const ContactPackets& old,
                        ContactPackets& near) const {
  const PacketLayout& layout = beads.layout;
  const Size n = near.source.size(), count = layout.packets(n), padded = count * layout.width;
  near.count = static_cast<std::int64_t>(count);
  near.i.assign(padded, layout.record(share.dummy));
  near.memory.assign(padded * layout.memory, 0);
  const Size constants = beads.packed.equal() ? 0 : wall_constants(beads.plan, beads.packed, w, 0).size();
  near.constants.assign(padded * constants, 1);
  Size before = 0;
  for (Size r = 0; r < n; ++r) {
    near.i[r] = layout.record(near.source[r]);
    while (before < old.source.size() && old.source[before] < near.source[r]) ++before;
    if (before < old.source.size() && old.source[before] == near.source[r])
      for (Size m = 0; m < layout.memory; ++m)
        near.memory[layout.index(r, layout.memory, m)] = old.memory[layout.index(before, layout.memory, m)];
    if (constants > 0) {
      const auto set = wall_constants(beads.plan, beads.packed, w, static_cast<Size>(near.source[r]));
      for (Size m = 0; m < constants; ++m) near.constants[layout.index(r, constants, m)] = set[m];
    }
  }
}

}  // namespace twincell::sim
