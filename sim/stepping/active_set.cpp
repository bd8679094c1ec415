#include "sim/stepping/active_set.hpp"

#include <algorithm>

namespace twincell::sim {

using Size = std::size_t;

void ActiveSet::find(const PacketLayout& layout, const BeadShare& share, const OuterPairs& outer,
                     const InnerPairs& inner, const WallContacts& walls, bool all) {
  const Size group = layout.dimension == 2 ? kGroup : 1, n = (share.size() + group - 1) / group;
  // If most groups are active, a distinction does not pay.
  all = all || 2 * inner.pairs * group > share.size();
  is_active_.assign(n, all ? 1 : 0);
  const auto activate = [&](std::int32_t place) {
    if (share.owns(place)) is_active_[(static_cast<Size>(place) - share.begin) / group] = 1;
  };
  for (const std::int32_t pair : inner.packets.source) {
    if (pair < 0 || all) continue;
    activate(layout.place(outer.i[static_cast<Size>(pair)]));
    activate(layout.place(outer.j[static_cast<Size>(pair)]));
  }
  for (const ContactPackets& wall : walls.walls)
    for (const std::int32_t bead : wall.source) activate(bead);
  active_.clear(), inactive_.clear(), chunk_end_.clear();
  size_ = 0;
  Size g = 0;
  for (const Chunk& chunk : inner.chunks) {
    const Size of_before = active_.size();  // runs of active beads end with their chunk
    for (Size begin = share.begin + g * group; g < n && begin < chunk.bead_end; ++g, begin += group) {
      const bool active = is_active_[g] != 0;
      std::vector<BeadRange>& runs = active ? active_ : inactive_;
      const auto first = static_cast<std::int64_t>(begin),
                 end = static_cast<std::int64_t>(std::min(begin + group, share.end));
      if (runs.size() > (active ? of_before : 0) && runs.back().end == first)
        runs.back().end = end;
      else
        runs.push_back({first, end});
      if (active) size_ += end - first;
    }
    chunk_end_.push_back(active_.size());
  }
}

void ActiveSet::advance_inactive(const Kernels& kernels, double* records, double dt, const double* gravity) {
  if (behind_ > 0 && !inactive_.empty()) {
    FreeFlightArgs a{};
    a.records = records;
    a.runs = inactive_.data();
    a.n_runs = static_cast<std::int64_t>(inactive_.size());
    a.steps = behind_;
    a.dt = dt;
    for (int k = 0; k < 3; ++k) a.gravity[k] = gravity[k];
    kernels.fly(a);
  }
  behind_ = 0;
}

}  // namespace twincell::sim
