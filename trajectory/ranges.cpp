#include "trajectory/ranges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "core/error.hpp"

namespace twincell {

void require_ranges(const TrajectoryInfo& info, const std::string& name) {
  const auto refuse = [&](const std::string& key, const std::string& complaint) {
    throw InputError({name, 0, 0, key}, complaint);
  };
  constexpr double kLargestRadius = 1e5;  // sigma
  constexpr int kMaxPhases = 1'000'000;
  if (info.box.dimension != 2 && info.box.dimension != 3)
    refuse("twincell/cell@dimension", fmt::format("is {}; it must be 2 or 3.", info.box.dimension));
  for (int a = 0; a < 3; ++a) {
    const double low = info.box.lower[a], high = info.box.upper[a];
    if (!(std::abs(low) <= kFarthestPosition) || !(std::abs(high) <= kFarthestPosition) || low > high)
      refuse(
          "cell",
          fmt::format("its {} side goes from {:g} to {:g}; the bounds must ascend and be within {:g} of 0.",
                      "xyz"[a], low, high, kFarthestPosition));
  }
  const auto each = [&](const std::vector<double>& values, const char* key, double most) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!(values[i] > 0 && values[i] <= most))
        refuse(key, fmt::format("{:g} of bead {} is out of range; it must be above 0 and at most {:g}.",
                                values[i], i, most));
  };
  each(info.radius, "radius", kLargestRadius);
  each(info.mass, "mass", 1e300);
  const double width = info.box.size().x();
  if (info.box.boundary[0] != Boundary::open && width > 0) each(info.radius, "radius", width);
  for (std::size_t i = 0; i < info.tracer.size(); ++i)
    if (info.tracer[i] > 1)
      refuse("tracer", fmt::format("is {} for bead {}; it must be 0 or 1.", info.tracer[i], i));
  if (info.phases_per_cycle < 0 || info.phases_per_cycle > kMaxPhases)
    refuse("parameters/phases_per_cycle",
           fmt::format("is {}; it must be between 0 and {}.", info.phases_per_cycle, kMaxPhases));
  if (info.drive) {
    if (!(info.drive->amplitude >= 0 && info.drive->amplitude <= kFarthestPosition))
      refuse("parameters/drive/amplitude", fmt::format("is {:g}; it must be between 0 and {:g}.",
                                                       info.drive->amplitude, kFarthestPosition));
    if (!(info.drive->omega >= 0 && info.drive->omega <= 1e9))
      refuse("parameters/drive/omega",
             fmt::format("is {:g}; it must be between 0 and 1e9.", info.drive->omega));
    if (info.drive->harmonics.size() > kMaxHarmonics)
      refuse("parameters/drive/harmonics",
             fmt::format("has {} harmonics, the bound is {}.", info.drive->harmonics.size(), kMaxHarmonics));
    for (const Harmonic& h : info.drive->harmonics)
      if (!(h.amplitude >= 0 && h.amplitude <= kLargestHarmonic && h.phase >= 0 && h.phase < 1))
        refuse("parameters/drive/harmonics",
               fmt::format("contains [{:g}, {:g}]; a relative amplitude must be between 0 and {:g}, a phase "
                           "at least 0 and less than 1.",
                           h.amplitude, h.phase, kLargestHarmonic));
  }
  for (const auto& [word, value] : {std::pair{"sigma_m", info.scale.sigma_m},
                                    {"gravity_m_s2", info.scale.gravity_m_s2},
                                    {"pixels_per_sigma", info.scale.pixels_per_sigma}})
    if (value && !(*value > 0 && std::isfinite(*value)))
      refuse(std::string("parameters/scale/") + word, fmt::format("is {:g}; it must be above 0.", *value));
}

void require_filled_slots(const Frame& frame, std::size_t index, const std::string& name) {
  for (std::size_t i = 0; i < frame.position.size(); ++i)
    if (frame.present(i) != frame.position[i].allFinite())
      throw InputError({name, 0, 0, fmt::format("frame {}", index)},
                       frame.present(i)
                           ? fmt::format("slot {} is a bead without a finite position.", i)
                           : fmt::format("slot {} is empty but has a position; it must be NaN.", i));
}

void require_speeds(const Frame& frame, std::size_t index, const std::string& name) {
  constexpr double kFastest = 1e8;
  for (const auto& [word, column] : {std::pair{"velocity", &frame.velocity}, {"spin", &frame.spin}})
    for (std::size_t i = 0; i < column->size(); ++i)
      for (const double v : (*column)[i])
        if (std::abs(v) > kFastest)  // NaN: unknown
          throw InputError(
              {name, 0, 0, fmt::format("frame {}", index)},
              fmt::format("a component of the {} of bead {} is {:g}; it must be within {:g} of 0.", word, i,
                          v, kFastest));
}

void require_order(std::span<const std::int32_t> phases, std::span<const std::int64_t> cycles,
                   const std::string& name) {
  std::optional<std::size_t> before;
  for (std::size_t f = 0; f < std::min(phases.size(), cycles.size()); ++f) {
    if (phases[f] < 0) continue;
    if (before && std::pair(cycles[f], phases[f]) <= std::pair(cycles[*before], phases[*before]))
      throw InputError(
          {name, 0, 0, fmt::format("frame {}", f)},
          fmt::format("has phase {} of cycle {}, which does not come after phase {} of cycle {} of frame {}.",
                      phases[f], cycles[f], phases[*before], cycles[*before], *before));
    before = f;
  }
}

void require_places(const Frame& frame, std::size_t index, const std::string& name) {
  constexpr std::size_t kMinBeads = 3;  // of two beads at one place, the reader of a start says more
  const Vec3* first = nullptr;
  std::size_t n = 0;
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    if (!frame.present(i) || !frame.position[i].allFinite()) continue;
    if (first == nullptr) first = &frame.position[i];
    if (frame.position[i] != *first) return;
    ++n;
  }
  if (n >= kMinBeads)
    throw InputError({name, 0, 0, fmt::format("frame {}", index)}, "all beads are at one place.");
}

void require_ranges(const Frame& frame, std::size_t index, const TrajectoryInfo& info,
                    const std::string& name) {
  constexpr std::int64_t kMaxCycles = 1'000'000'000'000;
  const auto refuse = [&](const std::string& complaint) {
    throw InputError({name, 0, 0, fmt::format("frame {}", index)}, complaint);
  };
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    for (const double x : frame.position[i])
      if (std::abs(x) > kFarthestPosition)  // NaN: the bead is missing
        refuse(
            fmt::format("bead {} is at {:g}; positions must be within {:g} of 0.", i, x, kFarthestPosition));
  }
  std::vector<std::int64_t> ids;
  std::copy_if(frame.id.begin(), frame.id.end(), std::back_inserter(ids), [](auto id) { return id >= 0; });
  std::sort(ids.begin(), ids.end());
  if (const auto twice = std::adjacent_find(ids.begin(), ids.end()); twice != ids.end())
    refuse(fmt::format("the id {} occurs twice.", *twice));
  for (std::size_t i = 0; i < frame.position_sigma.size(); ++i)
    for (const double s : frame.position_sigma[i])
      if (s < 0) refuse(fmt::format("the uncertainty of bead {} is {:g}; it must not be negative.", i, s));
  for (const Vec3& t : {frame.time_mean.temperature, frame.time_mean.temperature_coarse})
    for (const double component : t)
      if (component < 0 || std::isinf(component))
        refuse(fmt::format("a temperature is {:g}; it must be finite and not negative.", component));
  if (const BedForces& mean = frame.force_mean; mean.known()) {
    if (mean.in_contact < 0 || mean.in_contact > 1 + 1e-9)
      refuse(fmt::format("beads touch for a fraction {:g} of the time; it must be from 0 to 1.",
                         mean.in_contact));
    const bool walls =
        std::ranges::all_of(mean.wall_normal_force, [](double f) { return std::isfinite(f); }) &&
        std::ranges::all_of(mean.wall_force, [](const Vec3& f) { return f.allFinite(); });
    if (!walls || !mean.stress.allFinite() || !mean.kinetic.allFinite() ||
        !std::isfinite(mean.normal_force) || !std::isfinite(mean.tangential_force))
      refuse("its time means of forces and stress must be finite.");
    if (mean.kinetic.diagonal().minCoeff() < 0 || mean.tangential_force < 0)
      refuse("its mean kinetic stress and tangential force must not be negative.");
  } else if (std::isinf(mean.in_contact)) {
    refuse("the fraction of the time in which beads touch is infinite; it must be from 0 to 1.");
  }
  if (!info.columns.phase) return;
  if (frame.phase < -1 || frame.phase >= std::max(info.phases_per_cycle, 1))
    refuse(fmt::format("its phase is {}; it must be below {} phases per cycle.", frame.phase,
                       info.phases_per_cycle));
  if (frame.cycle < -kMaxCycles || frame.cycle > kMaxCycles)
    refuse(fmt::format("its cycle is {}; it must be within {}.", frame.cycle, kMaxCycles));
}

}  // namespace twincell
