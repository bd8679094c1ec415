#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.hpp"
#include "sim/start/start.hpp"
#include "sim/start/start_parts.hpp"
#include "sim/system/cell_grid.hpp"

namespace twincell::sim {

namespace {

/// Near pairs for relax_overlaps. The list is valid until a bead has moved by half the margin.
class NearPairs {
 public:
  NearPairs(const std::vector<Bead>& beads, const Scene& scene)
      : dimension_(scene.dimension), period_(scene.period()) {
    double smallest = HUGE_VAL;
    for (const Bead& b : beads) smallest = std::min(smallest, b.radius);
    margin_ = 0.5 * smallest;
  }
  /// Sorted by (i, j), so that the order of the displacements does not depend on the search.
  const std::vector<std::pair<std::int32_t, std::int32_t>>& of(const std::vector<Bead>& beads) {
    if (!stale(beads)) return pairs_;
    pairs_.clear();
    for_each_near_pair(
        beads, dimension_, period_, margin_,
        [&](std::int32_t i, std::int32_t j, double, const Vec3&) { pairs_.emplace_back(i, j); });
    std::sort(pairs_.begin(), pairs_.end());
    at_.clear();
    for (const Bead& b : beads) at_.push_back(centre_of(b));
    return pairs_;
  }

 private:
  [[nodiscard]] bool stale(const std::vector<Bead>& beads) const {
    if (at_.size() != beads.size()) return true;
    double moved = 0;
    for (std::size_t i = 0; i < beads.size(); ++i)
      moved = std::max(moved, (centre_of(beads[i]) - at_[i]).norm());
    return 2 * moved > margin_;
  }

  int dimension_;
  std::array<double, 3> period_;
  double margin_ = 0;
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs_;
  std::vector<Vec3> at_;
};

void move(Bead& b, const Vec3& by) {
  b.x += by.x();
  b.y += by.y();
  b.z += by.z();
}

}  // namespace

double relax_overlaps(std::vector<Bead>& beads, const Scene& scene, double tolerance, int max_sweeps,
                      Progress& progress) {
  CancellationCheck check(progress);
  constexpr double kLargestPush = 0.01;
  const auto walls = scene.walls();
  const auto period = scene.period();
  NearPairs near(beads, scene);
  double worst = 0;
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    worst = 0;
    check();
    for (const auto& [i, j] : near.of(beads)) {
      check();
      Bead &a = beads[static_cast<std::size_t>(i)], &b = beads[static_cast<std::size_t>(j)];
      Vec3 apart = centre_of(a) - centre_of(b);
      apart += nearest_shift(apart, period);
      const double r = std::max(apart.norm(), 1e-12), overlap = a.radius + b.radius - r;
      if (overlap <= 0) continue;
      worst = std::max(worst, overlap);
      const Vec3 push = std::min(overlap, kLargestPush) / r * apart;
      move(a, b.mass / (a.mass + b.mass) * push);
      move(b, -a.mass / (a.mass + b.mass) * push);
    }
    for (Bead& b : beads)
      for (const Wall& wall : walls) {
        const double overlap = b.radius - (wall.n.dot(centre_of(b)) - wall.offset);
        if (overlap <= 0) continue;
        worst = std::max(worst, overlap);
        move(b, std::min(overlap, kLargestPush) * wall.n);
      }
    if (worst <= tolerance) break;
  }
  return worst;
}

namespace {

/// H16: no bead may be near two images of another.
void require_periods(const std::vector<Bead>& beads, const Scene& scene) {
  double first = 0, second = 0;  // the two largest radii
  for (const Bead& b : beads) {
    second = std::max(second, std::min(first, b.radius));
    first = std::max(first, b.radius);
  }
  const double reach = first + second + kListReach * 2 * first;
  for (const double period : scene.period())
    if (period > 0 && period < 2 * reach && beads.size() > 1)
      throw ConfigError(
          scene.where("cell"),
          fmt::format("a bead of radius {:g} would meet two images of another: a period of {:g} is less "
                      "than {:g}, twice the reach of the pair list.",
                      first, period, 2 * reach));
}

}  // namespace

void require_sound(const std::vector<Bead>& beads, const Scene& scene, double bound, Progress& progress,
                   const Vec3& plate) {
  CancellationCheck check(progress);
  const Where where = scene.where("start");
  constexpr double kMaxHeight_sigma = 1e9;  // of a cell
  auto walls = scene.walls();
  for (Wall& wall : walls)
    if (wall.moves) wall.offset += wall.n.dot(plate);
  for (std::size_t i = 0; i < beads.size(); ++i) {
    // Each bead: finite numbers, position, walls.
    const Bead& b = beads[i];
    check();
    if (!std::isfinite(b.x + b.y + b.z + b.vx + b.vy + b.vz + b.spin + b.spin_x + b.spin_z))
      throw ConfigError(where, fmt::format("bead {} has no finite position or velocity.", i));
    if (centre_of(b).cwiseAbs().maxCoeff() > kMaxHeight_sigma)
      throw ConfigError(
          where, fmt::format("bead {} at ({:.4g}, {:.4g}, {:.4g}) is too far away, the bound is {:g}.", i,
                             b.x, b.y, b.z, kMaxHeight_sigma));
    if (const WallOverlap outside = deepest_wall(walls, centre_of(b), b.radius);
        outside.depth > bound * 2 * b.radius)
      throw ConfigError(
          where, fmt::format("bead {} at ({:.4g}, {:.4g}, {:.4g}) reaches {:.3g} sigma into the wall \"{}\" "
                             "of {}, the bound is {:g}.",
                             i, b.x, b.y, b.z, outside.depth, outside.wall->name, describe_cell(scene),
                             bound * 2 * b.radius));
  }
  require_periods(beads, scene);
  // Pairs: the deepest overlap is named, the others are counted.
  double deepest = 0;
  std::size_t how_many = 0;
  std::string worst;
  for_each_near_pair(
      beads, scene.dimension, scene.period(), 0,
      [&](std::int32_t i, std::int32_t j, double gap, const Vec3&) {
        check();
        const double allowed =
            bound * 2 *
            std::min(beads[static_cast<std::size_t>(i)].radius, beads[static_cast<std::size_t>(j)].radius);
        if (-gap <= allowed) return;
        ++how_many;
        if (-gap <= deepest) return;
        deepest = -gap;
        const Bead &a = beads[static_cast<std::size_t>(i)], &b = beads[static_cast<std::size_t>(j)];
        worst =
            fmt::format("beads {} and {} overlap by {:.3g} sigma, the bound is {:g}", i, j, deepest, allowed);
        if (deepest == a.radius + b.radius) worst = fmt::format("beads {} and {} have the same centre", i, j);
      });
  if (how_many > 0)
    throw ConfigError(where, how_many == 1
                                 ? worst + "."
                                 : fmt::format("{}; {} pairs exceed their bounds.", worst, how_many));
}

}  // namespace twincell::sim
