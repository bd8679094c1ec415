#include "sim/scene/drive_tables.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/constants.hpp"
#include "core/error.hpp"

namespace twincell::sim {

namespace {

/// A key that states the strength, and the exponent of A omega^power that is linear in time with it.
struct Strength {
  const char* key;
  std::optional<double> DriveSpec::*value;
  int power;
};
const std::vector<Strength>& strengths() {
  static const std::vector<Strength> all = {{"amplitude", &DriveSpec::amplitude, 0},
                                            {"gamma", &DriveSpec::gamma, 2},
                                            {"k_m", &DriveSpec::k_m, 1},
                                            {"peak_velocity", &DriveSpec::peak_velocity, 1}};
  return all;
}

std::vector<Strength> stated(const DriveSpec& spec) {
  std::vector<Strength> all;
  for (const Strength& s : strengths())
    if (spec.*s.value) all.push_back(s);
  return all;
}

/// What is linear in time: the strength that the ramp states, else the one that the drive states.
Strength linear_strength(const RampSpec& spec, const DriveSpec& said, const ConfigSection& table) {
  const std::vector<Strength> ramped = stated(spec.to), own = stated(said);
  if (ramped.size() > 1)
    throw ConfigError(table.where(ramped[1].key),
                      fmt::format("and {} both state the strength at the end; give one, and the frequency if "
                                  "it changes.",
                                  ramped[0].key));
  if (ramped.size() == 1) return ramped[0];
  if (own.size() == 1) return own[0];
  throw ConfigError(
      table.where("frequency"),
      fmt::format(
          "changes, but [drive] states {} of amplitude, gamma, k_m and peak_velocity: state here which "
          "of them has which value at the end.",
          own.empty() ? "none" : "more than one"));
}

}  // namespace

std::optional<RampSpec> read_ramp(const ConfigSection& drive) {
  if (!drive.has("ramp")) return std::nullopt;
  const ConfigSection table = drive.section("ramp");
  return RampSpec{.to = read_drive_spec(table), .returns = table.boolean("return").value_or(false)};
}

DriveRamp make_ramp(const RampSpec& spec, const Drive& begin, const DriveSpec& said, double gravity,
                    std::int64_t first, std::int64_t cycles, const ConfigSection& drive) {
  const ConfigSection table = drive.section("ramp");
  if (begin.recorded)
    throw ConfigError(drive.where("file"), "contradicts drive.ramp: a recorded motion is not changed.");
  if (begin.horizontal)
    throw ConfigError(drive.where("horizontal"), "contradicts drive.ramp, which changes a vertical motion.");
  if (spec.to.omega && spec.to.frequency)
    throw ConfigError(table.where("frequency"), "and omega both state the frequency at the end; give one.");
  if (stated(spec.to).empty() && !spec.to.omega && !spec.to.frequency)
    throw ConfigError(
        table.where(""),
        "names nothing that changes; give the amplitude, gamma, k_m, peak_velocity, frequency or "
        "omega at the end.");
  DriveRamp ramp{.from = {begin.amplitude, begin.omega}, .to = {}, .power = 0};
  ramp.first = static_cast<double>(first), ramp.cycles = static_cast<double>(cycles);
  ramp.returns = spec.returns;
  const Strength linear = linear_strength(spec, said, table);
  ramp.power = linear.power;
  ramp.to.omega = spec.to.omega       ? *spec.to.omega
                  : spec.to.frequency ? kTurn * *spec.to.frequency
                                      : begin.omega;
  if (spec.to.*linear.value) {
    DriveSpec end;
    end.*linear.value = spec.to.*linear.value;
    end.omega = ramp.to.omega;
    ramp.to.amplitude = solve_drive(end, gravity, table.where("")).amplitude;
  } else {
    ramp.to.amplitude = begin.amplitude * std::pow(begin.omega / ramp.to.omega, ramp.power);
  }
  if (ramp.from == ramp.to) throw ConfigError(table.where(""), "ends with the drive with which it begins.");
  if (const double change = ramp.to.omega / ramp.from.omega;
      !(change <= kLargestChange && change >= 1 / kLargestChange))
    throw ConfigError(table.where(spec.to.omega ? "omega" : "frequency"),
                      fmt::format("changes the frequency by a factor of {:.4g}; it must be between {:g} and "
                                  "{:g}.",
                                  change, 1 / kLargestChange, kLargestChange));
  if (ramp.returns && cycles % 2 != 0)
    throw ConfigError(
        table.where("return"),
        fmt::format("needs an even number of cycles, half of them each way; time.cycles is {}.", cycles));
  return ramp;
}

std::int64_t cycles_before(const Envelope& envelope, std::int64_t discard) {
  return static_cast<std::int64_t>(std::ceil(envelope.duration())) + discard;
}

std::optional<HorizontalMotion> read_horizontal(const ConfigSection& drive) {
  if (!drive.has("horizontal")) return std::nullopt;
  const ConfigSection table = drive.section("horizontal");
  const auto amplitude = table.number_in("amplitude", 0, 1e6, true);
  HorizontalMotion motion;
  motion.ratio = static_cast<int>(table.integer_in("ratio", 1, kLargestRatio).value_or(1));
  motion.phase = table.number_in("phase", 0, 1).value_or(0);
  if (!amplitude) throw ConfigError(table.where("amplitude"), "is missing.");
  motion.amplitude = *amplitude;
  if (motion.phase == 1)
    throw ConfigError(table.where("phase"), "1 is out of range; the value must be less than 1.");
  return motion;
}

}  // namespace twincell::sim
