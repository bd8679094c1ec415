// Writes trajectories as H5MD.

#include <fmt/format.h>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/hdf5.hpp"
#include "trajectory/boundary_words.hpp"
#include "trajectory/formats/contact_lists.hpp"
#include "trajectory/formats/drive_motion_group.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "trajectory/formats/h5md_names.hpp"
#include "trajectory/formats/recorded_group.hpp"
#include "twincell_version.hpp"

namespace twincell {

namespace fs = std::filesystem;

namespace {

constexpr hsize_t kFramesPerFlush = 64;
constexpr std::int64_t kEmptySlot = -1;

/// The lowest schema version whose readers understand the file (kSchemaVersion).
int schema_needed(const TrajectoryInfo& info) {
  return info.drive && (info.drive->ramp || info.drive->horizontal) ? 2 : 1;
}

/// Creates a time-dependent H5MD element that shares step and time with position by hard links.
h5::Handle create_element(hid_t parent, const std::string& name, hid_t position) {
  h5::Handle group = h5::create_group(parent, name);
  for (const char* shared : {"step", "time"})
    h5::check(H5Lcreate_hard(position, shared, group.get(), shared, H5P_DEFAULT, H5P_DEFAULT),
              "linking " + name);
  return group;
}

}  // namespace

struct H5mdWriter::Impl {
  AtomicPath path;
  TrajectoryInfo info;
  h5::Handle file;
  h5::Series step, time, position, position_sigma, edges, velocity, spin, id, plate_height, phase, cycle,
      temperature, temperature_coarse;
  h5::Series wall_normal_force, wall_force, contact_stress, kinetic_stress, bead_contacts;
  h5::Series force, moment, rim_speed;
  ContactListWriter contacts, contact_forces;
  ConnectivityWriter connectivity;
  std::int64_t last_step = 0;

  Impl(const fs::path& final_path, TrajectoryInfo i)
      : path(final_path, Product::trajectory(word_of(i.source))), info(std::move(i)) {}

  void create();
  void create_particles();
  void create_parameters();
  void append_contacts(const std::vector<ContactMemory>& memories);
  void append_contact_forces(const std::vector<ContactForce>& forces);
  void append_force_mean(const BedForces& mean);
  void close();
};

void H5mdWriter::Impl::create() {
  h5::quiet();
  const h5::Handle access = h5::own(H5Pcreate(H5P_FILE_ACCESS), "making a property list");
  // Readable by HDF5 1.8 and later.
  h5::check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V110), "choosing the file format");
  file = h5::own(H5Fcreate(path.part().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()),
                 path.final().string() + ": creating the file");
  const h5::Handle h5md = h5::create_group(file.get(), "h5md");
  h5::write_attribute(h5md.get(), "version", std::vector<int>{1, 1});
  const h5::Handle author = h5::create_group(h5md.get(), "author");
  h5::write_attribute(author.get(), "name", std::string("not recorded"));
  const h5::Handle creator = h5::create_group(h5md.get(), "creator");
  h5::write_attribute(creator.get(), "name", std::string("twincell"));
  h5::write_attribute(creator.get(), "version", std::string(TWINCELL_VERSION));
  create_particles();
  create_parameters();
}

void H5mdWriter::Impl::create_particles() {
  const hsize_t n = info.n_beads;
  const h5::Handle particles = h5::create_group(file.get(), "particles");
  const h5::Handle group = h5::create_group(particles.get(), "trajectory");
  const h5::Handle box = h5::create_group(group.get(), "box");
  h5::write_attribute(box.get(), "dimension", 3);
  std::vector<std::string> boundary;
  for (Boundary b : info.box.boundary) boundary.emplace_back(b == Boundary::periodic ? "periodic" : "none");
  h5::write_attribute(box.get(), "boundary", boundary);

  const h5::Handle pos = h5::create_group(group.get(), "position");
  step = h5::Series(pos.get(), "step", H5T_STD_I64LE, {});
  time = h5::Series(pos.get(), "time", H5T_IEEE_F64LE, {});
  // The motion of beads in space deflates to 94 to 97 %, at half the processor time of a dilute gas's run. In
  // the plane a third of the numbers are zero, and deflation saves 25 to 50 %.
  const auto motion = info.box.dimension == 3 ? h5::Storage::plain : h5::Storage::deflated;
  position = h5::Series(pos.get(), "value", H5T_IEEE_F64LE, {n, 3}, nullptr, motion);

  auto element = [&](hid_t parent, const char* name, hid_t type, std::vector<hsize_t> record,
                     const void* fill = nullptr, h5::Storage storage = h5::Storage::deflated) {
    const h5::Handle g = create_element(parent, name, pos.get());
    return h5::Series(g.get(), "value", type, std::move(record), fill, storage);
  };
  edges = element(box.get(), "edges", H5T_IEEE_F64LE, {3, 3});
  if (info.columns.position_sigma)
    position_sigma = element(group.get(), "position_sigma", H5T_IEEE_F64LE, {n, 3});
  if (info.columns.velocity)
    velocity = element(group.get(), "velocity", H5T_IEEE_F64LE, {n, 3}, nullptr, motion);
  if (info.columns.spin)
    spin = element(group.get(), "angular_velocity", H5T_IEEE_F64LE, {n, 3}, nullptr, motion);
  if (info.columns.contacts) {
    force = element(group.get(), "force", H5T_IEEE_F64LE, {n, 3});
    moment = element(group.get(), "moment", H5T_IEEE_F64LE, {n, 3});
    rim_speed = element(group.get(), "rim_speed", H5T_IEEE_F64LE, {n, 3});
  }
  if (info.columns.identity) id = element(group.get(), "id", H5T_STD_I64LE, {n}, &kEmptySlot);
  if (!info.radius.empty())
    h5::write_dataset(group.get(), "radius", info.radius.data(), {info.radius.size()});
  if (!info.mass.empty()) h5::write_dataset(group.get(), "mass", info.mass.data(), {info.mass.size()});
  if (!info.tracer.empty())
    h5::write_dataset(group.get(), "tracer", info.tracer.data(), {info.tracer.size()});

  if (!info.columns.plate_height && !info.columns.phase && !info.columns.time_mean &&
      !info.columns.force_mean)
    return;
  const h5::Handle observables = h5::create_group(file.get(), "observables");
  if (info.columns.plate_height)
    plate_height = element(observables.get(), "plate_height", H5T_IEEE_F64LE, {});
  if (info.columns.phase) {
    phase = element(observables.get(), "drive_phase", H5T_STD_I32LE, {});
    cycle = element(observables.get(), "cycle", H5T_STD_I64LE, {});
  }
  if (info.columns.time_mean) {
    temperature = element(observables.get(), h5md::kTemperature, H5T_IEEE_F64LE, {3});
    temperature_coarse = element(observables.get(), h5md::kTemperatureCoarse, H5T_IEEE_F64LE, {3});
  }
  if (!info.columns.force_mean) return;
  if (const hsize_t walls = info.walls.size(); walls > 0) {  // HDF5 has no chunks of size 0
    wall_normal_force = element(observables.get(), h5md::kWallNormalForce, H5T_IEEE_F64LE, {walls});
    wall_force = element(observables.get(), h5md::kWallForce, H5T_IEEE_F64LE, {walls, 3});
  }
  contact_stress = element(observables.get(), h5md::kContactStress, H5T_IEEE_F64LE, {3, 3});
  kinetic_stress = element(observables.get(), h5md::kKineticStress, H5T_IEEE_F64LE, {3, 3});
  bead_contacts = element(observables.get(), h5md::kBeadContacts, H5T_IEEE_F64LE, {3});
}

void H5mdWriter::Impl::create_parameters() {
  const h5::Handle parameters = h5::create_group(file.get(), "parameters");
  h5::write_text(
      parameters.get(), "units",
      "reduced: length sigma (bead diameter), mass m (bead mass), acceleration g; time t0 = sqrt(sigma/g)");
  if (info.drive) {
    const h5::Handle drive = h5::create_group(parameters.get(), "drive");
    h5::write_attribute(drive.get(), "axis", std::string(1, "xyz"[static_cast<int>(info.drive->axis)]));
    h5::write_attribute(drive.get(), "phase_convention",
                        info.drive->recorded
                            ? info.drive->formula() + ", cycle begins where the component A sin(omega t) does"
                        : info.drive->harmonics.empty() && !info.drive->ramp && !info.drive->horizontal
                            ? std::string("A sin(omega t), cycle begins at mean height moving up")
                            : info.drive->formula() + ", cycle begins at omega t = 0");
    h5::write_scalar(drive.get(), "amplitude", info.drive->amplitude);
    h5::write_scalar(drive.get(), "omega", info.drive->omega);
    h5::write_scalar(drive.get(), "gravity", info.drive->gravity);
    if (info.drive->downward_share != 1)
      h5::write_scalar(drive.get(), "downward_share", info.drive->downward_share);
    std::vector<double> harmonics;
    for (const Harmonic& h : info.drive->harmonics) harmonics.insert(harmonics.end(), {h.amplitude, h.phase});
    if (!harmonics.empty())
      h5::write_dataset(drive.get(), "harmonics", harmonics.data(), {harmonics.size() / 2, 2});
    if (info.drive->recorded) write_recorded(drive.get(), *info.drive->recorded);
    write_drive_motion(drive.get(), *info.drive);
  }
  if (info.phases_per_cycle > 0)
    h5::write_dataset(parameters.get(), "phases_per_cycle", &info.phases_per_cycle, {});
  if (info.samples_per_cycle > 0)
    h5::write_dataset(parameters.get(), "samples_per_cycle", &info.samples_per_cycle, {});
  const h5::Handle scale = h5::create_group(parameters.get(), "scale");
  const std::pair<const char*, std::optional<double>> scales[] = {
      {"sigma_m", info.scale.sigma_m},
      {"gravity_m_s2", info.scale.gravity_m_s2},
      {"pixels_per_sigma", info.scale.pixels_per_sigma}};
  for (const auto& [name, value] : scales)
    if (value) h5::write_scalar(scale.get(), name, *value);
  if (!info.provenance_json.empty()) h5::write_text(parameters.get(), "provenance", info.provenance_json);

  const h5::Handle ours = h5::create_group(file.get(), "twincell");
  h5::write_attribute(ours.get(), "schema_version", schema_needed(info));
  h5::write_attribute(ours.get(), "source", word_of(info.source));
  if (!info.tracking_json.empty()) h5::write_text(ours.get(), "tracking", info.tracking_json);
  const RunConditions& at = info.conditions;
  if (at.n_l || at.gamma || !at.start.empty()) {
    const h5::Handle conditions = h5::create_group(ours.get(), "conditions");
    if (at.n_l) h5::write_scalar(conditions.get(), "n_l", *at.n_l);
    if (at.gamma) h5::write_scalar(conditions.get(), "gamma", *at.gamma);
    if (!at.start.empty()) h5::write_text(conditions.get(), "start", at.start);
  }
  if (info.columns.contacts)
    contacts = ContactListWriter(h5::create_group(ours.get(), "contacts"), H5T_IEEE_F64LE);
  if (info.columns.contact_forces) {
    h5::Handle group = h5::create_group(ours.get(), "contact_forces");
    h5::write_attribute(group.get(), "columns", h5md::kForceColumns);
    if (!info.walls.empty()) h5::write_attribute(group.get(), "walls", info.walls);
    contact_forces = ContactListWriter(std::move(group), H5T_IEEE_F32LE, h5md::kForceColumns.size());
    connectivity = ConnectivityWriter(file.get(), "particles/trajectory");
  }
  const h5::Handle cell = h5::create_group(ours.get(), "cell");
  h5::write_attribute(cell.get(), "dimension", info.box.dimension);
  std::vector<std::string> words;
  for (Boundary b : info.box.boundary) words.push_back(boundary_word(b));
  h5::write_attribute(cell.get(), "boundary", words);
  h5::write_dataset(cell.get(), "lower", info.box.lower.data(), {3});
  h5::write_dataset(cell.get(), "upper", info.box.upper.data(), {3});
  const auto& tilt = info.box.side_tilt;
  if (tilt[0] != 0 || tilt[1] != 0) h5::write_dataset(cell.get(), "side_tilt", tilt.data(), {2});
}

void H5mdWriter::Impl::append_contacts(const std::vector<ContactMemory>& memories) {
  std::vector<std::int32_t> pairs;
  std::vector<double> values;
  for (const ContactMemory& c : memories) {
    pairs.insert(pairs.end(), {c.i, c.j});
    values.insert(values.end(), c.values.begin(), c.values.end());
  }
  contacts.append(pairs, values);
}

void H5mdWriter::Impl::append_contact_forces(const std::vector<ContactForce>& forces) {
  std::vector<std::int32_t> pairs;
  std::vector<double> values;
  for (const ContactForce& c : forces) {
    pairs.insert(pairs.end(), {c.i, c.j});
    values.push_back(c.overlap);
    values.insert(values.end(), c.normal.data(), c.normal.data() + 3);
    values.push_back(c.normal_force);
    values.insert(values.end(), c.tangential_force.data(), c.tangential_force.data() + 3);
  }
  contact_forces.append(pairs, values);
  connectivity.append(pairs);
}

void H5mdWriter::Impl::append_force_mean(const BedForces& mean) {
  if (wall_force) {
    const std::size_t walls = info.walls.size();
    std::vector<double> normal = mean.wall_normal_force;
    std::vector<Vec3> vectors = mean.wall_force;
    normal.resize(walls, BedForces::kUnknown);
    vectors.resize(walls, Vec3::Constant(BedForces::kUnknown));
    wall_normal_force.append(h5::native<double>(), normal.data());
    wall_force.append(h5::native<double>(), vectors.data());
  }
  contact_stress.append(h5::native<double>(), mean.stress.data());
  kinetic_stress.append(h5::native<double>(), mean.kinetic.data());
  const double contacts_of_beads[] = {mean.in_contact, mean.normal_force, mean.tangential_force};
  bead_contacts.append(h5::native<double>(), contacts_of_beads);
}

void H5mdWriter::Impl::close() {
  for (h5::Series* s : {&step,
                        &time,
                        &position,
                        &position_sigma,
                        &edges,
                        &velocity,
                        &spin,
                        &id,
                        &plate_height,
                        &phase,
                        &cycle,
                        &temperature,
                        &temperature_coarse,
                        &wall_normal_force,
                        &wall_force,
                        &contact_stress,
                        &kinetic_stress,
                        &bead_contacts,
                        &force,
                        &moment,
                        &rim_speed})
    *s = h5::Series();
  contacts = ContactListWriter();
  contact_forces = ContactListWriter();
  connectivity = ConnectivityWriter();
  h5::check(H5Fflush(file.get(), H5F_SCOPE_GLOBAL), path.final().string() + ": writing to disk");
  file.reset();
}

H5mdWriter::H5mdWriter(const fs::path& path, TrajectoryInfo info)
    : impl_(std::make_unique<Impl>(path, std::move(info))) {
  impl_->create();
}

H5mdWriter::~H5mdWriter() = default;

void H5mdWriter::append(const Frame& frame) {
  Impl& w = *impl_;
  const std::size_t n = w.info.n_beads;
  auto need = [&](bool wanted, std::size_t length, const char* column) {
    if (length != (wanted ? n : 0))
      throw RunError(fmt::format("{}: frame {} has {} entries of {}, {} were announced.",
                                 w.path.final().string(), w.step.size(), length, column, wanted ? n : 0));
  };
  need(true, frame.position.size(), "position");
  need(w.info.columns.position_sigma, frame.position_sigma.size(), "position_sigma");
  need(w.info.columns.velocity, frame.velocity.size(), "velocity");
  need(w.info.columns.spin, frame.spin.size(), "spin");
  need(w.info.columns.identity, frame.id.size(), "id");
  need(w.info.columns.contacts, frame.force.size(), "force");
  need(w.info.columns.contacts, frame.moment.size(), "moment");
  need(w.info.columns.contacts, frame.rim_speed.size(), "rim_speed");
  if (!w.info.columns.contact_forces && !frame.contact_forces.empty())
    throw RunError(fmt::format("{}: frame {} has contact forces, none were announced.",
                               w.path.final().string(), w.step.size()));
  if (w.step.size() > 0 && frame.step <= w.last_step)
    throw RunError(fmt::format("{}: frame {} has step {}, not above the previous one's {}.",
                               w.path.final().string(), w.step.size(), frame.step, w.last_step));
  w.last_step = frame.step;

  const Vec3 size = w.info.box.size();
  const double edges[9] = {size.x(), 0, 0, 0, size.y(), 0, 0, 0, size.z()};
  w.step.append(h5::native<std::int64_t>(), &frame.step);
  w.time.append(h5::native<double>(), &frame.time);
  w.edges.append(h5::native<double>(), edges);
  w.position.append(h5::native<double>(), frame.position.data());
  if (w.position_sigma) w.position_sigma.append(h5::native<double>(), frame.position_sigma.data());
  if (w.velocity) w.velocity.append(h5::native<double>(), frame.velocity.data());
  if (w.spin) w.spin.append(h5::native<double>(), frame.spin.data());
  if (w.id) w.id.append(h5::native<std::int64_t>(), frame.id.data());
  if (w.plate_height) w.plate_height.append(h5::native<double>(), &frame.plate_height);
  if (w.phase) {
    w.phase.append(h5::native<int>(), &frame.phase);
    w.cycle.append(h5::native<std::int64_t>(), &frame.cycle);
  }
  if (w.temperature) {
    w.temperature.append(h5::native<double>(), frame.time_mean.temperature.data());
    w.temperature_coarse.append(h5::native<double>(), frame.time_mean.temperature_coarse.data());
  }
  if (w.contact_stress) w.append_force_mean(frame.force_mean);
  if (w.contact_forces) w.append_contact_forces(frame.contact_forces);
  if (w.contacts) {
    w.append_contacts(frame.contacts);
    w.force.append(h5::native<double>(), frame.force.data());
    w.moment.append(h5::native<double>(), frame.moment.data());
    w.rim_speed.append(h5::native<double>(), frame.rim_speed.data());
  }
  if (w.step.size() % kFramesPerFlush == 0)
    h5::check(H5Fflush(w.file.get(), H5F_SCOPE_GLOBAL), w.path.final().string() + ": writing to disk");
}

void H5mdWriter::finish() {
  impl_->close();
  impl_->path.commit();
}

fs::path H5mdWriter::finish_as_failed(const fs::path& name, const std::string& why) {
  {
    const h5::Handle ours =
        h5::own(H5Gopen2(impl_->file.get(), "twincell", H5P_DEFAULT), impl_->path.final().string());
    h5::write_attribute(ours.get(), "failed", why);
  }
  impl_->close();
  return impl_->path.commit_as(name, Product::failed_run());
}

}  // namespace twincell
