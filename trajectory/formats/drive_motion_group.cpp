#include "trajectory/formats/drive_motion_group.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "core/hdf5.hpp"

namespace twincell {

namespace {

constexpr double kMaxCycles = 1e9;

/// The numbers of a group, each with its bounds.
class Numbers {
 public:
  Numbers(hid_t drive, const char* name, const Where& where)
      : group_(h5::own(H5Oopen(drive, name, H5P_DEFAULT), std::string("opening ") + name)), where_(where) {
    where_.key += std::string("/") + name;
  }
  [[nodiscard]] double in(const char* name, double least, double most, bool whole = false) const {
    double value = 0;
    if (!h5::read_scalar(group_.get(), name, value)) throw InputError(where_, fmt::format("needs {}.", name));
    if (!(value >= least && value <= most) || (whole && value != std::floor(value)))
      throw InputError(where_, fmt::format("its {} is {:g}; it must be {}between {:g} and {:g}.", name, value,
                                           whole ? "a whole number " : "", least, most));
    return value;
  }

 private:
  h5::Handle group_;
  Where where_;
};

}  // namespace

void write_drive_motion(hid_t drive, const Drive& motion) {
  if (motion.ramp) {
    const h5::Handle group = h5::create_group(drive, "ramp");
    h5::write_scalar(group.get(), "amplitude", motion.ramp->to.amplitude);
    h5::write_scalar(group.get(), "omega", motion.ramp->to.omega);
    h5::write_scalar(group.get(), "power", motion.ramp->power);
    h5::write_scalar(group.get(), "first", motion.ramp->first);
    h5::write_scalar(group.get(), "cycles", motion.ramp->cycles);
    h5::write_scalar(group.get(), "returns", motion.ramp->returns ? 1 : 0);
  }
  if (motion.horizontal) {
    const h5::Handle group = h5::create_group(drive, "horizontal");
    h5::write_scalar(group.get(), "amplitude", motion.horizontal->amplitude);
    h5::write_scalar(group.get(), "ratio", motion.horizontal->ratio);
    h5::write_scalar(group.get(), "phase", motion.horizontal->phase);
  }
}

void read_drive_motion(hid_t drive, Drive& motion, const Where& where) {
  constexpr double kMaxAmplitude_sigma = 1e6, kMaxOmega = 1e9, kMinOmega = 1e-9;  // omega: 1/t0
  if (h5::exists(drive, "ramp")) {
    const Numbers group(drive, "ramp", where);
    // The ramp divides by the frequency before it.
    if (!(motion.omega >= kMinOmega))
      throw InputError(where, fmt::format("has a ramp, but its omega is {:g}.", motion.omega));
    DriveRamp ramp{.from = {motion.amplitude, motion.omega}, .to = {}};
    ramp.to.amplitude = group.in("amplitude", 0, kMaxAmplitude_sigma);
    ramp.to.omega = group.in("omega", kMinOmega, kMaxOmega);
    ramp.power = static_cast<int>(group.in("power", 0, 2, true));
    ramp.first = group.in("first", 0, kMaxCycles, true);
    ramp.cycles = group.in("cycles", 1, kMaxCycles, true);
    ramp.returns = group.in("returns", 0, 1, true) == 1;
    motion.ramp = ramp;
  }
  if (h5::exists(drive, "horizontal")) {
    const Numbers group(drive, "horizontal", where);
    HorizontalMotion horizontal;
    horizontal.amplitude = group.in("amplitude", 0, kMaxAmplitude_sigma);
    horizontal.ratio = static_cast<int>(group.in("ratio", 1, kLargestRatio, true));
    horizontal.phase = group.in("phase", 0, 1);
    motion.horizontal = horizontal;
  }
}

}  // namespace twincell
