#include "sim/start/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/error.hpp"
#include "sim/scene/starts.hpp"
#include "sim/start/start_parts.hpp"

namespace twincell::sim {

Bead bead_at(const Scene& scene, double radius, double mass, const Vec3& r) {
  Bead b;
  b.x = r.x();
  b.y = r.y();
  b.z = r.z();
  b.radius = radius;
  b.mass = mass;
  b.inertia = scene.inertia_factor * mass * radius * radius;
  return b;
}

Bead bead_at(const Scene& scene, double radius, const Vec3& r) {
  return bead_at(scene, radius, scene.mass_of(radius), r);
}

Bead intruder_of(const Scene& scene) {
  const Intruder& i = scene.intruder.value();
  return bead_at(scene, i.radius, i.mass, {i.x, i.y, i.z});
}

std::mt19937_64 engine_of(const Scene& scene, Stream stream) {
  return std::mt19937_64(scene.seed + 0x9E3779B97F4A7C15u * static_cast<std::uint64_t>(stream));
}

double uniform(std::mt19937_64& engine) {
  return static_cast<double>(engine() >> 11) * 0x1p-53;
}

WallOverlap deepest_wall(const std::vector<Wall>& walls, const Vec3& r, double radius) {
  WallOverlap deepest;
  for (const Wall& wall : walls)
    if (const double depth = radius - (wall.n.dot(r) - wall.offset); depth > deepest.depth)
      deepest = {depth, &wall};
  return deepest;
}

double ceiling_of(const Scene& scene) {
  return scene.lid || scene.bottom == Edge::periodic ? scene.height.value_or(HUGE_VAL) : HUGE_VAL;
}

std::optional<double> only_row(const Scene& scene, double d) {
  if (scene.dimension == 2) return 0;
  const bool slot = scene.plates != Edge::periodic && scene.depth < d * (1 + kLayerShift);
  return slot ? std::optional(scene.depth / 2) : std::nullopt;
}

std::string describe_cell(const Scene& scene) {
  std::string text = fmt::format("a cell {:g} wide", scene.width);
  if (scene.dimension == 3) text += fmt::format(", {:g} deep", scene.depth);
  if (const double top = ceiling_of(scene); std::isfinite(top)) text += fmt::format(", {:g} high", top);
  return text;
}

namespace {

/// Normal deviate of mean 0 and variance 1 (Box and Muller).
double normal(std::mt19937_64& engine) {
  const double r = std::sqrt(-2 * std::log(1 - uniform(engine)));
  return r * std::cos(2 * std::numbers::pi * uniform(engine));
}

/// The start that start.kind selects, as its function makes it.
Start selected_start(const Scene& scene, Progress& progress) {
  switch (scene.start) {
    case StartKind::crystal_a:
      return crystal_a(scene, progress);
    case StartKind::crystal_b:
      return crystal_b(scene, progress);
    case StartKind::random:
      return random_deposit(scene, progress);
    case StartKind::trajectory:
      return from_trajectory(scene, progress);
    case StartKind::table:
      return from_table(scene, progress);
  }
  throw std::logic_error("A kind of start has no function in selected_start.");
}

}  // namespace

std::vector<double> draw_radii(const Scene& scene, std::size_t n) {
  std::mt19937_64 engine = engine_of(scene, Stream::sizes);
  const double largest = largest_deviation(scene.spread, scene.spread_width);
  std::vector<double> radii(n, scene.radius);
  if (scene.spread == SizeSpread::none) return radii;
  for (double& radius : radii) {
    double deviation = 0;
    do {
      deviation = scene.spread == SizeSpread::uniform ? largest * (2 * uniform(engine) - 1)
                                                      : scene.spread_width * normal(engine);
    } while (std::abs(deviation) > largest);
    radius = scene.radius * (1 + deviation);
  }
  return radii;
}

bool has_chance(const Scene& scene) {
  const StartRow& start = start_row(scene.start);
  if (start.draws || scene.perturbation != 0) return true;
  return scene.spread != SizeSpread::none && scene.spread_width > 0 && !start.sets_radii;
}

Start make_start(const Scene& scene, Progress& progress) {
  Start start = selected_start(scene, progress);
  if (scene.relax) {
    // Coincident centres have no direction of separation, and a bead beyond a wall belongs to another cell.
    constexpr double kRefused = 0.99, kTolerated = 1e-6;
    require_sound(start.beads, scene, kRefused, progress);
    if (const double left = relax_overlaps(start.beads, scene, kTolerated, 50000, progress);
        left > kTolerated)
      throw NoRoom(scene.where("start.relax"),
                   fmt::format("the beads cannot be pushed apart, an overlap of {:.3g} sigma remains, "
                               "the bound is {:g}; is there room for them?",
                               left, kTolerated));
  }
  if (scene.perturbation == 0) return start;
  std::mt19937_64 engine = engine_of(scene, Stream::perturbation);
  const auto shift = [&] { return scene.perturbation * (2 * uniform(engine) - 1); };
  CancellationCheck check(progress);
  for (Bead& b : start.beads) {
    check();
    b.x += shift();
    if (scene.dimension == 3) b.y += shift();
    b.z += shift();
  }
  return start;
}

std::vector<std::uint8_t> choose_tracers(const std::vector<Bead>& resting, const Scene& scene) {
  std::vector<std::uint8_t> tracer(resting.size(), 0);
  const std::size_t n = resting.size() - (scene.intruder && !resting.empty() ? 1 : 0);
  if (n == 0) return tracer;
  double top = 0, largest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    top = std::max(top, resting[i].z + resting[i].radius);
    largest = std::max(largest, resting[i].radius);
  }
  const double middle = top / 2;
  const auto distance = [&](std::size_t i) { return std::abs(resting[i].z - middle); };
  if (scene.start == StartKind::crystal_a) {
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < n; ++i)
      if (distance(i) < distance(nearest)) nearest = i;
    const double d = 2 * largest, spacing = d * (only_row(scene, d) ? kRowSpacing : kLayerSpacing);
    for (std::size_t i = 0; i < n; ++i)
      tracer[i] = std::abs(resting[i].z - resting[nearest].z) < spacing / 2 ? 1 : 0;
    return tracer;
  }
  const double d = 2 * scene.radius;
  const auto column = [&](double x, double extent, bool periodic) {
    if (periodic) x -= extent * std::floor(x / extent);
    const auto columns = static_cast<std::size_t>(std::max(1.0, std::floor(extent / d)));
    return std::min(columns - 1, static_cast<std::size_t>(std::max(0.0, x / d)));
  };
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> best;
  for (std::size_t i = 0; i < n; ++i) {
    const Bead& b = resting[i];
    const auto place = std::pair(
        scene.dimension == 3 ? column(b.y, scene.depth, scene.plates == Edge::periodic) : std::size_t{0},
        column(b.x, scene.width, scene.sides == Edge::periodic));
    const auto [at, first] = best.try_emplace(place, i);
    if (!first && distance(i) < distance(at->second)) at->second = i;
  }
  for (const auto& [place, i] : best) tracer[i] = 1;
  return tracer;
}

}  // namespace twincell::sim
