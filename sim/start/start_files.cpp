#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/error.hpp"
#include "core/table_text.hpp"
#include "sim/scene/plate_motion.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/start/start.hpp"
#include "sim/start/start_parts.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "trajectory/unit_keys.hpp"

namespace twincell::sim {

namespace {

void require_count(const Scene& scene, std::size_t found, const std::string& source) {
  if (scene.n_beads && *scene.n_beads != found)
    throw ConfigError(scene.where("beads.count"), fmt::format("{} beads were specified, but {} contains {}.",
                                                              *scene.n_beads, source, found));
}

/// Checks a column of a file, which must contain positive numbers or be absent.
void require_positive(const Scene& scene, const std::vector<double>& column, const char* name) {
  for (std::size_t i = 0; i < column.size(); ++i)
    if (!(column[i] > 0 && std::isfinite(column[i])))
      throw InputError(
          {scene.from.string(), 0, 0, name},
          fmt::format("{} of bead {} is out of range; the value must be greater than 0.", column[i], i));
}

/// The scene of the run that wrote a file; nullopt if the file does not state it, or not in a form of this
/// version.
std::optional<Scene> scene_of_file(const Scene& scene, const TrajectoryInfo& info) {
  const nlohmann::json provenance = nlohmann::json::parse(info.provenance_json, nullptr, false);
  if (!provenance.is_object() || !provenance.contains("config") || !provenance["config"].is_string())
    return {};
  try {
    return read_scene_text(provenance["config"].get<std::string>(), scene.from.string(), {},
                           scene.from.parent_path());
  } catch (const Error&) {
    return {};
  }
}

/// Refuses beads.mass and beads.radius if the file contains these numbers and most of them are others: the
/// key would have no effect. The keys of the run that wrote the file pass.
/// \param radii, masses the file contains them \param source words for the file
/// \param written gives the scene of that run, if it is known; read only before a refusal
void refuse_void_sizes(
    const Scene& scene, const std::vector<Bead>& beads, bool radii, bool masses, const std::string& source,
    const std::function<std::optional<Scene>()>& written = [] { return std::nullopt; }) {
  constexpr double kSameValue = 1e-6;  // units are converted
  const auto refuse_others = [&](const char* key, const char* numbers, double stated, auto differs) {
    const auto others = std::ranges::count_if(beads, differs);
    if (!scene.source || !scene.source->has(key) || 2 * others <= std::ssize(beads)) return;
    const std::optional<Scene> own = written();
    if (!own || own->radius != scene.radius || own->mass != scene.mass)
      throw ConfigError(scene.where(key),
                        fmt::format("{} has no effect: {} contains the {} of its beads, and {} of {} differ; "
                                    "remove the key.",
                                    stated, source, numbers, others, beads.size()));
  };
  // With masses of their own, radius and mass of a bead do not state a material either.
  if (radii && masses && scene.spread == SizeSpread::none)
    refuse_others("beads.radius", "radii", scene.radius, [&](const Bead& b) {
      return std::abs(b.radius - scene.radius) > kSameValue * scene.radius;
    });
  if (masses)
    refuse_others("beads.mass", "masses", scene.mass, [&](const Bead& b) {
      return std::abs(b.mass - scene.mass_of(b.radius)) > kSameValue * b.mass;
    });
}

/// Start in motion: continues from a frame without changes.
Start start_in_motion(const Scene& scene, const TrajectoryInfo& info, const Frame& frame) {
  const std::string name = fmt::format("frame {} of {}", scene.frame, scene.from.string());
  const auto refuse = [&](const std::string& complaint) {
    throw ConfigError(scene.where("start.in_motion"), name + complaint);
  };
  if (info.source != Origin::simulation)
    refuse(" has source \"" + word_of(info.source) +
           "\"; only frames of a simulation contain the complete motion of a bed.");
  if (!info.columns.velocity) refuse(" has no velocities.");
  if (info.box.dimension != scene.dimension)
    refuse(fmt::format(" has {} dimensions, the cell has {}.", info.box.dimension, scene.dimension));
  if (!scene.phase && (frame.phase < 0 || info.phases_per_cycle <= 0))
    refuse(" has no drive phase; set drive.phase.");
  const Vec3 corner(info.box.lower.x(), scene.dimension == 3 ? info.box.lower.y() : 0, 0);
  Start start;
  std::vector<std::int32_t> slot(frame.position.size(), -1);  // bead index of each slot of the frame
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    if (!frame.present(i)) continue;
    const double radius = info.radius.empty() ? scene.radius : info.radius[i];
    Bead b = bead_at(scene, radius, info.mass.empty() ? scene.mass_of(radius) : info.mass[i],
                     frame.position[i] - corner);
    const Vec3& v = frame.velocity[i];
    b.vx = v.x(), b.vy = v.y(), b.vz = v.z();
    if (!frame.spin.empty())
      b.spin_x = frame.spin[i].x(), b.spin = -frame.spin[i].y(), b.spin_z = frame.spin[i].z();
    slot[i] = static_cast<std::int32_t>(start.beads.size());
    start.beads.push_back(b);
    if (!info.tracer.empty()) start.tracer.push_back(info.tracer[i]);
  }
  // Contacts, forces and surface speeds: needed to continue bit for bit.
  for (ContactMemory c : frame.contacts) {
    c.i = slot[static_cast<std::size_t>(c.i)];
    if (c.j >= 0) c.j = slot[static_cast<std::size_t>(c.j)];
    start.contacts.push_back(std::move(c));
  }
  const auto all_known = [&](const std::vector<Vec3>& column) {
    return column.size() == start.beads.size() &&
           std::ranges::all_of(column, [](const Vec3& v) { return v.allFinite(); });
  };
  if (all_known(frame.force) && all_known(frame.moment))
    for (std::size_t i = 0; i < frame.force.size(); ++i)
      start.forces.push_back({.x = frame.force[i].x(),
                              .z = frame.force[i].z(),
                              .q = frame.moment[i].y(),
                              .y = frame.force[i].y(),
                              .q_x = -frame.moment[i].x(),
                              .q_z = -frame.moment[i].z()});
  if (all_known(frame.rim_speed)) start.rim_speeds = frame.rim_speed;
  // The drive must put the plate where the frame has it.
  start.phase = scene.phase ? *scene.phase : static_cast<double>(frame.phase) / info.phases_per_cycle;
  if (const std::string complaint = displaced_wall(scene, info, frame, *start.phase); !complaint.empty())
    refuse(complaint);
  require_count(scene, start.beads.size(), name);
  refuse_void_sizes(scene, start.beads, !info.radius.empty(), !info.mass.empty(), name,
                    [&] { return scene_of_file(scene, info); });
  return start;
}

}  // namespace

std::string displaced_wall(const Scene& scene, const TrajectoryInfo& info, const Frame& frame, double phase) {
  if (std::isnan(frame.plate_height)) return {};
  const Vec3 here = cell_displacement(scene, phase);
  if (const double plate = scene.envelope.at(phase) * scene.drive.displacement(phase);
      !plate_agrees(scene, frame.plate_height, plate))
    return fmt::format(
        " has its plate at {:g} sigma, but this drive puts it at {:g}; to change the amplitude, "
        "start at a frame in which both are at 0.",
        frame.plate_height, stored_plate_height(scene, plate));
  const std::optional<Scene> written = scene_of_file(scene, info);
  // A plate at rest is stored at 0, from which the displacement of other walls does not follow.
  if (!info.drive || !plate_follows_drive(written ? *written : scene) || frame.phase < 0 ||
      info.phases_per_cycle <= 0)
    return {};
  // The envelope of a run is 1 in all frames that it records.
  Vec3 there = frame.plate_height * Vec3::Unit(static_cast<int>(info.drive->axis));
  there.x() += info.drive->horizontal_displacement(static_cast<double>(frame.phase) / info.phases_per_cycle);
  for (const Wall& wall : scene.walls()) {
    bool moved = wall.moves;
    if (written)
      for (const Wall& other : written->walls())
        if (other.name == wall.name) moved = other.moves;
    const double now = wall.moves ? wall.n.dot(here) : 0, then = moved ? wall.n.dot(there) : 0;
    if (std::abs(now - then) > kSameDisplacement)
      return fmt::format(
          " has the {} wall {:g} sigma from its mean position, but this scene begins with it at {:g}; "
          "start at a frame in which both agree.",
          wall.name, then, now);
  }
  return {};
}

Start from_trajectory(const Scene& scene, Progress& progress) {
  const H5mdReader file(scene.from);
  const TrajectoryInfo& info = file.info();
  if (scene.frame >= file.n_frames())
    throw ConfigError(scene.where("start.frame"),
                      fmt::format("frame {} was requested, but {} has {} frames.", scene.frame,
                                  scene.from.string(), file.n_frames()));
  if (info.box.dimension == 3 && scene.dimension == 2)
    throw ConfigError(scene.where("start.from"),
                      fmt::format("{} is three-dimensional, the cell is not; set cell.dimension = 3.",
                                  scene.from.string()));
  const bool own_sizes = info.source == Origin::simulation;
  if (own_sizes) {
    require_positive(scene, info.radius, "radius");
    require_positive(scene, info.mass, "mass");
  }
  const std::vector<double> drawn = draw_radii(scene, info.n_beads);
  Frame frame;
  file.read(scene.frame, frame);
  if (scene.in_motion) return start_in_motion(scene, info, frame);
  // Along the axes of the drive, positions are relative to the cell, which starts at its mean position.
  Vec3 origin(info.box.lower.x(), info.box.lower.y(), 0);
  if (!std::isnan(frame.plate_height))
    origin += frame.plate_height * Vec3::Unit(static_cast<int>(info.drive ? info.drive->axis : Axis::z));
  if (info.drive && frame.phase >= 0 && info.phases_per_cycle > 0)
    origin.x() +=
        info.drive->horizontal_displacement(static_cast<double>(frame.phase) / info.phases_per_cycle);
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
  const std::string name = fmt::format("frame {} of {}", scene.frame, scene.from.string());
  require_count(scene, start.beads.size(), name);
  if (own_sizes)
    refuse_void_sizes(scene, start.beads, !info.radius.empty(), !info.mass.empty(), name,
                      [&] { return scene_of_file(scene, info); });
  // Camera noise is a few hundredths of a diameter; an overlap beyond 0.2 means that the file belongs to
  // another cell.
  constexpr double kRefused = 0.2, kTolerated = 1e-4, kMaxOverlapLeft_sigma = 0.05;
  require_sound(start.beads, scene, kRefused, progress);
  const double left = relax_overlaps(start.beads, scene, kTolerated, 20000, progress);
  if (left > kMaxOverlapLeft_sigma)
    throw ConfigError(scene.where("start.from"),
                      fmt::format("{}: the beads cannot be pushed apart, an overlap of {:.3g} sigma remains, "
                                  "the bound is {:g}; is the width correct?",
                                  scene.from.string(), left, kMaxOverlapLeft_sigma));
  return start;
}

namespace {

/// A quantity of a bead and the columns that contain it: in reduced units (`plain`, `reduced`) or in
/// laboratory units. Where the scene has a laboratory scale, the unit must be in the name.
struct Quantity {
  std::string_view plain, reduced, physical;
  Unit unit;  ///< of `physical`
  double Bead::*member;
  bool space_only = false;  ///< for 3D only
  bool positive = false;
  double per_member = 1;  ///< 2 for a diameter, which is two radii
};
constexpr Quantity kQuantities[] = {
    {"x", "x_sigma", "x_mm", Unit::length_mm, &Bead::x},
    {"y", "y_sigma", "y_mm", Unit::length_mm, &Bead::y, true},
    {"z", "z_sigma", "z_mm", Unit::length_mm, &Bead::z},
    {"vx", "vx_v0", "vx_mm_s", Unit::velocity_mm_s, &Bead::vx},
    {"vy", "vy_v0", "vy_mm_s", Unit::velocity_mm_s, &Bead::vy, true},
    {"vz", "vz_v0", "vz_mm_s", Unit::velocity_mm_s, &Bead::vz},
    {"spin", "spin_per_t0", "spin_rad_s", Unit::rate_per_s, &Bead::spin},
    {"spin_x", "spin_x_per_t0", "spin_x_rad_s", Unit::rate_per_s, &Bead::spin_x, true},
    {"spin_z", "spin_z_per_t0", "spin_z_rad_s", Unit::rate_per_s, &Bead::spin_z, true},
    {"radius", "radius_sigma", "radius_mm", Unit::length_mm, &Bead::radius, false, true},
    {"diameter", "diameter_sigma", "diameter_mm", Unit::length_mm, &Bead::radius, false, true, 2},
    {"mass", "", "", Unit::one, &Bead::mass, false, true}};

/// A column of the table.
struct Column {
  const Quantity* quantity;
  std::string name;  ///< as written
  bool physical;     ///< in laboratory units
};

/// A field of a CSV line and the column where it begins, counted from 1.
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
      const auto known = std::find_if(std::begin(kQuantities), std::end(kQuantities), [&](const Quantity& q) {
        return f.text == q.plain || (!f.text.empty() && (f.text == q.reduced || f.text == q.physical));
      });
      if (known == std::end(kQuantities))
        throw InputError(where,
                         "there is no such column; a bead has x, y, z, vx, vy, vz, spin, spin_x, spin_z, "
                         "radius or diameter, mass; with units x_mm, vx_mm_s, spin_rad_s, radius_mm.");
      if (known->space_only && scene.dimension == 2)
        throw InputError(where, "beads of a 2D cell have no such column.");
      if (has(known->member)) throw InputError(where, "the column occurs twice.");
      if (f.text == known->plain && !known->physical.empty() && scene.scale.sigma_m)
        throw InputError(where, fmt::format("has no unit although the scene has a laboratory scale; write {} "
                                            "for reduced units or {} for laboratory units.",
                                            known->reduced, known->physical));
      const bool physical = f.text == known->physical;
      if (physical) (void)reduced_quantity(1, known->unit, scene.scale, where);  // the scale has all it needs
      columns_.push_back({known, std::string(f.text), physical});
    }
    for (const auto& [name, member] : {std::pair{"x", &Bead::x}, std::pair{"z", &Bead::z}})
      if (!has(member)) throw InputError({scene.from.string(), line, 0, name}, "the column is missing.");
  }

  [[nodiscard]] Bead row(const std::vector<Field>& fields, long line) const {
    if (fields.size() != columns_.size())
      throw InputError({scene_.from.string(), line, 0, ""},
                       fmt::format("{} columns are needed, {} were found.", columns_.size(), fields.size()));
    Bead b = bead_at(scene_, scene_.radius, Vec3(0, scene_.dimension == 3 ? scene_.depth / 2 : 0, 0));
    for (std::size_t k = 0; k < fields.size(); ++k)
      b.*columns_[k].quantity->member = number(fields[k], columns_[k], line);
    if (!has(&Bead::mass)) b.mass = scene_.mass_of(b.radius);
    b.inertia = scene_.inertia_factor * b.mass * b.radius * b.radius;
    return b;
  }

  /// Whether a column contains this number of a bead.
  [[nodiscard]] bool has(double Bead::*member) const {
    return std::any_of(columns_.begin(), columns_.end(),
                       [&](const Column& c) { return c.quantity->member == member; });
  }

 private:
  /// The number of a field in reduced units.
  [[nodiscard]] double number(const Field& f, const Column& column, long line) const {
    const Where where{scene_.from.string(), line, f.column, column.name};
    double value = 0;
    const auto [end, error] = std::from_chars(f.text.data(), f.text.data() + f.text.size(), value);
    if (error != std::errc() || end != f.text.data() + f.text.size() || !std::isfinite(value))
      throw InputError(where, fmt::format("a finite number is needed, not '{}'.", f.text));
    if (column.quantity->positive && !(value > 0))
      throw InputError(where, fmt::format("{} is out of range; the value must be greater than 0.", value));
    const Unit unit = column.physical ? column.quantity->unit : Unit::one;
    return reduced_quantity(value, unit, scene_.scale, where) / column.quantity->per_member;
  }

  const Scene& scene_;
  std::vector<Column> columns_;
};

}  // namespace

Start from_table(const Scene& scene, Progress& progress) {
  CancellationCheck check(progress);
  const std::string text = read_table_text(scene.from);
  std::optional<BeadTable> table;
  Start start;
  long line_number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    ++line_number;
    check();
    if (line.empty()) continue;
    if (!table)
      table.emplace(scene, split(line), line_number);
    else
      start.beads.push_back(table->row(split(line), line_number));
  }
  if (!table)
    throw InputError({scene.from.string(), 0, 0, ""},
                     "the table is empty; its first line names the columns.");
  if (start.beads.empty())
    throw InputError(
        {scene.from.string(), 0, 0, ""},
        "the table has no bead: a row for each one must follow the line that names the columns.");
  require_count(scene, start.beads.size(), scene.from.string());
  refuse_void_sizes(scene, start.beads, table->has(&Bead::radius), table->has(&Bead::mass),
                    scene.from.string());
  return start;
}

}  // namespace twincell::sim
