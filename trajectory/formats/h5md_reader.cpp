// Reads trajectories from H5MD.

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/config.hpp"
#include "core/error.hpp"
#include "core/hdf5.hpp"
#include "core/hdf5_self_contained.hpp"
#include "trajectory/boundary_words.hpp"
#include "trajectory/formats/contact_lists.hpp"
#include "trajectory/formats/drive_motion_group.hpp"
#include "trajectory/formats/foreign_rows.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "trajectory/formats/h5md_names.hpp"
#include "trajectory/formats/recorded_group.hpp"
#include "trajectory/ranges.hpp"

namespace twincell {

namespace fs = std::filesystem;

struct H5mdReader::Impl {
  fs::path path;
  TrajectoryInfo info;
  h5::Handle file;
  h5::Series step, time, position, position_sigma, velocity, spin, id, plate_height, phase, cycle,
      temperature, temperature_coarse;
  h5::Series wall_normal_force, wall_force, contact_stress, kinetic_stress, bead_contacts;

  [[noreturn]] void refuse(const std::string& key, const std::string& complaint) const {
    throw InputError({path.string(), 0, 0, key}, complaint);
  }
  /// Reads the number `group`/`name`, if it exists. \throws InputError if it is no number
  bool read_number(const std::string& group, const std::string& name, double& value) const;
  h5::Series force, moment, rim_speed;
  ContactListReader contacts, contact_forces;
  std::optional<ForeignRows> foreign;  ///< of another program

  std::string particle_group() const;
  void open();
  void open_columns(const std::string& group);
  void open_contacts();
  void read_force_mean(std::size_t frame, BedForces& mean) const;
  std::vector<ContactMemory> contacts_of(std::size_t frame) const;
  std::vector<ContactForce> contact_forces_of(std::size_t frame) const;
  void read_box(const std::string& group);
  void read_foreign_box(const std::string& group);
  bool is_planar() const;
  void read_parameters();
  void read_conditions();
  void check_gamma();
  void check_layers();
  void require_box(const std::string& group) const;
  void require_plate(const std::vector<std::int32_t>& phases, const std::vector<std::int64_t>& cycles) const;
  void require_rising_time(const std::string& particles) const;
};

namespace {

/// start.kind of a simulation's file by a version that did not store /twincell/conditions: from the scene in
/// its provenance, where an absent key means the default, crystal_a. Empty if unknown.
std::string start_of_earlier_file(const std::string& provenance_json) {
  const auto provenance = nlohmann::json::parse(provenance_json, nullptr, false);
  if (!provenance.is_object() || !provenance.contains("config") || !provenance.at("config").is_string())
    return {};
  try {
    const Config scene = Config::from_text(provenance.at("config").get<std::string>(), "scene");
    return scene.root().section("start").text("kind").value_or("crystal_a");
  } catch (const ConfigError&) {  // a damaged record states no start
    return {};
  }
}

h5::Handle open_object(hid_t parent, const std::string& path) {
  return h5::own(H5Oopen(parent, path.c_str(), H5P_DEFAULT), "opening " + path);
}

Boundary boundary_of(const std::string& word) {
  for (const BoundaryWords& row : kBoundaries)
    if (word == row.word) return row.value;
  return Boundary::open;  // also the word "none" of H5MD
}

}  // namespace

std::string H5mdReader::Impl::particle_group() const {
  if (!h5::exists(file.get(), "particles"))
    refuse("particles", "the group is missing, so the file holds no beads.");
  const h5::Handle particles = h5::own(H5Gopen2(file.get(), "particles", H5P_DEFAULT), "opening particles");
  if (h5::exists(particles.get(), "trajectory")) return "particles/trajectory";
  char name[256];
  if (H5Lget_name_by_idx(particles.get(), ".", H5_INDEX_NAME, H5_ITER_INC, 0, name, sizeof name,
                         H5P_DEFAULT) <= 0)
    refuse("particles", "the group is empty, so the file holds no beads.");
  return std::string("particles/") + name;
}

bool H5mdReader::Impl::read_number(const std::string& group, const std::string& name, double& value) const {
  const std::string key = group + "/" + name;
  if (!h5::exists(file.get(), key)) return false;
  if (!h5::read_scalar(file.get(), key, value)) refuse(key, "must be a single number.");
  return true;
}

void H5mdReader::Impl::open() {
  std::error_code ec;
  if (!fs::exists(path, ec)) refuse("", "the file does not exist.");
  if (fs::is_directory(path, ec)) refuse("", "this is a folder; a trajectory file is needed.");
  if (!fs::is_regular_file(path, ec))
    refuse("", "this is a device, a pipe or a socket; a regular file is needed.");
  if (::access(path.c_str(), R_OK) != 0)
    refuse("", fmt::format("the file cannot be read ({}).", std::strerror(errno)));
  file = h5::open_file(path);
  if (!file)
    refuse("", H5Fis_hdf5(path.c_str()) > 0 ? "the HDF5 file is truncated or damaged."
                                            : "this is not an HDF5 file, or it is truncated.");
  if (const std::string elsewhere = h5::data_elsewhere(file.get()); !elsewhere.empty()) refuse("", elsewhere);
  if (!h5::exists(file.get(), "h5md")) refuse("h5md", "the group is missing, so this is HDF5 but not H5MD.");
  const h5::Handle h5md = open_object(file.get(), "h5md");
  const auto version = h5::read_int_attribute(h5md.get(), "version");
  if (version.size() != 2 || version[0] != 1)
    refuse("h5md@version", "the attribute must be two integers beginning with 1.");
  const std::string group = particle_group();
  open_columns(group);
  read_box(group);
  if (!h5::exists(file.get(), "twincell"))
    foreign.emplace(open_object(file.get(), group).get(), id, position, info.box, info.n_beads,
                    path.string());
  read_parameters();
  require_ranges(info, path.string());
  if (foreign) return;
  require_box(group);
  require_rising_time(group);
  if (!info.columns.phase) return;
  const auto phases = h5::read_dataset<std::int32_t>(file.get(), "observables/drive_phase/value");
  const auto cycles = h5::read_dataset<std::int64_t>(file.get(), "observables/cycle/value");
  require_order(phases, cycles, path.string());
  require_plate(phases, cycles);
}

void H5mdReader::Impl::open_columns(const std::string& group) {
  const h5::Handle g = open_object(file.get(), group);
  step = h5::Series(g.get(), "position/step");
  time = h5::Series(g.get(), "position/time");
  position = h5::Series(g.get(), "position/value");
  if (!position || position.record().size() != 2)
    refuse(group + "/position/value", "a dataset frames x beads x dimension is needed.");
  if (position.record()[1] != 3)
    refuse(group + "/position/value",
           fmt::format("positions have {} components, 3 are needed.", position.record()[1]));
  if (!step || step.size() != position.size())
    refuse(group + "/position/step",
           fmt::format("{} steps for {} frames; explicit steps, one per frame, are needed.", step.size(),
                       position.size()));
  // Per-bead columns: absent ones stay empty, others must match position.
  info.n_beads = position.record()[0];
  const hsize_t frames = position.size();
  auto column = [&](const char* name, const std::vector<hsize_t>& record) {
    h5::Series s(g.get(), std::string(name) + "/value");
    if (s && (s.size() != frames || s.record() != record))
      refuse(group + "/" + name, "its shape does not match that of position.");
    return s;
  };
  position_sigma = column("position_sigma", {info.n_beads, 3});
  velocity = column("velocity", {info.n_beads, 3});
  spin = column("angular_velocity", {info.n_beads, 3});
  id = column("id", {info.n_beads});
  force = column("force", {info.n_beads, 3});
  moment = column("moment", {info.n_beads, 3});
  rim_speed = column("rim_speed", {info.n_beads, 3});
  // Observables: one value or three values per frame.
  auto observable = [&](const char* name, const std::vector<hsize_t>& record = {}) {
    const std::string where = std::string("observables/") + name + "/value";
    if (!h5::exists(file.get(), where)) return h5::Series();
    h5::Series s(file.get(), where);
    if (s && (s.size() != frames || s.record() != record))
      refuse(where, record.empty() ? "one value per frame is needed."
                    : record == std::vector<hsize_t>{3}
                        ? "three values per frame are needed."
                        : fmt::format("an array [{}] per frame is needed.", fmt::join(record, "][")));
    return s;
  };
  plate_height = observable("plate_height");
  phase = observable("drive_phase");
  cycle = observable("cycle");
  temperature = observable(h5md::kTemperature, {3});
  temperature_coarse = observable(h5md::kTemperatureCoarse, {3});
  info.columns = {static_cast<bool>(velocity),
                  static_cast<bool>(spin),
                  static_cast<bool>(id),
                  phase && cycle,
                  static_cast<bool>(plate_height),
                  static_cast<bool>(position_sigma),
                  temperature && temperature_coarse};

  open_contacts();
  if (const hsize_t walls = info.walls.size(); walls > 0) {
    wall_normal_force = observable(h5md::kWallNormalForce, {walls});
    wall_force = observable(h5md::kWallForce, {walls, 3});
  }
  contact_stress = observable(h5md::kContactStress, {3, 3});
  kinetic_stress = observable(h5md::kKineticStress, {3, 3});
  bead_contacts = observable(h5md::kBeadContacts, {3});
  info.columns.force_mean = contact_stress && kinetic_stress && bead_contacts &&
                            (info.walls.empty() || (wall_normal_force && wall_force));

  // Constants: one entry per bead.
  auto per_bead = [&]<class T>(const char* name, std::vector<T>& out) {
    out = h5::read_dataset<T>(g.get(), name);
    if (out.empty() && info.n_beads > 0 && h5::exists(g.get(), name))
      refuse(group + "/" + name, "must be one number for each bead.");
    if (!out.empty() && out.size() != info.n_beads)
      refuse(group + "/" + name, fmt::format("{} entries for {} beads.", out.size(), info.n_beads));
  };
  per_bead("radius", info.radius);
  per_bead("mass", info.mass);
  per_bead("tracer", info.tracer);
}

void H5mdReader::Impl::open_contacts() {
  const std::size_t frames = position.size();
  contacts = ContactListReader(file.get(), "twincell/contacts", path.string(), frames, info.n_beads);
  if (contacts && (!force || !moment || !rim_speed))
    refuse("twincell/contacts",
           "contacts require the particles' force, moment and rim_speed, which are missing.");
  info.columns.contacts = static_cast<bool>(contacts);
  const std::string where = "twincell/contact_forces";
  contact_forces = ContactListReader(file.get(), where, path.string(), frames, info.n_beads);
  if (!contact_forces) return;
  if (contact_forces.values_each() != 0 && contact_forces.values_each() != h5md::kForceColumns.size())
    refuse(where + "/values", fmt::format("a contact has {} values, {} are needed.",
                                          contact_forces.values_each(), h5md::kForceColumns.size()));
  info.columns.contact_forces = true;
  info.walls = h5::read_text_attribute(open_object(file.get(), where).get(), "walls");
}

std::vector<ContactMemory> H5mdReader::Impl::contacts_of(std::size_t frame) const {
  if (!contacts) return {};
  std::vector<std::int32_t> pairs;
  std::vector<double> values;
  contacts.read(frame, pairs, values);
  std::vector<ContactMemory> memories;
  const std::size_t each = contacts.values_each();
  for (std::size_t k = 0; 2 * k < pairs.size(); ++k)
    memories.push_back(
        {pairs[2 * k], pairs[2 * k + 1], {values.data() + k * each, values.data() + (k + 1) * each}});
  return memories;
}

std::vector<ContactForce> H5mdReader::Impl::contact_forces_of(std::size_t frame) const {
  if (!contact_forces) return {};
  std::vector<std::int32_t> pairs;
  std::vector<double> values;
  contact_forces.read(frame, pairs, values);
  std::vector<ContactForce> forces;
  for (std::size_t k = 0; 2 * k < pairs.size(); ++k) {
    const double* v = values.data() + k * h5md::kForceColumns.size();
    forces.push_back({pairs[2 * k], pairs[2 * k + 1], v[0], Vec3(v + 1), v[4], Vec3(v + 5)});
  }
  return forces;
}

void H5mdReader::Impl::read_force_mean(std::size_t frame, BedForces& mean) const {
  mean = {};
  if (!info.columns.force_mean) return;
  double contacts_of_beads[3];
  bead_contacts.read(frame, h5::native<double>(), contacts_of_beads);
  mean.in_contact = contacts_of_beads[0];
  mean.normal_force = contacts_of_beads[1];
  mean.tangential_force = contacts_of_beads[2];
  contact_stress.read(frame, h5::native<double>(), mean.stress.data());
  kinetic_stress.read(frame, h5::native<double>(), mean.kinetic.data());
  if (!wall_force || !mean.known()) return;
  mean.wall_normal_force.resize(info.walls.size());
  mean.wall_force.resize(info.walls.size());
  wall_normal_force.read(frame, h5::native<double>(), mean.wall_normal_force.data());
  wall_force.read(frame, h5::native<double>(), mean.wall_force.data());
}

void H5mdReader::Impl::read_box(const std::string& group) {
  if (h5::exists(file.get(), "twincell/cell")) {
    const h5::Handle cell = open_object(file.get(), "twincell/cell");
    const auto dimension = h5::read_int_attribute(cell.get(), "dimension");
    const auto words = h5::read_text_attribute(cell.get(), "boundary");
    const auto lower = h5::read_dataset<double>(cell.get(), "lower"),
               upper = h5::read_dataset<double>(cell.get(), "upper");
    if (dimension.size() != 1 || words.size() != 3 || lower.size() != 3 || upper.size() != 3)
      refuse("twincell/cell", "dimension, boundary[3], lower[3] and upper[3] are needed.");
    info.box.dimension = dimension[0];
    info.box.lower = Vec3(lower.data());
    info.box.upper = Vec3(upper.data());
    for (std::size_t a = 0; a < 3; ++a) info.box.boundary[a] = boundary_of(words[a]);
    if (!h5::exists(cell.get(), "side_tilt")) return;
    const auto tilt = h5::read_dataset<double>(cell.get(), "side_tilt");
    if (tilt.size() != 2 || !std::ranges::all_of(tilt, [](double t) { return std::abs(t) < 90; }))
      refuse("twincell/cell", "side_tilt is two angles below 90 degrees.");
    info.box.side_tilt = {tilt[0], tilt[1]};
    return;
  }
  read_foreign_box(group);
}

/// The box of H5MD, from which other programs read the cell, must be that of twincell/cell.
void H5mdReader::Impl::require_box(const std::string& group) const {
  constexpr double kRounding = 1e-9;
  const std::string where = group + "/box";
  if (!h5::exists(file.get(), where)) refuse(where, "the group is missing.");
  if (!h5::exists(file.get(), where + "/edges/value")) return;
  const h5::Series series(file.get(), where + "/edges/value");
  if (series.record() != std::vector<hsize_t>{3, 3})
    refuse(where + "/edges", "an array [3][3] per frame is needed.");
  const auto edges = h5::read_dataset<double>(file.get(), where + "/edges/value");
  const Vec3 size = info.box.size();
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const auto row = static_cast<int>(k % 9 / 3), column = static_cast<int>(k % 3);
    const double cell = row == column ? size[row] : 0;
    if (!(std::abs(edges[k] - cell) <= kRounding * std::max(1.0, cell)))
      refuse(where + "/edges",
             fmt::format("edge [{}][{}] of frame {} is {:g}, but that of twincell/cell is {:g}.", row, column,
                         k / 9, edges[k], cell));
  }
}

/// The plate of a simulation is where its drive puts it in each phase, or at 0 while it rests.
void H5mdReader::Impl::require_plate(const std::vector<std::int32_t>& phases,
                                     const std::vector<std::int64_t>& cycles) const {
  constexpr double kRounding = 1e-6;
  if (info.source != "simulation" || !info.drive || info.drive->ramp || info.drive->recorded ||
      info.phases_per_cycle <= 0 || !plate_height)
    return;
  const auto heights = h5::read_dataset<double>(file.get(), "observables/plate_height/value");
  for (std::size_t f = 0; f < heights.size(); ++f) {
    if (phases[f] < 0 || std::isnan(heights[f]) || heights[f] == 0) continue;
    const double driven =
        info.drive->displacement(static_cast<double>(phases[f]) / info.phases_per_cycle, cycles[f]);
    if (!(std::abs(heights[f] - driven) <= kRounding * std::max(1.0, info.drive->amplitude)))
      refuse(fmt::format("frame {}", f),
             fmt::format("the plate is at {:g}, but the drive of the file puts it at {:g}.", heights[f],
                         driven));
  }
}

/// A file of another program has only the H5MD box. Its corner is at the origin.
void H5mdReader::Impl::read_foreign_box(const std::string& group) {
  info.box.dimension = is_planar() ? 2 : 3;
  info.box.boundary = {Boundary::open, Boundary::open, Boundary::open};
  if (!h5::exists(file.get(), group + "/box")) return;
  const h5::Handle box = open_object(file.get(), group + "/box");
  const auto words = h5::read_text_attribute(box.get(), "boundary");
  for (std::size_t a = 0; a < std::min<std::size_t>(words.size(), 3); ++a)
    info.box.boundary[a] = boundary_of(words[a]);
  const auto set = [&](const std::vector<double>& edges) {
    if (edges.size() == 3) info.box.upper = Vec3(edges.data());
    if (edges.size() == 9) info.box.upper = Vec3(edges[0], edges[4], edges[8]);
  };
  set(h5::read_dataset<double>(box.get(), "edges"));
  if (!h5::exists(box.get(), "edges/value")) return;
  const h5::Series edges(box.get(), "edges/value");
  std::size_t each = 1;
  for (const hsize_t n : edges.record()) each *= n;
  if (!edges || (each != 3 && each != 9))
    refuse(group + "/box/edges", "a box has 3 or 9 numbers in each frame.");
  std::vector<double> first(each), now(each);
  for (std::size_t f = 0; f < edges.size(); ++f) {
    edges.read(f, h5::native<double>(), f == 0 ? first.data() : now.data());
    if (f > 0 && now != first)
      refuse(group + "/box/edges", fmt::format("the box of frame {} is not that of the first one.", f));
  }
  if (edges.size() > 0) set(first);
}

/// Whether all beads of the first frame have the same y.
bool H5mdReader::Impl::is_planar() const {
  if (position.size() == 0 || info.n_beads == 0) return false;
  std::vector<Vec3> first(info.n_beads);
  position.read(0, h5::native<double>(), first.data());
  return std::all_of(first.begin(), first.end(),
                     [&](const Vec3& r) { return r.y() == first.front().y() || !std::isfinite(r.y()); });
}

void H5mdReader::Impl::read_parameters() {
  if (h5::exists(file.get(), "twincell")) {
    const h5::Handle ours = open_object(file.get(), "twincell");
    const auto schema = h5::read_int_attribute(ours.get(), "schema_version");
    if (schema.size() == 1 && schema[0] > kSchemaVersion)
      refuse("twincell@schema_version",
             fmt::format("{} is newer than this program's {}.", schema[0], kSchemaVersion));
    const auto source = h5::read_text_attribute(ours.get(), "source");
    if (!source.empty()) info.source = source.front();
    h5::read_text(ours.get(), "tracking", info.tracking_json);
  }
  if (h5::exists(file.get(), "parameters/drive")) {
    const h5::Handle group = open_object(file.get(), "parameters/drive");
    if (H5Iget_type(group.get()) != H5I_GROUP)
      refuse("parameters/drive", "must be a group with the numbers amplitude and omega.");
    Drive drive;
    if (H5Aexists(group.get(), "axis") > 0) {
      const auto axis = h5::read_text_attribute(group.get(), "axis");  // empty if it is no text
      const auto k = axis.size() == 1 && axis.front().size() == 1 ? std::string("xyz").find(axis.front())
                                                                  : std::string::npos;
      if (k == std::string::npos) refuse("parameters/drive@axis", "must be x, y or z.");
      drive.axis = static_cast<Axis>(k);
    }
    if (read_number("parameters/drive", "amplitude", drive.amplitude) &&
        read_number("parameters/drive", "omega", drive.omega)) {
      if (h5::exists(group.get(), "harmonics")) {
        const auto pairs = h5::read_dataset<double>(group.get(), "harmonics");
        if (pairs.empty() || pairs.size() % 2 != 0)
          refuse("parameters/drive/harmonics", "must be pairs of a relative amplitude and a phase.");
        for (std::size_t k = 0; k < pairs.size(); k += 2) drive.harmonics.push_back({pairs[k], pairs[k + 1]});
      }
      if (h5::exists(group.get(), "recorded"))
        drive.recorded = read_recorded(group.get(), {path.string(), 0, 0, "parameters/drive/recorded"});
      if (read_number("parameters/drive", "gravity", drive.gravity) &&
          !(drive.gravity > 0 && std::isfinite(drive.gravity)))
        refuse("parameters/drive/gravity", "must be a positive number.");
      if (read_number("parameters/drive", "downward_share", drive.downward_share) &&
          !(std::abs(drive.downward_share) <= 1))
        refuse("parameters/drive/downward_share", "must be a number from -1 to 1.");
      read_drive_motion(group.get(), drive, {path.string(), 0, 0, "parameters/drive"});
      info.drive = drive;
    }
  }
  double value = 0;
  if (read_number("parameters", "phases_per_cycle", value))
    info.phases_per_cycle =
        value >= 0 && value <= 2e9 && value == std::floor(value) ? static_cast<int>(value) : -1;
  else if (info.columns.phase) {
    // If the file does not state N_k, derive it from the largest phase.
    for (std::size_t f = 0; f < position.size(); ++f) {
      int k = -1;
      phase.read(f, h5::native<int>(), &k);
      info.phases_per_cycle = std::max(info.phases_per_cycle, std::min(k, 2'000'000'000) + 1);
    }
  }
  if (read_number("parameters", "samples_per_cycle", value)) {
    constexpr double kMostSamples = 2e9;
    if (!(value >= 0 && value <= kMostSamples && value == std::floor(value)))
      refuse("parameters/samples_per_cycle",
             fmt::format("is {:g}; it must be a whole number between 0 and {:g}.", value, kMostSamples));
    info.samples_per_cycle = static_cast<int>(value);
  }
  auto scale = [&](const char* name, std::optional<double>& out) {
    if (read_number("parameters/scale", name, value)) out = value;
  };
  scale("sigma_m", info.scale.sigma_m);
  scale("gravity_m_s2", info.scale.gravity_m_s2);
  scale("pixels_per_sigma", info.scale.pixels_per_sigma);
  if (h5::exists(file.get(), "parameters/provenance"))
    h5::read_text(file.get(), "parameters/provenance", info.provenance_json);
  read_conditions();
}

void H5mdReader::Impl::read_conditions() {
  if (!h5::exists(file.get(), "twincell/conditions")) {
    if (info.source == "simulation") info.conditions.start = start_of_earlier_file(info.provenance_json);
    return;
  }
  const h5::Handle group = open_object(file.get(), "twincell/conditions");
  const auto number = [&](const char* name, std::optional<double>& out) {
    double value = 0;
    if (!read_number("twincell/conditions", name, value)) return;
    if (!std::isfinite(value) || value < 0)
      refuse(std::string("twincell/conditions/") + name,
             fmt::format("is {:g}; it must be finite and not negative.", value));
    out = value;
  };
  number("n_l", info.conditions.n_l);
  number("gamma", info.conditions.gamma);
  check_gamma();
  check_layers();
  h5::read_text(group.get(), "start", info.conditions.start);
}

void H5mdReader::Impl::check_gamma() {
  if (!info.drive || info.conditions.gamma.value_or(0) <= 0) return;
  constexpr double kRounding = 1e-9;
  const double of_drive = info.drive->gamma(), stated = *info.conditions.gamma;
  if (!(of_drive > 0) || std::abs(of_drive / stated - 1) <= kRounding) return;
  // Files of earlier versions lack drive/gravity if it is 1, and the first ones always.
  if (!h5::exists(file.get(), "parameters/drive/gravity")) {
    info.drive->gravity = of_drive / stated;
    return;
  }
  const bool sine = info.drive->harmonics.empty() && !info.drive->recorded && !info.drive->ramp;
  if (sine)
    refuse("twincell/conditions/gamma",
           fmt::format("is {:g}, but parameters/drive states Gamma = {:g}.", stated, of_drive));
}

void H5mdReader::Impl::check_layers() {
  constexpr double kRounding = 1e-9;
  const double width = info.box.size().x();
  if (info.source != "simulation" || !info.conditions.n_l || !(width > 0)) return;
  const double stated = *info.conditions.n_l, of_beads = static_cast<double>(info.n_beads) / width;
  if (std::abs(stated - of_beads) > kRounding * std::max(1.0, of_beads))
    refuse("twincell/conditions/n_l",
           fmt::format("is {:g}, but {} beads in a cell {:g} wide are {:g} layers.", stated, info.n_beads,
                       width, of_beads));
}

/// Refuses frames whose steps do not rise, or whose times fall.
void H5mdReader::Impl::require_rising_time(const std::string& particles) const {
  const std::string group = particles + "/position/";
  const auto steps = h5::read_dataset<std::int64_t>(file.get(), group + "step");
  for (std::size_t f = 1; f < steps.size(); ++f)
    if (steps[f] <= steps[f - 1])
      refuse(group + "step", fmt::format("{} of frame {} does not come after {} of the frame before.",
                                         steps[f], f, steps[f - 1]));
  const auto times = h5::read_dataset<double>(file.get(), group + "time");
  for (std::size_t f = 0; f < times.size(); ++f)
    if (!std::isfinite(times[f]) || (f > 0 && times[f] < times[f - 1]))
      refuse(group + "time",
             fmt::format("{:g} of frame {} is not finite, or before the time of the frame before.", times[f],
                         f));
}

H5mdReader::H5mdReader(const fs::path& path) : impl_(std::make_unique<Impl>()) {
  impl_->path = path;
  try {
    impl_->open();
  } catch (const RunError& e) {  // an HDF5 error here is a fault of the file, not of the run
    impl_->refuse("", e.what());
  }
}

H5mdReader::~H5mdReader() = default;

const TrajectoryInfo& H5mdReader::info() const {
  return impl_->info;
}
std::size_t H5mdReader::n_frames() const {
  return impl_->position.size();
}
std::string H5mdReader::name() const {
  return impl_->path.string();
}

void H5mdReader::read(std::size_t index, Frame& frame) const {
  const Impl& r = *impl_;
  const std::size_t n = r.info.n_beads;
  if (index >= n_frames())
    r.refuse("", fmt::format("frame {} was requested, but the number of frames in the file is {}.", index,
                             n_frames()));
  try {
    r.step.read(index, h5::native<std::int64_t>(), &frame.step);
    if (r.time)
      r.time.read(index, h5::native<double>(), &frame.time);
    else
      frame.time = static_cast<double>(frame.step);
    auto column = [&](const h5::Series& s, hid_t type, auto& out) {
      out.resize(s ? n : 0);
      if (s) s.read(index, type, out.data());
    };
    column(r.position, h5::native<double>(), frame.position);
    column(r.position_sigma, h5::native<double>(), frame.position_sigma);
    column(r.velocity, h5::native<double>(), frame.velocity);
    column(r.spin, h5::native<double>(), frame.spin);
    column(r.id, h5::native<std::int64_t>(), frame.id);
    const h5::Series none;  // a run cannot continue from forces without contact histories
    const bool restart = r.info.columns.contacts;
    column(restart ? r.force : none, h5::native<double>(), frame.force);
    column(restart ? r.moment : none, h5::native<double>(), frame.moment);
    column(restart ? r.rim_speed : none, h5::native<double>(), frame.rim_speed);
    frame.plate_height = Frame::kNoHeight;
    if (r.plate_height) r.plate_height.read(index, h5::native<double>(), &frame.plate_height);
    frame.contacts = r.contacts_of(index);
    frame.contact_forces = r.contact_forces_of(index);
    frame.time_mean = {};
    if (r.info.columns.time_mean) {
      r.temperature.read(index, h5::native<double>(), frame.time_mean.temperature.data());
      r.temperature_coarse.read(index, h5::native<double>(), frame.time_mean.temperature_coarse.data());
    }
    r.read_force_mean(index, frame.force_mean);
    frame.phase = -1;
    frame.cycle = -1;
    if (r.info.columns.phase) {
      r.phase.read(index, h5::native<int>(), &frame.phase);
      r.cycle.read(index, h5::native<std::int64_t>(), &frame.cycle);
    }
    if (r.foreign) r.foreign->restore(index, frame);
    require_ranges(frame, index, r.info, r.path.string());
    if (!r.foreign) {
      require_filled_slots(frame, index, r.path.string());
      require_speeds(frame, index, r.path.string());
    }
    require_places(frame, index, r.path.string());
  } catch (const RunError& e) {
    r.refuse(fmt::format("frame {}", index), e.what());
  }
}

}  // namespace twincell
