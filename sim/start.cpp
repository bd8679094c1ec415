#include "sim/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "analysis/trajectory/error.hpp"
#include "analysis/trajectory/h5md_file.hpp"
#include "sim/laws/side.hpp"
#include "sim/pair_list.hpp"

namespace twincell::sim {

namespace {

constexpr double kRowSpacing = 0.86602540378443865;  // sqrt(3)/2 diameters

Bead bead_at(const Scene& scene, double x, double z) {
  return {x,          z,
          0,          0,
          0,          scene.radius,
          scene.mass, scene.inertia_factor * scene.mass * scene.radius * scene.radius};
}

/// Uniform in [0, 1) from the 53 high bits: the same numbers with every standard library.
double uniform(std::mt19937_64& engine) {
  return static_cast<double>(engine() >> 11) * 0x1p-53;
}

double separation(double dx, double width, bool periodic) {
  return periodic ? PeriodicSides{width}.separation(dx) : dx;
}

}  // namespace

Start crystal_a(const Scene& scene) {
  const double d = 2 * scene.radius;
  const std::size_t n = scene.n_beads.value_or(0);
  Start start;
  // A tiny slack, so that 20 beads of diameter 1 fit into a width of 20 whatever the rounding.
  const auto fits = [&](double width) {
    return static_cast<std::size_t>(std::max(0.0, std::floor(width / d + 1e-9)));
  };
  const std::size_t full = std::max<std::size_t>(1, fits(scene.width));
  const std::size_t offset_row =
      scene.periodic_sides ? full : std::max<std::size_t>(1, fits(scene.width - d / 2));
  for (std::size_t row = 0; start.beads.size() < n; ++row) {
    const bool odd = row % 2 == 1;
    const std::size_t in_row = odd ? offset_row : full;
    const double first = odd ? d : d / 2;
    for (std::size_t i = 0; i < in_row && start.beads.size() < n; ++i)
      start.beads.push_back(bead_at(scene, first + static_cast<double>(i) * d,
                                    d / 2 + static_cast<double>(row) * kRowSpacing * d));
  }
  return start;
}

Start crystal_b(const Scene& scene) {
  const double d = 2 * scene.radius;
  const std::size_t n = scene.n_beads.value_or(0);
  const auto columns = static_cast<std::size_t>(std::floor((scene.width - d) / (kRowSpacing * d) + 1e-9)) + 1;
  Start start;
  for (std::size_t level = 0; start.beads.size() < n; ++level)
    for (const bool odd : {false, true})
      for (std::size_t c = odd ? 1 : 0; c < columns && start.beads.size() < n; c += 2)
        start.beads.push_back(bead_at(scene, d / 2 + static_cast<double>(c) * kRowSpacing * d,
                                      d / 2 + (static_cast<double>(level) + (odd ? 0.5 : 0)) * d));
  return start;
}

Start random_deposit(const Scene& scene) {
  constexpr double kFilling = 0.4;  // random placement gets slow near its limit of 0.547
  const std::size_t n = scene.n_beads.value_or(0);
  const double r = scene.radius, d = 2 * r;
  const double height =
      std::max(3 * d, static_cast<double>(n) * std::numbers::pi * r * r / (kFilling * scene.width));
  std::mt19937_64 engine(scene.seed);
  Start start;
  std::vector<std::vector<std::size_t>> rows(static_cast<std::size_t>(height / d) +
                                             3);  // bead indices by height
  for (long tries = 0; start.beads.size() < n; ++tries) {
    if (tries > 2000L * static_cast<long>(n) + 100000)
      throw ConfigError({scene.file, 0, 0, "cell.width"},
                        fmt::format("{} beads find no random places in a cell {} wide.", n, scene.width));
    const double span = scene.periodic_sides ? scene.width : scene.width - d;
    const double x = (scene.periodic_sides ? 0 : r) + span * uniform(engine),
                 z = r + (height - d) * uniform(engine);
    const auto row = static_cast<std::size_t>(z / d);
    bool clear = true;
    for (std::size_t q = row == 0 ? 0 : row - 1; q <= row + 1 && clear; ++q)
      for (const std::size_t j : rows[q])
        clear = clear && std::hypot(separation(x - start.beads[j].x, scene.width, scene.periodic_sides),
                                    z - start.beads[j].z) >= d;
    if (!clear) continue;
    rows[row].push_back(start.beads.size());
    Bead b = bead_at(scene, x, z);
    b.vx = 2 * uniform(engine) - 1;
    b.vz = 2 * uniform(engine) - 1;
    start.beads.push_back(b);
  }
  return start;
}

double relax_overlaps(std::vector<Bead>& beads, double width, bool periodic, double tolerance,
                      int max_sweeps) {
  constexpr double kLargestPush = 0.01;
  double worst = 0;
  System system;
  system.beads = beads;
  system.width = width;
  PairList list(0.25, periodic ? width : 0, !periodic);
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    list.refresh(system);
    worst = 0;
    for (const Pair& p : list.pairs) {
      Bead &a = system.beads[static_cast<std::size_t>(p.i)], &b = system.beads[static_cast<std::size_t>(p.j)];
      const double dx = separation(a.x - b.x, width, periodic), dz = a.z - b.z;
      const double r = std::max(std::hypot(dx, dz), 1e-12), overlap = a.radius + b.radius - r;
      if (overlap <= 0) continue;
      worst = std::max(worst, overlap);
      const double push = std::min(overlap, kLargestPush) / 2;
      a.x += push * dx / r, a.z += push * dz / r;
      b.x -= push * dx / r, b.z -= push * dz / r;
    }
    for (Bead& b : system.beads) {
      const double before_x = b.x, before_z = b.z;
      if (!periodic) b.x = std::clamp(b.x, b.radius, width - b.radius);
      b.z = std::max(b.z, b.radius);
      worst = std::max({worst, std::abs(b.x - before_x), std::abs(b.z - before_z)});
    }
    if (worst <= tolerance) break;
  }
  beads = system.beads;
  return worst;
}

Start from_trajectory(const Scene& scene) {
  const H5mdReader file(scene.from);
  const Where where{scene.file, 0, 0, "start.frame"};
  if (scene.frame >= file.n_frames())
    throw ConfigError(where, fmt::format("frame {} was asked for, {} has {}.", scene.frame,
                                         scene.from.string(), file.n_frames()));
  const TrajectoryInfo& info = file.info();
  Frame frame;
  file.read(scene.frame, frame);
  const double plate = std::isnan(frame.plate_height) ? 0 : frame.plate_height;
  Start start;
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    if (!frame.present(i)) continue;
    const Vec3 r = info.box.wrap(frame.position[i]) - Vec3(info.box.lower.x(), 0, 0);
    start.beads.push_back(bead_at(scene, r.x(), r.z() - plate));
    if (!info.tracer.empty()) start.tracer.push_back(info.tracer[i]);
  }
  if (scene.n_beads && *scene.n_beads != start.beads.size())
    throw ConfigError({scene.file, 0, 0, "beads.count"},
                      fmt::format("{} beads were announced, frame {} of {} holds {}.", *scene.n_beads,
                                  scene.frame, scene.from.string(), start.beads.size()));
  constexpr double kRefused = 0.2,
                   kTolerated = 1e-4;  // a camera's noise is a few hundredths; beyond 0.2 it is not this cell
  require_sound(start.beads, scene, kRefused);
  const double left = relax_overlaps(start.beads, scene.width, scene.periodic_sides, kTolerated, 20000);
  if (left > 0.05)
    throw ConfigError(
        {scene.file, 0, 0, "start.from"},
        fmt::format(
            "{}: the beads cannot be pushed apart, an overlap of {:.3g} sigma is left; is the width right?",
            scene.from.string(), left));
  return start;
}

Start make_start(const Scene& scene) {
  switch (scene.start) {
    case StartKind::crystal_a:
      return crystal_a(scene);
    case StartKind::crystal_b:
      return crystal_b(scene);
    case StartKind::random:
      return random_deposit(scene);
    case StartKind::trajectory:
      break;
  }
  return from_trajectory(scene);
}

void require_sound(const std::vector<Bead>& beads, const Scene& scene, double bound) {
  const Where where{scene.file, 0, 0, "start"};
  System system;
  system.beads = beads;
  system.width = scene.width;
  for (std::size_t i = 0; i < beads.size(); ++i) {
    const Bead& b = beads[i];
    if (!std::isfinite(b.x + b.z + b.vx + b.vz + b.spin))
      throw ConfigError(where, fmt::format("bead {} has no finite position or velocity.", i));
    const double outside =
        std::max({scene.periodic_sides ? 0 : b.radius - b.x,
                  scene.periodic_sides ? 0 : b.x + b.radius - scene.width, b.radius - b.z});
    if (outside > bound)
      throw ConfigError(where, fmt::format("bead {} at ({:.4g}, {:.4g}) reaches {:.3g} sigma into a wall of "
                                           "the cell {:g} wide, the bound is {:g}.",
                                           i, b.x, b.z, outside, scene.width, bound));
  }
  PairList list(0.0, scene.periodic_sides ? scene.width : 0, !scene.periodic_sides);
  list.refresh(system, true);
  for (const Pair& p : list.pairs) {
    const Bead &a = beads[static_cast<std::size_t>(p.i)], &b = beads[static_cast<std::size_t>(p.j)];
    const double r = std::hypot(separation(a.x - b.x, scene.width, scene.periodic_sides), a.z - b.z);
    if (a.radius + b.radius - r > bound)
      throw ConfigError(where, fmt::format("beads {} and {} overlap by {:.3g} sigma, the bound is {:g}.", p.i,
                                           p.j, a.radius + b.radius - r, bound));
  }
}

std::vector<std::uint8_t> choose_tracers(const std::vector<Bead>& resting, const Scene& scene) {
  std::vector<std::uint8_t> tracer(resting.size(), 0);
  if (resting.empty()) return tracer;
  double top = 0;
  for (const Bead& b : resting) top = std::max(top, b.z + b.radius);
  const double middle = top / 2, d = 2 * scene.radius;
  auto distance = [&](std::size_t i) { return std::abs(resting[i].z - middle); };
  std::vector<std::size_t> order(resting.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (scene.start == StartKind::crystal_a) {
    const std::size_t nearest = *std::min_element(
        order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
    for (std::size_t i = 0; i < resting.size(); ++i)
      tracer[i] = std::abs(resting[i].z - resting[nearest].z) < kRowSpacing * d / 2 ? 1 : 0;
    return tracer;
  }
  const auto columns = static_cast<std::size_t>(std::max(1.0, std::floor(scene.width / d)));
  std::vector<std::size_t> best(columns, resting.size());
  for (std::size_t i = 0; i < resting.size(); ++i) {
    const auto c = std::min(columns - 1, static_cast<std::size_t>(std::max(0.0, resting[i].x / d)));
    if (best[c] == resting.size() || distance(i) < distance(best[c])) best[c] = i;
  }
  for (const std::size_t i : best)
    if (i < resting.size()) tracer[i] = 1;
  return tracer;
}

}  // namespace twincell::sim
