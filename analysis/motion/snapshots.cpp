#include "analysis/motion/snapshots.hpp"

#include <algorithm>

#include "analysis/neighbours/neighbours.hpp"
#include "analysis/neighbours/voronoi.hpp"
#include "analysis/order/defects.hpp"
#include "trajectory/plate.hpp"

namespace twincell::analysis {
namespace {

/// At most `most` elements of `all`, evenly spread, with the first and the last.
std::vector<std::size_t> spread(const std::vector<std::size_t>& all, std::size_t most) {
  if (all.size() <= most) return all;
  if (most < 2) return {all.front()};
  std::vector<std::size_t> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(all[i * (all.size() - 1) / (most - 1)]);
  return some;
}

}  // namespace

Snapshot snapshot(const TrajectorySource& trajectory, std::size_t index, double cutoff) {
  Snapshot s;
  trajectory.read(index, s.frame);
  s.order = bond_order(find_neighbours(s.frame, trajectory.info().box, cutoff));
  const Box& box = trajectory.info().box;
  if (!box.periodic(Axis::x) || box.size().x() > 4 * kCellRadius)
    s.coordination = find_defects(voronoi_cells(s.frame, box)).coordination;
  s.plate = plate_height(trajectory.info(), s.frame).value_or(trajectory.info().box.lower.z());
  return s;
}

std::vector<std::size_t> representative_frames(const TrajectorySource& trajectory, std::size_t most) {
  const std::size_t n = trajectory.n_frames();
  std::vector<std::size_t> all(n), beginnings;
  Frame frame;
  for (std::size_t i = 0; i < n; ++i) {
    all[i] = i;
    if (!trajectory.info().columns.phase) continue;
    trajectory.read(i, frame);
    if (frame.phase == 0) beginnings.push_back(i);
  }
  if (beginnings.size() < 2) return spread(all, most);
  // The last cycle is whole if the run contains N_k frames from its beginning on; otherwise the one before is
  // used.
  const auto per_cycle = static_cast<std::size_t>(std::max(1, trajectory.info().phases_per_cycle));
  const bool last_is_whole = beginnings.back() + per_cycle <= n;
  const std::size_t from = last_is_whole ? beginnings.back() : beginnings[beginnings.size() - 2];
  const std::size_t to = last_is_whole ? std::min(n, from + per_cycle) : beginnings.back();
  const std::vector<std::size_t> cycle(all.begin() + static_cast<std::ptrdiff_t>(from),
                                       all.begin() + static_cast<std::ptrdiff_t>(to));
  std::vector<std::size_t> chosen = spread(beginnings, std::max<std::size_t>(1, most / 2));
  const auto phases = spread(cycle, most - chosen.size());
  chosen.insert(chosen.end(), phases.begin(), phases.end());
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

}  // namespace twincell::analysis
