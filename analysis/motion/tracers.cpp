#include "analysis/motion/tracers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "trajectory/plate.hpp"

namespace twincell::analysis {
namespace {

/// Half width of the band that contains a lattice row, sigma. Lattice rows are at least 1/2 apart, and
/// positions from images scatter by about 0.03. In a random bed such a band contains less than half a row.
constexpr double kRowTolerance = 0.2;

std::vector<std::size_t> beads_of(const Frame& frame) {
  std::vector<std::size_t> beads;
  for (std::size_t i = 0; i < frame.position.size(); ++i)
    if (frame.present(i) && frame.position[i].allFinite()) beads.push_back(i);
  return beads;
}

/// Half the sum of the lowest height and the 99th percentile of the heights.
double mid_height(const Frame& frame, const std::vector<std::size_t>& beads) {
  std::vector<double> z;
  z.reserve(beads.size());
  for (const std::size_t i : beads) z.push_back(frame.position[i].z());
  std::sort(z.begin(), z.end());
  const double top = z[static_cast<std::size_t>(0.99 * static_cast<double>(z.size() - 1))];
  return (z.front() + top) / 2;
}

/// The row of beads through the bead nearest to `middle`.
std::vector<std::size_t> row_at(const Frame& frame, const std::vector<std::size_t>& beads, double middle) {
  const auto nearest = *std::min_element(beads.begin(), beads.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(frame.position[a].z() - middle) < std::abs(frame.position[b].z() - middle);
  });
  std::vector<std::size_t> row;
  for (const std::size_t i : beads)
    if (std::abs(frame.position[i].z() - frame.position[nearest].z()) <= kRowTolerance) row.push_back(i);
  return row;
}

/// In each column of width sigma, the bead nearest to `middle`.
std::vector<std::size_t> one_per_column(const Frame& frame, const std::vector<std::size_t>& beads,
                                        const Box& box, double middle) {
  const auto columns = static_cast<std::size_t>(std::max(1.0, std::floor(box.size().x())));
  const double width = box.size().x() / static_cast<double>(columns);
  std::vector<std::optional<std::size_t>> best(columns);
  for (const std::size_t i : beads) {
    const double column = std::floor((box.wrap(frame.position[i]).x() - box.lower.x()) / width);
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

TracerChoice of_ids(const TrajectoryInfo& info, std::vector<std::int64_t> ids) {
  const Where where{.file = {}, .key = "tracers"};
  for (const std::int64_t id : ids)
    if (id < 0 || id >= static_cast<std::int64_t>(info.n_beads))
      throw ConfigError(where, fmt::format("there is no bead {}; ids run from 0 to {}", id,
                                           static_cast<std::int64_t>(info.n_beads) - 1));
  std::sort(ids.begin(), ids.end());
  if (const auto twice = std::adjacent_find(ids.begin(), ids.end()); twice != ids.end())
    throw ConfigError(where, fmt::format("bead {} is named twice", *twice));
  TracerChoice choice;
  choice.slots.assign(ids.begin(), ids.end());
  choice.how = fmt::format("{} tracers named by their ids", ids.size());
  return choice;
}

TracerChoice in_band(const TrajectoryInfo& info, const Frame& first, const std::array<double, 2>& band) {
  const Where where{.file = {}, .key = "tracer_band"};
  if (!(band[0] < band[1]))
    throw ConfigError(where,
                      fmt::format("[{:g}, {:g}] is not a band: low must be below high", band[0], band[1]));
  const double plate = plate_height(info, first).value_or(0);
  TracerChoice choice;
  double low = INFINITY, high = -INFINITY;
  for (const std::size_t i : beads_of(first)) {
    const double height = first.position[i].z() - plate;
    low = std::min(low, height);
    high = std::max(high, height);
    if (height >= band[0] && height <= band[1]) choice.slots.push_back(i);
  }
  if (choice.slots.empty())
    throw ConfigError(where,
                      fmt::format("no bead begins between {:g} and {:g} sigma above the plate; the bed "
                                  "reaches from {:.4g} to {:.4g}",
                                  band[0], band[1], low, high));
  choice.how = fmt::format("the {} beads that begin {:g} to {:g} sigma above the plate", choice.slots.size(),
                           band[0], band[1]);
  return choice;
}

}  // namespace

TracerChoice choose_tracers(const TrajectoryInfo& info, const Frame& first, const TracerWish& wish) {
  if (!wish.ids.empty() && wish.band)
    throw ConfigError({.file = {}, .key = "tracers"},
                      "tracers are chosen by ids or by a band; state only one");
  if (!wish.ids.empty()) return of_ids(info, wish.ids);
  if (wish.band) return in_band(info, first, *wish.band);
  TracerChoice marked{.slots = {}, .how = "tracers as marked in the trajectory"};
  for (std::size_t i = 0; i < info.tracer.size(); ++i)
    if (info.tracer[i] != 0) marked.slots.push_back(i);
  // A tracked stack of beads that all look alike has the marks, and none is set.
  return marked.slots.empty() ? line_of_tracers(info, first, 0) : marked;
}

TracerChoice line_of_tracers(const TrajectoryInfo& info, const Frame& first, double above) {
  TracerChoice choice;
  const auto beads = beads_of(first);
  if (beads.empty()) {
    choice.how = "no bead to choose from in the first frame";
    return choice;
  }
  const double middle = mid_height(first, beads) + above;
  const std::string height = above == 0 ? "mid-height" : fmt::format("mid-height {:+g} sigma", above);
  choice.slots = row_at(first, beads, middle);
  if (static_cast<double>(choice.slots.size()) >= 0.75 * std::floor(info.box.size().x())) {
    choice.how = fmt::format("tracers chosen here: the row nearest to {} of the first frame", height);
    return choice;
  }
  choice.slots = one_per_column(first, beads, info.box, middle);
  choice.how = fmt::format(
      "tracers chosen here: in each column of width sigma the bead nearest to {} of the first frame", height);
  return choice;
}

}  // namespace twincell::analysis
