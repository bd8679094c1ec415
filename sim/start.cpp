#include "sim/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <string_view>

#include "analysis/trajectory/atomic_file.hpp"
#include "analysis/trajectory/error.hpp"
#include "analysis/trajectory/h5md_file.hpp"
#include "sim/cell_grid.hpp"

namespace twincell::sim {

namespace {

// Of close packing, in diameters.
constexpr double kRowSpacing = 0.86602540378443865;    // sqrt(3)/2: rows in a layer
constexpr double kLayerSpacing = 0.81649658092772603;  // sqrt(2/3): layers
constexpr double kLayerShift = 0.28867513459481288;    // 1/sqrt(12): from a row to the hollows beside it

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

/// Positions, sizes and perturbations draw from streams of their own: one of them does not change the others.
enum class Stream : std::uint64_t { positions = 0, sizes = 1, perturbation = 2 };

std::mt19937_64 engine_of(const Scene& scene, Stream stream) {
  return std::mt19937_64(scene.seed + 0x9E3779B97F4A7C15u * static_cast<std::uint64_t>(stream));
}

/// Uniform in [0, 1) from the 53 high bits: the same numbers with every standard library.
double uniform(std::mt19937_64& engine) {
  return static_cast<double>(engine() >> 11) * 0x1p-53;
}

/// Of mean 0 and variance 1 (Box and Muller).
double normal(std::mt19937_64& engine) {
  const double r = std::sqrt(-2 * std::log(1 - uniform(engine)));
  return r * std::cos(2 * std::numbers::pi * uniform(engine));
}

/// How far a bead reaches into the wall it is deepest in; negative: how far it is from the nearest.
struct WallOverlap {
  double depth = -HUGE_VAL;
  const Wall* wall = nullptr;
};
WallOverlap deepest_wall(const std::vector<Wall>& walls, const Vec3& r, double radius) {
  WallOverlap deepest;
  for (const Wall& wall : walls)
    if (const double depth = radius - (wall.n.dot(r) - wall.offset); depth > deepest.depth)
      deepest = {depth, &wall};
  return deepest;
}

/// Height that beads may not reach, be it a lid or the next period.
double ceiling_of(const Scene& scene) {
  return scene.lid || scene.bottom == Edge::periodic ? scene.height.value_or(HUGE_VAL) : HUGE_VAL;
}

/// "a cell 20 wide, 5 deep and 10 high", as far as it is limited.
std::string describe_cell(const Scene& scene) {
  std::string text = fmt::format("a cell {:g} wide", scene.width);
  if (scene.dimension == 3) text += fmt::format(", {:g} deep", scene.depth);
  if (const double top = ceiling_of(scene); std::isfinite(top)) text += fmt::format(", {:g} high", top);
  return text;
}

/// Puts beads on the sites of a lattice of constant `d` that `level(k, offer)` names, level by level, until
/// offer(x, y, z) says that all are placed.
template <class Level>
Start fill_lattice(const Scene& scene, const std::vector<double>& radii, double d, Level level) {
  const auto walls = scene.walls();
  const auto period = scene.period();
  // Twenty beads of diameter 1 fit into a width of 20 whatever the rounding.
  const double ceiling = ceiling_of(scene), slack = 1e-9 * d;
  Start start;
  const auto free = [&](double radius, const Vec3& r) {
    if (deepest_wall(walls, r, radius).depth > slack || r.z() + radius > ceiling + slack) return false;
    if (!scene.intruder) return true;
    const Vec3 apart = r - Vec3(scene.intruder->x, scene.intruder->y, scene.intruder->z);
    return (apart + nearest_shift(apart, period)).norm() >= radius + scene.intruder->radius;
  };
  const double obstacle = scene.intruder ? 2 * scene.intruder->radius : 0;
  const auto most_empty =
      static_cast<std::size_t>(4 + 2 * obstacle / d);  // levels beside an intruder that fills the cell
  for (std::size_t k = 0, empty = 0; start.beads.size() < radii.size(); ++k) {
    const std::size_t before = start.beads.size();
    level(k, [&](double x, double y, double z) {
      const double radius = radii[start.beads.size()];
      if (const Vec3 r(x, y, z); free(radius, r)) start.beads.push_back(bead_at(scene, radius, r));
      return start.beads.size() < radii.size();
    });
    empty = start.beads.size() > before ? 0 : empty + 1;
    if (empty > most_empty)
      throw ConfigError({scene.file, 0, 0, "beads.count"},
                        fmt::format("only {} of {} beads fit on the lattice in {}.", start.beads.size(),
                                    radii.size(), describe_cell(scene)));
  }
  if (scene.intruder) start.beads.push_back(intruder_of(scene));
  return start;
}

/// The plane y of a lattice of one row; nothing if there is room for more.
std::optional<double> only_row(const Scene& scene, double d) {
  if (scene.dimension == 2) return 0;
  const bool slot = scene.plates != Edge::periodic && scene.depth < d * (1 + kLayerShift);
  return slot ? std::optional(scene.depth / 2) : std::nullopt;
}

/// A number that rounding has brought a little below a whole one counts as that one.
std::size_t whole(double q) {
  return static_cast<std::size_t>(std::max(0.0, std::floor(q + 1e-9)));
}

/// How many lattice lines fit into `length`, the first half a diameter inside. Across a period the last is a
/// diameter or more from the first one's image, unless an even number closes without a gap.
std::size_t lines(double length, double spacing, double d, bool periodic) {
  const std::size_t with_gap = whole((length - d) / spacing) + 1;
  return periodic ? std::max(with_gap, 2 * whole(length / (2 * spacing))) : with_gap;
}

double lattice_constant(const std::vector<double>& radii, const Scene& scene) {
  return radii.empty() ? 2 * scene.radius : 2 * *std::max_element(radii.begin(), radii.end());
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

Start crystal_a(const Scene& scene) {
  const std::vector<double> radii = draw_radii(scene, scene.n_beads.value_or(0));
  const double d = lattice_constant(radii, scene);
  const std::size_t full = std::max<std::size_t>(1, whole(scene.width / d));
  const std::size_t offset_row =
      scene.sides == Edge::periodic ? full : std::max<std::size_t>(1, whole((scene.width - d / 2) / d));
  // Returns whether more beads are wanted.
  const auto row = [&](bool odd, double y, double z, auto offer) {
    const double first = odd ? d : d / 2;
    for (std::size_t i = 0; i < (odd ? offset_row : full); ++i)
      if (!offer(first + static_cast<double>(i) * d, y, z)) return false;
    return true;
  };
  if (const auto y = only_row(scene, d))
    return fill_lattice(scene, radii, d, [&](std::size_t k, auto offer) {
      row(k % 2 == 1, *y, d / 2 + static_cast<double>(k) * kRowSpacing * d, offer);
    });
  const std::size_t rows = lines(scene.depth, kRowSpacing * d, d, scene.plates == Edge::periodic);
  return fill_lattice(scene, radii, d, [&](std::size_t k, auto offer) {
    const double first = d / 2 + (k % 2 == 1 ? kLayerShift * d : 0);
    const double z = d / 2 + static_cast<double>(k) * kLayerSpacing * d;
    for (std::size_t r = 0; r < rows; ++r)
      if (!row((r + k) % 2 == 1, first + static_cast<double>(r) * kRowSpacing * d, z, offer)) return;
  });
}

Start crystal_b(const Scene& scene) {
  const std::vector<double> radii = draw_radii(scene, scene.n_beads.value_or(0));
  const double d = lattice_constant(radii, scene);
  if (const auto y = only_row(scene, d)) {
    const std::size_t columns = lines(scene.width, kRowSpacing * d, d, false);
    return fill_lattice(scene, radii, d, [&](std::size_t k, auto offer) {
      for (const bool odd : {false, true})
        for (std::size_t c = odd ? 1 : 0; c < columns; c += 2)
          if (!offer(d / 2 + static_cast<double>(c) * kRowSpacing * d, *y,
                     d / 2 + (static_cast<double>(k) + (odd ? 0.5 : 0)) * d))
            return;
    });
  }
  const std::size_t layers = lines(scene.width, kLayerSpacing * d, d, scene.sides == Edge::periodic),
                    rows = lines(scene.depth, kRowSpacing * d, d, scene.plates == Edge::periodic);
  return fill_lattice(scene, radii, d, [&](std::size_t k, auto offer) {
    for (const std::size_t odd : {0U, 1U})
      for (std::size_t l = 0; l < layers; ++l)
        for (std::size_t r = (l + odd) % 2; r < rows; r += 2)
          if (!offer(d / 2 + static_cast<double>(l) * kLayerSpacing * d,
                     d / 2 + static_cast<double>(r) * kRowSpacing * d + (l % 2 == 1 ? kLayerShift * d : 0),
                     d / 2 + (static_cast<double>(k) + 0.5 * static_cast<double>(odd)) * d))
            return;
  });
}

namespace {

/// Height of a column in which the beads find random places quickly: random placement gets slow near its
/// limit, 0.547 of the area in 2D, 0.38 of the volume in 3D.
double column_height(const Scene& scene, const std::vector<double>& radii) {
  const bool flat = scene.dimension == 2;
  const double r = scene.radius, powers = flat ? 2 : 3;
  double in_beads = 0;  // of radius r
  for (const double radius : radii) in_beads += std::pow(radius / r, powers);
  if (scene.intruder) in_beads += std::pow(scene.intruder->radius / r, powers);
  const double filled =
      flat ? in_beads * std::numbers::pi * r * r / (0.4 * scene.width)
           : in_beads * 4 / 3 * std::numbers::pi * r * r * r / (0.25 * scene.width * scene.depth);
  const double needed =
      std::max({6 * r, filled, scene.intruder ? scene.intruder->z + scene.intruder->radius : 0.0});
  const double ceiling = ceiling_of(scene);
  return scene.g() == 0 && std::isfinite(ceiling) ? ceiling : std::min(needed, ceiling);
}

}  // namespace

Start random_deposit(const Scene& scene) {
  const std::size_t n = scene.n_beads.value_or(0);
  const std::vector<double> radii = draw_radii(scene, n);
  const auto walls = scene.walls();
  const auto period = scene.period();
  const double height = column_height(scene, radii);
  Start start;
  start.beads.resize(n);
  double largest = radii.empty() ? scene.radius : *std::max_element(radii.begin(), radii.end());
  if (scene.intruder) {
    start.beads.push_back(intruder_of(scene));
    largest = std::max(largest, scene.intruder->radius);
  }
  CellGrid grid(start.beads.size(), largest, 0, scene.dimension, period);
  if (scene.intruder)
    grid.insert(static_cast<std::int32_t>(n), centre_of(start.beads[n]), scene.intruder->radius);

  std::mt19937_64 engine = engine_of(scene, Stream::positions);
  const auto along = [&](double extent, double radius, bool periodic) {
    return periodic ? extent * uniform(engine) : radius + (extent - 2 * radius) * uniform(engine);
  };
  // Large beads first: they find no room between small ones.
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return radii[i] > radii[j]; });
  long tries_left = 2000L * static_cast<long>(n) + 100000;
  for (const std::size_t i : order) {
    const double radius = radii[i];
    for (bool placed = false; !placed;) {
      if (--tries_left < 0)
        throw ConfigError({scene.file, 0, 0, "beads.count"},
                          fmt::format("{} beads find no random places in {}.", n, describe_cell(scene)));
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
      b.vz = scene.velocity_scale * (2 * uniform(engine) - 1);
      grid.insert(static_cast<std::int32_t>(i), r, radius);
    }
  }
  return start;
}

namespace {

/// The pairs that relax_overlaps looks at, good until a bead has moved half the margin.
class NearPairs {
 public:
  NearPairs(const std::vector<Bead>& beads, const Scene& scene)
      : dimension_(scene.dimension), period_(scene.period()) {
    double smallest = HUGE_VAL;
    for (const Bead& b : beads) smallest = std::min(smallest, b.radius);
    margin_ = 0.5 * smallest;
  }
  /// Sorted by (i, j), so that the order of pushing is the same however the pairs were found.
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

double relax_overlaps(std::vector<Bead>& beads, const Scene& scene, double tolerance, int max_sweeps) {
  constexpr double kLargestPush = 0.01;
  const auto walls = scene.walls();
  const auto period = scene.period();
  NearPairs near(beads, scene);
  double worst = 0;
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    worst = 0;
    for (const auto& [i, j] : near.of(beads)) {
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

void require_count(const Scene& scene, std::size_t found, const std::string& source) {
  if (scene.n_beads && *scene.n_beads != found)
    throw ConfigError({scene.file, 0, 0, "beads.count"},
                      fmt::format("{} beads were announced, {} holds {}.", *scene.n_beads, source, found));
}

/// A column of a file that must hold positive numbers, or is absent.
void require_positive(const Scene& scene, const std::vector<double>& column, const char* name) {
  for (std::size_t i = 0; i < column.size(); ++i)
    if (!(column[i] > 0 && std::isfinite(column[i])))
      throw InputError(
          {scene.from.string(), 0, 0, name},
          fmt::format("{} of bead {} is out of range; the value must be greater than 0.", column[i], i));
}

}  // namespace

Start from_trajectory(const Scene& scene) {
  const H5mdReader file(scene.from);
  const TrajectoryInfo& info = file.info();
  if (scene.frame >= file.n_frames())
    throw ConfigError(
        {scene.file, 0, 0, "start.frame"},
        fmt::format("frame {} was asked for, {} has {}.", scene.frame, scene.from.string(), file.n_frames()));
  if (info.box.dimension == 3 && scene.dimension == 2)
    throw ConfigError({scene.file, 0, 0, "start.from"},
                      fmt::format("{} is three-dimensional, the cell is not; say cell.dimension = 3.",
                                  scene.from.string()));
  const bool own_sizes = info.source == "simulation";
  if (own_sizes) {
    require_positive(scene, info.radius, "radius");
    require_positive(scene, info.mass, "mass");
  }
  const std::vector<double> drawn = draw_radii(scene, info.n_beads);
  Frame frame;
  file.read(scene.frame, frame);
  // Along the axis of the drive positions count from the plate, which will be at its mean.
  Vec3 origin(info.box.lower.x(), info.box.lower.y(), 0);
  if (!std::isnan(frame.plate_height))
    origin += frame.plate_height * Vec3::Unit(static_cast<int>(info.drive ? info.drive->axis : Axis::z));
  Start start;
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    if (!frame.present(i)) continue;
    Vec3 r = info.box.wrap(frame.position[i]) - origin;
    if (scene.dimension == 2) r.y() = 0;
    if (scene.dimension == 3 && info.box.dimension == 2) r.y() = scene.depth / 2;
    const double radius = own_sizes && !info.radius.empty() ? info.radius[i] : drawn[i];
    const double mass = own_sizes && !info.mass.empty() ? info.mass[i] : scene.mass_of(radius);
    start.beads.push_back(bead_at(scene, radius, mass, r));
    if (!info.tracer.empty()) start.tracer.push_back(info.tracer[i]);
  }
  require_count(scene, start.beads.size(), fmt::format("frame {} of {}", scene.frame, scene.from.string()));
  // A camera's noise is a few hundredths of a diameter; beyond 0.2 it is not this cell.
  constexpr double kRefused = 0.2, kTolerated = 1e-4, kLeft = 0.05;
  require_sound(start.beads, scene, kRefused);
  const double left = relax_overlaps(start.beads, scene, kTolerated, 20000);
  if (left > kLeft)
    throw ConfigError(
        {scene.file, 0, 0, "start.from"},
        fmt::format(
            "{}: the beads cannot be pushed apart, an overlap of {:.3g} sigma is left, the bound is {:g}; is "
            "the width right?",
            scene.from.string(), left, kLeft));
  return start;
}

namespace {

struct Column {
  std::string_view name;
  double Bead::*member;
  bool space_only = false;  ///< belongs to the third dimension
  bool positive = false;
};
constexpr Column kColumns[] = {{"x", &Bead::x},
                               {"y", &Bead::y, true},
                               {"z", &Bead::z},
                               {"vx", &Bead::vx},
                               {"vy", &Bead::vy, true},
                               {"vz", &Bead::vz},
                               {"spin", &Bead::spin},
                               {"spin_x", &Bead::spin_x, true},
                               {"spin_z", &Bead::spin_z, true},
                               {"radius", &Bead::radius, false, true},
                               {"mass", &Bead::mass, false, true}};

/// A field of a CSV line and where it begins, from 1.
struct Field {
  std::string_view text;
  long column;
};

std::vector<Field> split(std::string_view line) {
  std::vector<Field> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    std::size_t first = begin, last = end;
    while (first < last && line[first] == ' ') ++first;
    while (last > first && line[last - 1] == ' ') --last;
    fields.push_back({line.substr(first, last - first), static_cast<long>(first) + 1});
    begin = end + 1;
  }
  return fields;
}

/// The header and the rows of a bead table.
class BeadTable {
 public:
  BeadTable(const Scene& scene, const std::vector<Field>& header, long line) : scene_(scene) {
    for (const Field& f : header) {
      const Where where{scene.from.string(), line, f.column, std::string(f.text)};
      const auto known = std::find_if(std::begin(kColumns), std::end(kColumns),
                                      [&](const Column& c) { return c.name == f.text; });
      if (known == std::end(kColumns))
        throw InputError(
            where,
            "there is no such column; a bead has x, y, z, vx, vy, vz, spin, spin_x, spin_z, radius, mass.");
      if (known->space_only && scene.dimension == 2)
        throw InputError(where, "beads of a 2D cell have no such column.");
      if (has(known->name)) throw InputError(where, "the column is there twice.");
      columns_.push_back(known);
    }
    for (const char* needed : {"x", "z"})
      if (!has(needed)) throw InputError({scene.from.string(), line, 0, needed}, "the column is missing.");
  }

  [[nodiscard]] Bead row(const std::vector<Field>& fields, long line) const {
    if (fields.size() != columns_.size())
      throw InputError({scene_.from.string(), line, 0, ""},
                       fmt::format("{} columns are needed, here are {}.", columns_.size(), fields.size()));
    Bead b = bead_at(scene_, scene_.radius, Vec3(0, scene_.dimension == 3 ? scene_.depth / 2 : 0, 0));
    for (std::size_t k = 0; k < fields.size(); ++k)
      b.*columns_[k]->member = number(fields[k], *columns_[k], line);
    if (!has("mass")) b.mass = scene_.mass_of(b.radius);
    b.inertia = scene_.inertia_factor * b.mass * b.radius * b.radius;
    return b;
  }

 private:
  [[nodiscard]] bool has(std::string_view name) const {
    return std::any_of(columns_.begin(), columns_.end(), [&](const Column* c) { return c->name == name; });
  }
  [[nodiscard]] double number(const Field& f, const Column& column, long line) const {
    const Where where{scene_.from.string(), line, f.column, std::string(column.name)};
    double value = 0;
    const auto [end, error] = std::from_chars(f.text.data(), f.text.data() + f.text.size(), value);
    if (error != std::errc() || end != f.text.data() + f.text.size() || !std::isfinite(value))
      throw InputError(where, fmt::format("a finite number is needed, not '{}'.", f.text));
    if (column.positive && !(value > 0))
      throw InputError(where, fmt::format("{} is out of range; the value must be greater than 0.", value));
    return value;
  }

  const Scene& scene_;
  std::vector<const Column*> columns_;
};

}  // namespace

Start from_table(const Scene& scene) {
  const std::string text = read_text_file(scene.from);
  std::optional<BeadTable> table;
  Start start;
  long line_number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    ++line_number;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line.empty()) continue;
    if (!table)
      table.emplace(scene, split(line), line_number);
    else
      start.beads.push_back(table->row(split(line), line_number));
  }
  if (!table)
    throw InputError({scene.from.string(), 0, 0, ""},
                     "the table is empty; its first line names the columns.");
  require_count(scene, start.beads.size(), scene.from.string());
  return start;
}

Start make_start(const Scene& scene) {
  const auto place = [&] {
    switch (scene.start) {
      case StartKind::crystal_a:
        return crystal_a(scene);
      case StartKind::crystal_b:
        return crystal_b(scene);
      case StartKind::random:
        return random_deposit(scene);
      case StartKind::trajectory:
        return from_trajectory(scene);
      case StartKind::table:
        break;
    }
    return from_table(scene);
  };
  Start start = place();
  if (scene.perturbation == 0) return start;
  std::mt19937_64 engine = engine_of(scene, Stream::perturbation);
  const auto shift = [&] { return scene.perturbation * (2 * uniform(engine) - 1); };
  for (Bead& b : start.beads) {
    b.x += shift();
    if (scene.dimension == 3) b.y += shift();
    b.z += shift();
  }
  return start;
}

namespace {

/// H16: no bead may come near two images of another.
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
          {scene.file, 0, 0, "cell"},
          fmt::format("a bead of radius {:g} would meet two images of another: a period of {:g} is less "
                      "than {:g}, twice the reach of the pair list.",
                      first, period, 2 * reach));
}

}  // namespace

void require_sound(const std::vector<Bead>& beads, const Scene& scene, double bound) {
  const Where where{scene.file, 0, 0, "start"};
  const auto walls = scene.walls();
  for (std::size_t i = 0; i < beads.size(); ++i) {
    const Bead& b = beads[i];
    if (!std::isfinite(b.x + b.y + b.z + b.vx + b.vy + b.vz + b.spin + b.spin_x + b.spin_z))
      throw ConfigError(where, fmt::format("bead {} has no finite position or velocity.", i));
    if (const WallOverlap outside = deepest_wall(walls, centre_of(b), b.radius);
        outside.depth > bound * 2 * b.radius)
      throw ConfigError(
          where, fmt::format("bead {} at ({:.4g}, {:.4g}, {:.4g}) reaches {:.3g} sigma into the wall \"{}\" "
                             "of {}, the bound is {:g}.",
                             i, b.x, b.y, b.z, outside.depth, outside.wall->name, describe_cell(scene),
                             bound * 2 * b.radius));
  }
  require_periods(beads, scene);
  double deepest = 0;
  std::size_t how_many = 0;
  std::string worst;
  for_each_near_pair(beads, scene.dimension, scene.period(), 0,
                     [&](std::int32_t i, std::int32_t j, double gap, const Vec3&) {
                       const double allowed = bound * 2 *
                                              std::min(beads[static_cast<std::size_t>(i)].radius,
                                                       beads[static_cast<std::size_t>(j)].radius);
                       if (-gap <= allowed) return;
                       ++how_many;
                       if (-gap <= deepest) return;
                       deepest = -gap;
                       worst = fmt::format("beads {} and {} overlap by {:.3g} sigma, the bound is {:g}", i, j,
                                           deepest, allowed);
                     });
  if (how_many > 0)
    throw ConfigError(
        where, how_many == 1 ? worst + "." : fmt::format("{}; so do {} pairs more.", worst, how_many - 1));
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
