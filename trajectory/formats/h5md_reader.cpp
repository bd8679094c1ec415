// Reads trajectories from H5MD: opens the file and its columns, and reads frames.

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "core/hdf5_open.hpp"
#include "core/hdf5_self_contained.hpp"
#include "trajectory/formats/h5md_names.hpp"
#include "trajectory/formats/h5md_reader_impl.hpp"
#include "trajectory/ranges.hpp"

namespace twincell {

namespace fs = std::filesystem;

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
