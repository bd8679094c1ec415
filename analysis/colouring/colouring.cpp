#include "analysis/colouring/colouring.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "analysis/neighbours/bond_orientational_order.hpp"
#include "analysis/observable/observable.hpp"
#include "core/constants.hpp"
#include "core/error.hpp"

namespace twincell::analysis {

namespace {

/// `number(i)` of every bead that is present.
template <class Number>
std::vector<double> each(const ColouredFrame& at, Number number) {
  std::vector<double> values(at.frame.position.size(), kNaN);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (at.frame.present(i)) values[i] = number(i);
  return values;
}

std::string needs_velocity(const TrajectoryInfo& info) {
  return info.columns.velocity ? "" : "velocities";
}
std::string needs_spin(const TrajectoryInfo& info) {
  return info.columns.spin ? "" : "spins";
}
std::string needs_radius(const TrajectoryInfo& info) {
  return info.radius.empty() ? "radii" : "";
}
std::string needs_nothing(const TrajectoryInfo& /*info*/) {
  return "";
}
std::string needs_space_and_velocity(const TrajectoryInfo& info) {
  return info.box.dimension == 3 ? needs_velocity(info) : "three dimensions";
}
std::string needs_plane(const TrajectoryInfo& info) {
  return info.box.dimension == 2 ? "" : "a planar cell";
}
std::string needs_cycles(const TrajectoryInfo& info) {
  return info.columns.phase && info.phases_per_cycle > 0 ? "" : "cycles and phases";
}
std::string needs_contacts(const TrajectoryInfo& info) {
  return info.columns.contact_forces ? "" : "contacts (simulate --contacts)";
}

std::vector<double> speed(const ColouredFrame& at) {
  return each(at, [&](std::size_t i) { return at.frame.velocity[i].norm(); });
}
std::vector<double> vx(const ColouredFrame& at) {
  return each(at, [&](std::size_t i) { return at.frame.velocity[i].x(); });
}
std::vector<double> vz(const ColouredFrame& at) {
  return each(at, [&](std::size_t i) { return at.frame.velocity[i].z(); });
}
std::vector<double> vy(const ColouredFrame& at) {
  return each(at, [&](std::size_t i) { return at.frame.velocity[i].y(); });
}
std::vector<double> height(const ColouredFrame& at) {
  return each(at, [&](std::size_t i) { return at.frame.position[i].z(); });
}
// Of a disc, counter-clockwise in the drawing (Frame::spin); of a sphere, the modulus.
std::vector<double> spin(const ColouredFrame& at) {
  const bool planar = at.source.info().box.dimension == 2;
  return each(at, [&](std::size_t i) { return planar ? -at.frame.spin[i].y() : at.frame.spin[i].norm(); });
}
std::vector<double> radius(const ColouredFrame& at) {
  return each(at, [&](std::size_t i) { return at.source.info().radius[i]; });
}
BondOrder order_of(const ColouredFrame& at) {
  const TrajectoryInfo& info = at.source.info();
  return bond_order(find_neighbours(at.frame, info.box, neighbour_cutoff(info, {})));
}
std::vector<double> q6(const ColouredFrame& at) {
  return order_of(at).q6;
}
std::vector<double> psi6(const ColouredFrame& at) {
  return order_of(at).psi6;
}
std::vector<double> force(const ColouredFrame& at) {
  std::vector<double> sum = each(at, [](std::size_t) { return 0.0; });
  for (const ContactForce& c : at.frame.contact_forces) {
    sum[static_cast<std::size_t>(c.i)] += c.normal_force;
    if (c.j >= 0) sum[static_cast<std::size_t>(c.j)] += c.normal_force;
  }
  return sum;
}
std::vector<double> contacts(const ColouredFrame& at) {
  std::vector<double> number = each(at, [](std::size_t) { return 0.0; });
  for (const ContactForce& c : at.frame.contact_forces) {
    number[static_cast<std::size_t>(c.i)] += 1;
    if (c.j >= 0) number[static_cast<std::size_t>(c.j)] += 1;
  }
  return number;
}
std::vector<double> cycle_displacement(const ColouredFrame& at) {
  const auto cycle = static_cast<std::size_t>(at.source.info().phases_per_cycle);
  Frame before;
  if (at.index >= cycle) at.source.read(at.index - cycle, before);
  // A lost frame shifts the phases: the earlier frame then shows another part of the cycle.
  const bool usable =
      at.index >= cycle && before.phase == at.frame.phase && before.cycle + 1 == at.frame.cycle;
  return each(at, [&](std::size_t i) {
    return usable && before.present(i) ? (at.frame.position[i] - before.position[i]).norm() : kNaN;
  });
}

}  // namespace

const std::vector<Colouring>& colourings() {
  static const std::vector<Colouring> table = {
      {"speed", "sigma/t0", "modulus of the velocity", needs_velocity, speed},
      {"vx", "sigma/t0", "velocity to the right", needs_velocity, vx},
      {"vy", "sigma/t0", "velocity to the back", needs_space_and_velocity, vy},
      {"vz", "sigma/t0", "velocity upwards", needs_velocity, vz},
      {"height", "sigma", "height of the centre above the mean height of the plate", needs_nothing, height},
      {"spin", "1/t0", "angular velocity; of discs counter-clockwise, of spheres the modulus", needs_spin,
       spin},
      {"radius", "sigma", "radius", needs_radius, radius},
      {"q6", "", "bond order q6 (analyze)", needs_plane, q6},
      {"psi6", "", "modulus of the bond order psi6 (analyze)", needs_plane, psi6},
      {"force", "m g", "sum of the normal forces at the contacts", needs_contacts, force},
      {"contacts", "", "number of contacts, with walls", needs_contacts, contacts},
      {"cycle-displacement", "sigma", "distance from the position one cycle before", needs_cycles,
       cycle_displacement},
  };
  return table;
}

const Colouring& colouring_named(const std::string& word, const TrajectorySource& source,
                                 const std::string& option) {
  std::vector<std::string> words;
  for (const Colouring& colouring : colourings()) {
    words.emplace_back(colouring.word);
    if (word != colouring.word) continue;
    if (const std::string missing = colouring.missing(source.info()); !missing.empty())
      throw ConfigError(Where{.file = source.name(), .key = option},
                        fmt::format("{} needs {}, which this trajectory does not have.", word, missing));
    return colouring;
  }
  throw ConfigError(Where{.file = {}, .key = option},
                    fmt::format("is '{}', but must be one of: {}.", word, fmt::join(words, ", ")));
}

}  // namespace twincell::analysis
