#include "imaging/benchmark/packing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

namespace twincell::imaging::rendered {

double uniform(std::mt19937_64& random, double a, double b) {
  return std::uniform_real_distribution<double>(a, b)(random);
}

namespace {

// A placed disc. Its height is measured upwards from the floor.
struct Placed {
  double x, height, radius;
};

// Rest position of a disc of radius r that falls at x onto the discs already placed.
Placed drop(const std::vector<Placed>& bed, double x, double r, double left, double right) {
  constexpr double kEps = 1e-9, kTouching = 1e-6;
  // First support below the height `from`: the height of the disc on it, and the index of the supporting disc
  // (absent for the floor).
  auto fall = [&](double at, double from, std::size_t except) {
    double highest = r;
    std::optional<std::size_t> on;
    for (std::size_t i = 0; i < bed.size(); ++i) {
      const double reach = r + bed[i].radius, dx = at - bed[i].x;
      if (i == except || std::abs(dx) >= reach - kEps) continue;
      const double height = bed[i].height + std::sqrt(reach * reach - dx * dx);
      if (height > highest && height <= from + kEps) {
        highest = height;
        on = i;
      }
    }
    return std::pair{highest, on};
  };
  std::size_t none = bed.size();
  auto [height, on] = fall(x, std::numeric_limits<double>::infinity(), none);
  double side = 0;
  while (on) {
    const std::size_t i = *on;
    const Placed& under = bed[i];
    const double reach = r + under.radius;
    if (side == 0) side = x >= under.x ? 1 : -1;
    // Rolling: `angle` from the vertical is where the disc stops on `under`: at a wall, at the floor, at
    // another disc, or level with `under`, where it falls again.
    const double start = std::asin(std::clamp(side * (x - under.x) / reach, -1.0, 1.0));
    double angle = std::numbers::pi / 2;
    enum class End { over, wall, floor, disc } end = End::over;
    std::size_t hit = none;
    const double wall = side > 0 ? right - r - under.x : under.x - left - r;
    if (wall < reach && std::asin(std::max(-1.0, wall / reach)) < angle) {
      angle = std::asin(std::max(-1.0, wall / reach));
      end = End::wall;
    }
    if (const double c = (r - under.height) / reach; c > 0 && std::acos(std::min(1.0, c)) < angle) {
      angle = std::acos(std::min(1.0, c));
      end = End::floor;
    }
    for (std::size_t j = 0; j < bed.size(); ++j) {
      const double dx = side * (bed[j].x - under.x), dh = bed[j].height - under.height,
                   other = r + bed[j].radius, apart = std::hypot(dx, dh);
      if (j == i || apart >= reach + other || apart < kEps) continue;
      // Angle at which the disc touches j: direction from `under` to j, from the vertical, less the angle at
      // `under` in the triangle of the three centres.
      const double opening = std::acos(
          std::clamp((reach * reach + apart * apart - other * other) / (2 * reach * apart), -1.0, 1.0));
      const double met = std::atan2(dx, dh) - opening;
      if (met < start - kTouching || met >= angle) continue;
      // A disc touched at the start blocks the roll only if it is ahead.
      const double at = std::max(met, start);
      const double ahead =
          std::cos(at) * (dx - reach * std::sin(at)) - std::sin(at) * (dh - reach * std::cos(at));
      if (met > start + kTouching || ahead > 0) {
        angle = at;
        hit = j;
        end = End::disc;
      }
    }
    angle = std::max(angle, start);
    x = under.x + side * reach * std::sin(angle);
    height = under.height + reach * std::cos(angle);
    if (end == End::wall || end == End::floor) break;
    if (end == End::disc) {
      if (side * (bed[hit].x - x) >= 0) break;  // supported from both sides
      on = hit;                                 // continues over the next disc, to the same side
      continue;
    }
    std::tie(height, on) = fall(x, height, i);
    side = 0;
  }
  return {x, height, r};
}

}  // namespace

std::vector<Disc> sparse(const std::vector<double>& radii, cv::Rect2d room, std::mt19937_64& random) {
  const double largest = *std::max_element(radii.begin(), radii.end());
  const double cell = std::sqrt(room.area() / static_cast<double>(radii.size()));
  const int columns = std::max(1, static_cast<int>(std::ceil(room.width / cell)));
  const int rows = static_cast<int>((radii.size() + static_cast<std::size_t>(columns) - 1) /
                                    static_cast<std::size_t>(columns));
  const double w = room.width / columns, h = room.height / rows;
  const double free_x = std::max(0.0, 0.5 * w - largest - 1), free_y = std::max(0.0, 0.5 * h - largest - 1);
  std::vector<Disc> discs;
  for (std::size_t k = 0; k < radii.size(); ++k) {
    Disc d;
    const auto i = static_cast<int>(k) % columns, j = static_cast<int>(k) / columns;
    d.x = room.x + (i + 0.5) * w + uniform(random, -free_x, free_x);
    d.y = room.y + (j + 0.5) * h + uniform(random, -free_y, free_y);
    d.radius = radii[k];
    discs.push_back(d);
  }
  return discs;
}

std::vector<Disc> hexagonal(std::size_t count, double radius, cv::Rect2d room, std::mt19937_64& random) {
  const double turn = 7 * std::numbers::pi / 180, d = 2 * radius;
  const double x0 = uniform(random, 0, d), y0 = uniform(random, 0, d);
  std::vector<Disc> discs;
  const int n = static_cast<int>((room.width + room.height) / d) + 2;
  for (int row = -n; row <= n; ++row)
    for (int i = -n; i <= n; ++i) {
      const double u = d * (i + 0.5 * (row & 1)), v = d * std::sqrt(0.75) * row;
      Disc disc;
      disc.x = room.x + 0.5 * room.width + x0 + std::cos(turn) * u - std::sin(turn) * v;
      disc.y = room.br().y - y0 + std::sin(turn) * u + std::cos(turn) * v;
      disc.radius = radius;
      if (disc.x >= room.x + radius && disc.x <= room.br().x - radius && disc.y >= room.y + radius &&
          disc.y <= room.br().y - radius)
        discs.push_back(disc);
    }
  std::sort(discs.begin(), discs.end(), [](const Disc& a, const Disc& b) { return a.y > b.y; });
  if (discs.size() > count) discs.resize(count);
  return discs;
}

std::vector<Disc> deposited(const std::vector<double>& radii, cv::Rect2d room, std::mt19937_64& random) {
  std::vector<Placed> bed;
  for (const double r : radii)
    bed.push_back(drop(bed, uniform(random, room.x + r, room.br().x - r), r, room.x, room.br().x));
  for (std::size_t k = 0; k < bed.size(); ++k)
    for (std::size_t j = 0; j < k; ++j)
      if (std::hypot(bed[k].x - bed[j].x, bed[k].height - bed[j].height) <
          bed[k].radius + bed[j].radius - 1e-4)
        throw std::logic_error("drop and roll made discs that overlap");
  std::vector<Disc> discs;
  for (const Placed& p : bed) {
    Disc d;
    d.x = p.x;
    d.y = room.br().y - p.height;
    d.radius = p.radius;
    discs.push_back(d);
  }
  return discs;
}

}  // namespace twincell::imaging::rendered
