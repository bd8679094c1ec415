#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/start/start.hpp"
#include "sim/start/start_parts.hpp"
#include "sim/system/cell_grid.hpp"

namespace twincell::sim {

namespace {

/// Places beads on the sites of a lattice of constant `d`, level by level. `level(k, offer)` calls offer(x,
/// y, z) for each site of level k until offer returns false, which means that all beads are placed.
template <class Level>
Start fill_lattice(const Scene& scene, const std::vector<double>& radii, double d, Progress& progress,
                   Level level) {
  CancellationCheck check(progress);
  const auto walls = scene.walls();
  const auto period = scene.period();
  // Twenty beads of diameter 1 must fit into a width of 20 despite rounding.
  const double ceiling = ceiling_of(scene), slack = 1e-9 * d;
  Start start;
  const auto free = [&](double radius, const Vec3& r) {
    if (deepest_wall(walls, r, radius).depth > slack || r.z() + radius > ceiling + slack) return false;
    if (!scene.intruder) return true;
    const Vec3 apart = r - Vec3(scene.intruder->x, scene.intruder->y, scene.intruder->z);
    return (apart + nearest_shift(apart, period)).norm() >= radius + scene.intruder->radius;
  };
  const double obstacle = scene.intruder ? 2 * scene.intruder->radius : 0;
  // Largest number of successive levels without a free site: those next to an intruder that fills the cell.
  const auto most_empty = static_cast<std::size_t>(4 + 2 * obstacle / d);
  for (std::size_t k = 0, empty = 0; start.beads.size() < radii.size(); ++k) {
    const std::size_t before = start.beads.size();
    level(k, [&](double x, double y, double z) {
      check();
      const double radius = radii[start.beads.size()];
      if (const Vec3 r(x, y, z); free(radius, r)) start.beads.push_back(bead_at(scene, radius, r));
      return start.beads.size() < radii.size();
    });
    empty = start.beads.size() > before ? 0 : empty + 1;
    if (empty > most_empty)
      throw NoRoom(scene.where("beads.count"),
                   fmt::format("only {} of {} beads fit on the lattice in {}.", start.beads.size(),
                               radii.size(), describe_cell(scene)));
  }
  if (scene.intruder) start.beads.push_back(intruder_of(scene));
  return start;
}

/// Integer part of q; a value that rounding has put slightly below an integer counts as that integer.
std::size_t whole(double q) {
  return static_cast<std::size_t>(std::max(0.0, std::floor(q + 1e-9)));
}

/// Number of lattice lines that fit into `length`, the first half a diameter from the edge. In a periodic
/// direction the last line is at least a diameter from the image of the first, unless an even number of lines
/// closes without a gap.
std::size_t lines(double length, double spacing, double d, bool periodic) {
  const std::size_t with_gap = whole((length - d) / spacing) + 1;
  return periodic ? std::max(with_gap, 2 * whole(length / (2 * spacing))) : with_gap;
}

double lattice_constant(const std::vector<double>& radii, const Scene& scene) {
  return radii.empty() ? 2 * scene.radius : 2 * *std::max_element(radii.begin(), radii.end());
}

}  // namespace

Start crystal_a(const Scene& scene, Progress& progress) {
  const std::vector<double> radii = draw_radii(scene, scene.n_beads.value_or(0));
  const double d = lattice_constant(radii, scene);
  const std::size_t full = std::max<std::size_t>(1, whole(scene.width / d));
  const std::size_t offset_row =
      scene.sides == Edge::periodic ? full : std::max<std::size_t>(1, whole((scene.width - d / 2) / d));
  // Returns false when all beads are placed.
  const auto row = [&](bool odd, double y, double z, auto offer) {
    const double first = odd ? d : d / 2;
    for (std::size_t i = 0; i < (odd ? offset_row : full); ++i)
      if (!offer(first + static_cast<double>(i) * d, y, z)) return false;
    return true;
  };
  if (const auto y = only_row(scene, d))
    return fill_lattice(scene, radii, d, progress, [&](std::size_t k, auto offer) {
      row(k % 2 == 1, *y, d / 2 + static_cast<double>(k) * kRowSpacing * d, offer);
    });
  const std::size_t rows = lines(scene.depth, kRowSpacing * d, d, scene.plates == Edge::periodic);
  return fill_lattice(scene, radii, d, progress, [&](std::size_t k, auto offer) {
    const double first = d / 2 + (k % 2 == 1 ? kLayerShift * d : 0);
    const double z = d / 2 + static_cast<double>(k) * kLayerSpacing * d;
    for (std::size_t r = 0; r < rows; ++r)
      if (!row((r + k) % 2 == 1, first + static_cast<double>(r) * kRowSpacing * d, z, offer)) return;
  });
}

Start crystal_b(const Scene& scene, Progress& progress) {
  const std::vector<double> radii = draw_radii(scene, scene.n_beads.value_or(0));
  const double d = lattice_constant(radii, scene);
  if (const auto y = only_row(scene, d)) {
    const std::size_t columns = lines(scene.width, kRowSpacing * d, d, false);
    return fill_lattice(scene, radii, d, progress, [&](std::size_t k, auto offer) {
      for (const bool odd : {false, true})
        for (std::size_t c = odd ? 1 : 0; c < columns; c += 2)
          if (!offer(d / 2 + static_cast<double>(c) * kRowSpacing * d, *y,
                     d / 2 + (static_cast<double>(k) + (odd ? 0.5 : 0)) * d))
            return;
    });
  }
  const std::size_t layers = lines(scene.width, kLayerSpacing * d, d, scene.sides == Edge::periodic),
                    rows = lines(scene.depth, kRowSpacing * d, d, scene.plates == Edge::periodic);
  return fill_lattice(scene, radii, d, progress, [&](std::size_t k, auto offer) {
    for (const std::size_t odd : {0U, 1U})
      for (std::size_t l = 0; l < layers; ++l)
        for (std::size_t r = (l + odd) % 2; r < rows; r += 2)
          if (!offer(d / 2 + static_cast<double>(l) * kLayerSpacing * d,
                     d / 2 + static_cast<double>(r) * kRowSpacing * d + (l % 2 == 1 ? kLayerShift * d : 0),
                     d / 2 + (static_cast<double>(k) + 0.5 * static_cast<double>(odd)) * d))
            return;
  });
}

}  // namespace twincell::sim
