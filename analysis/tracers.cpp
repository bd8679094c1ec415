#include "analysis/tracers.hpp"

#include <algorithm>
#include <cmath>

namespace twincell {
namespace {

/// Rows of a lattice are at least 1/2 apart; images scatter by some 0.03. A random bed has less than half a
/// row in such a band.
constexpr double kRowTolerance = 0.2;

std::vector<std::size_t> beads_of(const Frame& frame) {
  std::vector<std::size_t> beads;
  for (std::size_t i = 0; i < frame.position.size(); ++i)
    if (frame.present(i) && frame.position[i].allFinite()) beads.push_back(i);
  return beads;
}

double mid_height(const Frame& frame, const std::vector<std::size_t>& beads) {
  std::vector<double> z;
  z.reserve(beads.size());
  for (const std::size_t i : beads) z.push_back(frame.position[i].z());
  std::sort(z.begin(), z.end());
  const double top = z[static_cast<std::size_t>(0.99 * static_cast<double>(z.size() - 1))];
  return (z.front() + top) / 2;
}

/// The row through the bead nearest to `middle`.
std::vector<std::size_t> row_at(const Frame& frame, const std::vector<std::size_t>& beads, double middle) {
  const auto nearest = *std::min_element(beads.begin(), beads.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(frame.position[a].z() - middle) < std::abs(frame.position[b].z() - middle);
  });
  std::vector<std::size_t> row;
  for (const std::size_t i : beads)
    if (std::abs(frame.position[i].z() - frame.position[nearest].z()) <= kRowTolerance) row.push_back(i);
  return row;
}

/// For each column of width sigma the bead nearest to `middle`.
std::vector<std::size_t> one_per_column(const Frame& frame, const std::vector<std::size_t>& beads,
                                        const Box& box, double middle) {
  const auto columns = static_cast<std::size_t>(std::max(1.0, std::floor(box.size().x())));
  const double width = box.size().x() / static_cast<double>(columns);
  std::vector<std::optional<std::size_t>> best(columns);
  for (const std::size_t i : beads) {
    const double column = std::floor((frame.position[i].x() - box.lower.x()) / width);
    if (column < 0 || column >= static_cast<double>(columns)) continue;
    auto& held = best[static_cast<std::size_t>(column)];
    if (!held || std::abs(frame.position[i].z() - middle) < std::abs(frame.position[*held].z() - middle))
      held = i;
  }
  std::vector<std::size_t> line;
  for (const auto& held : best)
    if (held) line.push_back(*held);
  return line;
}

}  // namespace

TracerChoice choose_tracers(const TrajectoryInfo& info, const Frame& first) {
  TracerChoice choice;
  if (!info.tracer.empty()) {
    for (std::size_t i = 0; i < info.tracer.size(); ++i)
      if (info.tracer[i] != 0) choice.slots.push_back(i);
    choice.how = "tracers as marked in the trajectory";
    return choice;
  }
  const auto beads = beads_of(first);
  if (beads.empty()) {
    choice.how = "no bead to choose from in the first frame";
    return choice;
  }
  const double middle = mid_height(first, beads);
  choice.slots = row_at(first, beads, middle);
  if (static_cast<double>(choice.slots.size()) >= 0.75 * std::floor(info.box.size().x())) {
    choice.how = "tracers chosen here: the row nearest to mid-height of the first frame";
    return choice;
  }
  choice.slots = one_per_column(first, beads, info.box, middle);
  choice.how =
      "tracers chosen here: in each column of width sigma the bead nearest to mid-height of the first frame";
  return choice;
}

std::optional<double> plate_height(const TrajectoryInfo& info, const Frame& frame) {
  if (std::isfinite(frame.plate_height)) return frame.plate_height;
  if (!info.drive || info.phases_per_cycle <= 0 || frame.phase < 0) return std::nullopt;
  if (info.drive->axis != Axis::z) return 0.0;
  return info.drive->displacement(static_cast<double>(frame.phase) / info.phases_per_cycle);
}

}  // namespace twincell
