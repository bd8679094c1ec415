#include "sim/scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace twincell::sim {

namespace {

constexpr double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

}  // namespace

double largest_deviation(SizeSpread spread, double width) {
  switch (spread) {
    case SizeSpread::none:
      return 0;
    case SizeSpread::uniform:
      return width;
    case SizeSpread::normal:
      break;
  }
  return std::min(3 * width, 0.9);
}

std::string VoidKey::text() const {
  return fmt::format("{} of {} has no effect: {}", key, source, reason);
}

Where Scene::where(const std::string& key) const {
  const Where at = source ? source->where(key) : Where{};
  return at.file == file ? at : Where{file, 0, 0, key};
}

double Scene::mass_of(double bead_radius) const {
  return mass * std::pow(bead_radius / radius, inertia_factor == 0.5 ? 2 : 3);
}

std::vector<Wall> Scene::walls() const {
  std::vector<Wall> all;
  if (bottom == Edge::wall) all.push_back({Vec3::UnitZ(), 0, bottom_moves, "bottom"});
  if (sides == Edge::wall) {
    const double left = radians(left_tilt), right = radians(right_tilt);
    all.push_back({Vec3(std::cos(left), 0, std::sin(left)), 0, side_walls_move, "left"});
    all.push_back(
        {Vec3(-std::cos(right), 0, std::sin(right)), -width * std::cos(right), side_walls_move, "right"});
  }
  if (dimension == 3 && plates == Edge::wall) {
    all.push_back({Vec3::UnitY(), 0, plates_move, "front"});
    all.push_back({-Vec3::UnitY(), -depth, plates_move, "back"});
  }
  if (lid) all.push_back({-Vec3::UnitZ(), -height.value_or(0), lid_moves, "lid"});
  return all;
}

RunConditions conditions_of(const Scene& scene, std::optional<std::size_t> beads) {
  RunConditions conditions{.n_l = {}, .gamma = {}, .start = std::string(start_row(scene.start).word)};
  if (beads) conditions.n_l = static_cast<double>(*beads) / scene.width;
  if (scene.g() > 0 && !scene.drive.ramp) conditions.gamma = scene.drive.gamma();
  return conditions;
}

}  // namespace twincell::sim
