#include "trajectory/foreign/export_trajectory.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"
#include "trajectory/time_unit.hpp"

namespace twincell {

namespace {

/// Converts a vector from the axes of Box to those of ForeignFrame.
Vec3 turned(const Vec3& v, int dimension) {
  return dimension == 2 ? Vec3(v.x(), v.z(), -v.y() + 0.0) : v;
}

ForeignColumns columns_of(const TrajectoryInfo& info) {
  ForeignColumns has;
  has.type = !info.tracer.empty();
  has.radius = !info.radius.empty();
  has.mass = !info.mass.empty();
  has.uncertainty = info.columns.position_sigma;
  has.phase = info.columns.phase;
  has.contacts = info.columns.contact_forces;
  has.velocity.fill(info.columns.velocity);
  has.spin.fill(info.columns.spin);
  return has;
}

void set_box(ForeignFrame& s, const TrajectoryInfo& info, const ExportUnits& units) {
  const Box& box = info.box;
  Vec3 lower = box.lower, upper = box.upper;
  if (info.drive && !box.periodic(info.drive->axis)) {
    const int axis = static_cast<int>(info.drive->axis);
    lower[axis] -= info.drive->displacement_bound();
  }
  if (info.drive && info.drive->horizontal && !box.periodic(Axis::x))
    lower.x() -= info.drive->horizontal->amplitude, upper.x() += info.drive->horizontal->amplitude;
  const auto is_periodic = [&](Axis axis) { return box.periodic(axis); };
  if (box.dimension == 2) {
    // The plane of the beads lies in the middle of the gap.
    const double half_gap = 0.5 * (upper.y() - lower.y());
    s.lower = Vec3(lower.x(), lower.z(), -half_gap);
    s.upper = Vec3(upper.x(), upper.z(), half_gap);
    s.periodic = {is_periodic(Axis::x), is_periodic(Axis::z), false};
  } else {
    s.lower = lower;
    s.upper = upper;
    s.periodic = {is_periodic(Axis::x), is_periodic(Axis::y), is_periodic(Axis::z)};
  }
  s.lower *= units.length;
  s.upper *= units.length;
}

/// \param is_left_out of a slot
template <class IsLeftOut>
void add_contacts(ForeignFrame& s, const Frame& frame, const TrajectoryInfo& info, const ExportUnits& units,
                  const IsLeftOut& is_left_out) {
  const int dimension = info.box.dimension;
  const auto radius = [&](std::int32_t bead) {
    return radius_of(info.radius, static_cast<std::size_t>(bead));
  };
  for (const ContactForce& c : frame.contact_forces) {
    const Vec3& centre = frame.position[static_cast<std::size_t>(c.i)];
    if (!centre.allFinite() || is_left_out(static_cast<std::size_t>(c.i))) continue;
    if (c.j >= 0 && is_left_out(static_cast<std::size_t>(c.j))) continue;
    const double length = radius(c.i) + (c.j >= 0 ? radius(c.j) : 0) - c.overlap;
    s.contacts.push_back({.i = c.i,
                          .j = c.j,
                          .from = turned(centre, dimension) * units.length,
                          .to = turned(centre - length * c.normal, dimension) * units.length,
                          .overlap = c.overlap * units.length,
                          .normal_force = c.normal_force,
                          .tangential_force = turned(c.tangential_force, dimension)});
  }
}

bool is_present(const Frame& frame, std::size_t slot) {
  return frame.present(slot) && frame.position[slot].allFinite();
}

}  // namespace

ExportUnits ExportUnits::reduced(const TrajectoryInfo& info) {
  ExportUnits units;
  if (time_is_frame_number(info)) units.time_unit = "frame";
  return units;
}

ExportUnits ExportUnits::laboratory(const TrajectoryInfo& info, const std::string& option) {
  const auto t0 = info.scale.t0_s();
  if (!t0)
    throw ConfigError({"", 0, 0, option},
                      "the trajectory does not state the bead diameter in mm and g; sigma and t0 can be "
                      "written.");
  const bool numbered = time_is_frame_number(info);
  return {.length = *info.scale.sigma_m * 1e3,
          .time = numbered ? 1 : *t0,
          .length_unit = "mm",
          .time_unit = numbered ? "frame" : "s"};
}

ForeignFrame foreign_frame_of(const Frame& frame, const TrajectoryInfo& info, const ExportUnits& units,
                              const std::vector<std::vector<double>>& numbers,
                              const std::vector<bool>& left_out) {
  const int dimension = info.box.dimension;
  const auto is_left_out = [&](std::size_t slot) { return !left_out.empty() && left_out[slot]; };
  ForeignFrame s;
  s.step = frame.step;
  s.time = frame.time * units.time;
  if (info.columns.phase && frame.phase >= 0) s.phase = frame.phase;
  if (info.columns.phase && frame.cycle >= 0) s.cycle = frame.cycle;
  if (std::isfinite(frame.plate_height)) s.plate_height = frame.plate_height * units.length;
  set_box(s, info, units);
  add_contacts(s, frame, info, units, is_left_out);
  s.numbers.resize(numbers.size());
  for (std::size_t i = 0; i < info.n_beads; ++i) {
    if (!is_present(frame, i) || is_left_out(i)) continue;
    ForeignBead bead;
    bead.id = static_cast<std::int64_t>(i);
    bead.type = !info.tracer.empty() && info.tracer[i] != 0 ? 2 : 1;
    bead.radius = info.radius.empty() ? 0 : info.radius[i] * units.length;
    bead.mass = info.mass.empty() ? 0 : info.mass[i];
    bead.position = turned(frame.position[i], dimension) * units.length;
    if (info.columns.velocity)
      bead.velocity = turned(frame.velocity[i], dimension) * (units.length / units.time);
    if (info.columns.spin) bead.spin = turned(frame.spin[i], dimension) / units.time;
    if (info.columns.position_sigma) {
      const Vec3& u = frame.position_sigma[i];
      bead.uncertainty = (dimension == 2 ? Vec3(u.x(), u.z(), 0) : u) * units.length;
    }
    for (int k = 0; k < dimension; ++k)
      if (!s.periodic[static_cast<std::size_t>(k)]) {
        s.lower[k] = std::min(s.lower[k], bead.position[k]);
        s.upper[k] = std::max(s.upper[k], bead.position[k]);
      }
    s.beads.push_back(bead);
    for (std::size_t k = 0; k < numbers.size(); ++k) s.numbers[k].push_back(numbers[k][i]);
  }
  return s;
}

std::vector<bool> incomplete_slots(const TrajectorySource& source, Progress& progress) {
  std::vector<bool> incomplete(source.info().n_beads);
  Frame frame;
  for (std::size_t t = 0; t < source.n_frames(); ++t) {
    source.read(t, frame);
    for (std::size_t i = 0; i < incomplete.size(); ++i)
      if (!is_present(frame, i)) incomplete[i] = true;
    progress.update(static_cast<std::int64_t>(t + 1), static_cast<std::int64_t>(source.n_frames()));
  }
  return incomplete;
}

std::size_t export_trajectory(const TrajectorySource& source, const ForeignFormat& format,
                              const ExportUnits& units, const std::filesystem::path& part,
                              const std::string& stem, Progress& progress, const BeadNumbers& numbers,
                              const std::vector<bool>& left_out) {
  const TrajectoryInfo& info = source.info();
  const bool more = format.numbers && numbers.of;
  ForeignColumns columns = columns_of(info);
  if (more) columns.numbers = numbers.names;
  const auto writer = format.create(part, {.dimension = info.box.dimension,
                                           .columns = columns,
                                           .length_unit = units.length_unit,
                                           .time_unit = units.time_unit,
                                           .stem = stem});
  Frame frame;
  for (std::size_t t = 0; t < source.n_frames(); ++t) {
    source.read(t, frame);
    writer->append(foreign_frame_of(frame, info, units,
                                    more ? numbers.of(frame) : std::vector<std::vector<double>>{}, left_out));
    progress.update(static_cast<std::int64_t>(t + 1), static_cast<std::int64_t>(source.n_frames()));
  }
  writer->finish();
  return source.n_frames();
}

}  // namespace twincell
