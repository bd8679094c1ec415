#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/error.hpp"
#include "sim/start/start.hpp"
#include "sim/start/start_parts.hpp"
#include "sim/system/cell_grid.hpp"

namespace twincell::sim {

namespace {

/// Area of the beads and the intruder; in 3D their volume.
double size_of_all(const Scene& scene, const std::vector<double>& radii) {
  const bool flat = scene.dimension == 2;
  const double r = scene.radius, powers = flat ? 2 : 3;
  double in_beads = 0;  // total size, in beads of radius r
  for (const double radius : radii) in_beads += std::pow(radius / r, powers);
  if (scene.intruder) in_beads += std::pow(scene.intruder->radius / r, powers);
  return flat ? in_beads * std::numbers::pi * r * r : in_beads * 4 / 3 * std::numbers::pi * r * r * r;
}

/// Height of the column of which the beads take a share, but at least six radii.
double height_at(const Scene& scene, const std::vector<double>& radii, double share) {
  const double filled = size_of_all(scene, radii) /
                        (scene.dimension == 2 ? share * scene.width : share * scene.width * scene.depth);
  return std::max(
      {6 * scene.radius, filled, scene.intruder ? scene.intruder->z + scene.intruder->radius : 0.0});
}

/// Height of the column: Scene::column_height, or that of which the beads take the share Scene::fraction.
/// \throws ConfigError if a stated height or share has no effect, does not fit below the ceiling, or leaves
/// the beads too little room
double column_height(const Scene& scene, const std::vector<double>& radii) {
  const double ceiling = ceiling_of(scene);
  const bool fills_cell = scene.g() == 0 && std::isfinite(ceiling);
  for (const auto& [key, stated] : {std::pair{"start.fraction", scene.fraction.has_value()},
                                    {"start.height", scene.column_height.has_value()}})
    if (stated && fills_cell)
      throw ConfigError(scene.where(key),
                        "has no effect: without gravity the beads are placed in the whole cell.");
  if (scene.column_height) {
    const double least = height_at(scene, radii, largest_fraction(scene.dimension));
    if (*scene.column_height < least || *scene.column_height > ceiling)
      throw ConfigError(
          scene.where("start.height"),
          *scene.column_height < least
              ? fmt::format("is {:g} sigma, but the beads need a column of {:.4g} sigma.",
                            *scene.column_height, least)
              : fmt::format("is {:g} sigma, but the cell ends at {:.4g}.", *scene.column_height, ceiling));
    return *scene.column_height;
  }
  const double needed = height_at(scene, radii, scene.fraction.value_or(scene.dimension == 2 ? 0.4 : 0.25));
  if (scene.fraction && needed > ceiling)
    throw ConfigError(
        scene.where("start.fraction"),
        fmt::format("is {:g}, which needs a column of {:.4g} sigma, but the cell ends at {:.4g}.",
                    *scene.fraction, needed, ceiling));
  return fills_cell ? ceiling : std::min(needed, ceiling);
}

}  // namespace

Start random_deposit(const Scene& scene, Progress& progress) {
  const std::size_t n = scene.n_beads.value_or(0);
  const std::vector<double> radii = draw_radii(scene, n);
  const auto walls = scene.walls();
  const auto period = scene.period();
  const double height = column_height(scene, radii);
  Start start;
  start.beads.resize(n);
  std::vector<double> all_radii = radii;
  if (scene.intruder) {
    start.beads.push_back(intruder_of(scene));
    all_radii.push_back(scene.intruder->radius);
  }

  std::mt19937_64 engine = engine_of(scene, Stream::positions);
  const auto along = [&](double extent, double radius, bool periodic) {
    return periodic ? extent * uniform(engine) : radius + (extent - 2 * radius) * uniform(engine);
  };
  // Large beads first, because they find no free position between small ones.
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return radii[i] > radii[j]; });
  CancellationCheck check(progress);
  // \returns whether there was room for all
  const auto place_all = [&] {
    CellGrid grid(all_radii, 0, scene.dimension, period);
    if (scene.intruder)
      grid.insert(static_cast<std::int32_t>(n), centre_of(start.beads[n]), scene.intruder->radius);
    long tries_left = 2000L * static_cast<long>(n) + 100000;
    for (const std::size_t i : order) {
      const double radius = radii[i];
      for (bool placed = false; !placed;) {
        check();
        if (--tries_left < 0) return false;
        Vec3 r = Vec3::Zero();
        r.x() = along(scene.width, radius, scene.sides == Edge::periodic);
        if (scene.dimension == 3) r.y() = along(scene.depth, radius, scene.plates == Edge::periodic);
        r.z() = along(height, radius, scene.bottom == Edge::periodic);
        placed = deepest_wall(walls, r, radius).depth <= 1e-9 * radius;
        grid.around(r, radius, [&](std::int32_t j) {
          const Bead& other = start.beads[static_cast<std::size_t>(j)];
          const Vec3 apart = r - centre_of(other);
          placed = placed && (apart + nearest_shift(apart, period)).norm() >= radius + other.radius;
        });
        if (!placed) continue;
        Bead& b = start.beads[i] = bead_at(scene, radius, r);
        b.vx = scene.velocity_scale * (2 * uniform(engine) - 1);
        if (scene.dimension == 3) b.vy = scene.velocity_scale * (2 * uniform(engine) - 1);
        b.vz = scene.velocity_scale * (2 * uniform(engine) - 1) - scene.fall_speed;
        grid.insert(static_cast<std::int32_t>(i), r, radius);
      }
    }
    return true;
  };
  // The first few beads may lie so that the last find no room. In a small cell this happens to one seed in a
  // hundred, so it starts over; a large one fails only if it is too small for any order.
  constexpr std::size_t kMaxRetriedBeads = 1000;
  constexpr int kAttempts = 10;
  for (int attempt = 0; attempt < (n <= kMaxRetriedBeads ? kAttempts : 1); ++attempt)
    if (place_all()) return start;
  const double base = scene.dimension == 2 ? scene.width : scene.width * scene.depth,
               taken = size_of_all(scene, radii) / (base * height);
  throw NoRoom(scene.where("beads.count"),
               fmt::format("{} beads cannot be placed at random in {}: they would take {:.0f} % of it below "
                           "{:.3g} sigma{}.",
                           n, describe_cell(scene), 100 * taken, height,
                           height < ceiling_of(scene) ? "; a smaller start.fraction makes that higher" : ""));
}

}  // namespace twincell::sim
