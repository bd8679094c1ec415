#include "sim/scene/check_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "sim/scene/read_tables.hpp"

namespace twincell::sim {

namespace {

using Section = ConfigSection;

/// Extents of the cell along x, y, z where a boundary limits it; 0: open.
std::array<double, 3> limited_extent(const Scene& s) {
  const bool capped = s.lid || s.bottom == Edge::periodic;
  return {s.sides == Edge::absent ? 0 : s.width, s.dimension == 2 || s.plates == Edge::absent ? 0 : s.depth,
          capped ? s.height.value_or(0) : 0};
}

constexpr const char* kExtentKeys[] = {"width", "depth", "height"};

void check_height(const Scene& s, const Section& cell) {
  if (s.lid && s.bottom == Edge::periodic)
    throw ConfigError(cell.where("lid"), "contradicts cell.bottom: a cell periodic along z has no lid.");
  if (s.lid && !s.height) throw ConfigError(cell.where("height"), "a lid needs its height.");
  if (s.bottom == Edge::periodic && !s.height)
    throw ConfigError(cell.where("height"), "a cell periodic along z needs its period, the height.");
}

void check_sizes(const Scene& s, const Section& cell, const Section& beads) {
  const double largest = s.radius * (1 + largest_deviation(s.spread, s.spread_width));
  const double intruder = s.intruder ? s.intruder->radius : 0;
  const auto extent = limited_extent(s), period = s.period();
  for (std::size_t a = 0; a < 3; ++a) {
    if (extent[a] == 0) continue;
    // The tolerance admits a bed that just fits, whatever the rounding.
    const double slack = 1e-9 * extent[a];
    if (2 * largest > extent[a] + slack)
      throw ConfigError(
          beads.where("radius"),
          fmt::format("a bead of diameter {:g} does not fit into a cell {:g} {}.", 2 * largest, extent[a],
                      a == 0   ? "wide"
                      : a == 1 ? "deep"
                               : "high"));
    if (2 * intruder > extent[a] + slack)
      throw ConfigError(beads.where("intruder.radius"),
                        fmt::format("an intruder of diameter {:g} does not fit into a cell {:g} {}.",
                                    2 * intruder, extent[a],
                                    a == 0   ? "wide"
                                    : a == 1 ? "deep"
                                             : "high"));
    if (period[a] == 0) continue;
    const double reach = largest + std::max(largest, intruder) + kListReach * 2 * std::max(largest, intruder);
    if (period[a] < 2 * reach)
      throw ConfigError(
          cell.where(kExtentKeys[a]),
          fmt::format("a bead would meet two images of another: a period of {:g} is less than {:g}, twice "
                      "the reach of the pair list.",
                      period[a], 2 * reach));
  }
}

void check_intruder(const Scene& s, const Section& beads) {
  if (!s.intruder) return;
  const Section table = beads.section("intruder");
  if (start_row(s.start).from_file)
    throw ConfigError(table.where(""),
                      "a file contains all beads, including the intruder; remove this table.");
  const Vec3 r(s.intruder->x, s.intruder->y, s.intruder->z);
  for (const Wall& wall : s.walls()) {
    const double outside = s.intruder->radius - (wall.n.dot(r) - wall.offset);
    if (outside > 1e-9 * s.intruder->radius)
      throw ConfigError(table.where(""),
                        fmt::format("the intruder at ({:g}, {:g}, {:g}) reaches {:.3g} into the wall \"{}\".",
                                    r.x(), r.y(), r.z(), outside, wall.name));
  }
}

void check_gravity(const Scene& s, const Section& cell) {
  const Where where = cell.where("gravity");
  if (s.g() == 0) {
    const char* open = s.sides == Edge::absent                        ? "sides are open"
                       : s.dimension == 3 && s.plates == Edge::absent ? "front and back are open"
                       : s.bottom == Edge::absent                     ? "bottom is open"
                       : s.bottom == Edge::wall && !s.lid             ? "top is open"
                                                                      : nullptr;
    if (open != nullptr)
      throw ConfigError(where, fmt::format("without gravity beads leave the cell for ever: its {}.", open));
    return;
  }
  // A periodic axis has no wall. Beads that gravity presses against another wall may then slide along that
  // axis.
  const auto walls = s.walls();
  if (std::none_of(walls.begin(), walls.end(), [&](const Wall& w) { return w.n.dot(s.gravity) < 0; }))
    throw ConfigError(
        where,
        fmt::format("no wall supports the beads, which gravity ({:g}, {:g}, {:g}) accelerates for ever.",
                    s.gravity.x(), s.gravity.y(), s.gravity.z()));
}

void check_horizontal(const Scene& s, const Section& drive) {
  const Where where = drive.where("horizontal");
  if (s.drive.axis != Axis::z)
    throw ConfigError(where, "is a motion along x beside that along z, but drive.axis is not \"z\".");
  if (s.drive.recorded) throw ConfigError(where, "contradicts drive.file: a record has one direction.");
}

void check_ramp(const Scene& s, const Section& drive) {
  if (s.until)
    throw ConfigError(
        drive.where("ramp"),
        "contradicts [until]: no mean converges while the drive changes; remove one of the two.");
  const bool goes_on = s.in_motion || s.phase.value_or(0) > 0;
  if (s.drive.ramp->changes_frequency() && s.drive.ramp->first == 0 && goes_on)
    throw ConfigError(drive.where("ramp"),
                      "changes the frequency, and the drive begins within a cycle; set time.discard to at "
                      "least 1, so that the ramp begins with a whole cycle.");
}

void check_drive(const Scene& s, const Section& drive) {
  const auto walls = s.walls();
  if (s.drive.moves() && std::none_of(walls.begin(), walls.end(), [](const Wall& w) { return w.moves; }))
    throw ConfigError(drive.where(""), "moves nothing: no wall rides with the plate.");
  if (s.drive.horizontal) check_horizontal(s, drive);
  if (s.drive.ramp) check_ramp(s, drive);
}

void check_contact_tables(const Scene& s, const Section& contact) {
  const auto walls = s.walls();
  for (const auto& [table, names] : wall_tables()) {
    const auto& name = names.front();
    if (contact.has(table) &&
        std::none_of(walls.begin(), walls.end(), [&](const Wall& w) { return w.name == name; }))
      throw ConfigError(contact.where(table), "the cell has no such wall.");
  }
  if (walls.empty() && contact.has("wall"))
    throw ConfigError(contact.where("wall"), "the cell has no walls.");
}

}  // namespace

void check_scene(const Scene& s, const ConfigSection& root) {
  const Section cell = root.section("cell"), beads = root.section("beads"), drive = root.section("drive");
  check_height(s, cell);
  check_sizes(s, cell, beads);
  check_intruder(s, beads);
  check_gravity(s, cell);
  check_drive(s, drive);
  check_contact_tables(s, root.section("contact"));
}

}  // namespace twincell::sim
