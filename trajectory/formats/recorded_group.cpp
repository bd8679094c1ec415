#include "trajectory/formats/recorded_group.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "core/hdf5.hpp"

namespace twincell {

void write_recorded(hid_t drive, const RecordedMotion& motion) {
  const h5::Handle group = h5::create_group(drive, "recorded");
  const RecordInfo& info = motion.info();
  h5::write_attribute(group.get(), "file", info.file);
  h5::write_attribute(group.get(), "sha256", info.sha256);
  h5::write_scalar(group.get(), "interval", info.interval);
  h5::write_scalar(group.get(), "start", info.start);
  h5::write_scalar(group.get(), "cycles", info.cycles);
  std::vector<double> values;
  for (const MotionSample& s : motion.samples()) values.insert(values.end(), {s.z, s.v, s.a});
  h5::write_dataset(group.get(), "samples", values.data(), {motion.samples().size(), 3});
}

std::shared_ptr<const RecordedMotion> read_recorded(hid_t drive, const Where& where) {
  const h5::Handle group = h5::own(H5Oopen(drive, "recorded", H5P_DEFAULT), "opening recorded");
  RecordInfo info;
  double cycles = 0;
  if (!h5::read_scalar(group.get(), "interval", info.interval) ||
      !h5::read_scalar(group.get(), "start", info.start) || !h5::read_scalar(group.get(), "cycles", cycles))
    throw InputError(where, "needs interval, start and cycles.");
  constexpr double kMaxTime = 1e9, kMaxCycles = kMaxSamples;  // t0; cycles
  if (!(info.interval > 0 && info.interval <= kMaxTime))
    throw InputError(where, fmt::format("its interval is {:g}; it must be above 0 and at most {:g}.",
                                        info.interval, kMaxTime));
  if (!(std::abs(info.start) <= kMaxTime))
    throw InputError(where,
                     fmt::format("its start is {:g}; it must be within {:g} of 0.", info.start, kMaxTime));
  if (!(cycles >= 0 && cycles <= kMaxCycles && cycles == std::floor(cycles)))
    throw InputError(
        where, fmt::format("its cycles are {:g}; a whole number up to {:g} is needed.", cycles, kMaxCycles));
  info.cycles = static_cast<int>(cycles);
  const auto text = [&](const char* name) {
    const auto found = h5::read_text_attribute(group.get(), name);
    return found.empty() ? std::string() : found.front();
  };
  info.file = text("file");
  info.sha256 = text("sha256");
  const auto values = h5::read_dataset<double>(group.get(), "samples");
  if (values.size() < 6 || values.size() % 3 != 0 || values.size() / 3 > kMaxSamples)
    throw InputError(
        where, fmt::format("its samples must be 2 to {} rows of displacement, velocity and acceleration.",
                           kMaxSamples));
  std::vector<MotionSample> samples;
  for (std::size_t k = 0; k < values.size(); k += 3) {
    samples.push_back({values[k], values[k + 1], values[k + 2]});
    if (!(std::abs(values[k]) <= kLargestStroke) || !std::isfinite(values[k + 1]) ||
        !std::isfinite(values[k + 2]))
      throw InputError(where,
                       fmt::format("sample {} is ({:g}, {:g}, {:g}); displacements must be within {:g} of 0, "
                                   "velocities and accelerations finite.",
                                   k / 3, values[k], values[k + 1], values[k + 2], kLargestStroke));
  }
  return std::make_shared<RecordedMotion>(std::move(samples), std::move(info));
}

}  // namespace twincell
