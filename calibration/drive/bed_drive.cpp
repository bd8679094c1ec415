#include "calibration/drive/bed_drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/constants.hpp"
#include "core/median.hpp"

namespace twincell::calibration {
namespace {

/// Fewest columns of beads that give a step of the bed.
constexpr std::size_t kMinBeads = 5;
/// Fewest cycles that give a scatter between cycles.
constexpr std::size_t kMinCycles = 3;
/// Fewest steps per cycle that determine two components and a misfit.
constexpr std::size_t kMinSteps = 4;
/// Time after a landing, in cycles, during which the impact still moves the beads.
constexpr double kImpactDuration = 0.1;
/// Largest rms departure of the bed's cycle-averaged steps from the plate's, relative to the steps.
constexpr double kMaxMisfit = 0.06;
/// Largest phase error of the bed relative to the plate, rad.
constexpr double kMaxPhaseError = 0.15;
/// Trial amplitudes: range in units of the stated one, and ratio of consecutive ones.
constexpr double kMinTrial = 0.2, kMaxTrial = 5, kTrialRatio = 1.01;

/// Fit to the steps that are wholly within [from, to].
struct Fit {
  double a = 0, b = 0, error = 0, misfit = 0;
  std::size_t steps = 0, cycles = 0;
};

Fit fit_steps(const std::vector<BedSteps::Step>& all, double from, double to) {
  struct Sums {
    double ss = 0, sc = 0, cc = 0, sz = 0, cz = 0;
    std::size_t n = 0;
  };
  struct Mean {
    double s = 0, c = 0, dz = 0;
    std::size_t n = 0;
  };
  std::map<std::int64_t, Sums> cycles;
  std::map<std::pair<int, std::int32_t>, Mean> phases;
  constexpr double kRounding = 1e-9;  // cycles
  for (const BedSteps::Step& step : all)
    for (const int turn : {0, -1}) {  // [from, to] may begin in the cycle before
      const double begin = step.begin + turn, end = step.end + turn;
      if (begin < from - kRounding || end > to + kRounding) continue;
      if (to - from >= 1 && turn != 0) continue;
      const double s = std::sin(kTurn * end) - std::sin(kTurn * begin),
                   c = std::cos(kTurn * end) - std::cos(kTurn * begin);
      Sums& sums = cycles[step.cycle - turn];
      sums.ss += s * s, sums.sc += s * c, sums.cc += c * c, sums.sz += s * step.dz, sums.cz += c * step.dz;
      ++sums.n;
      Mean& mean = phases[{turn, step.phase}];
      mean.s = s, mean.c = c, mean.dz += step.dz;
      ++mean.n;
    }
  Fit fit;
  fit.steps = phases.size();
  std::vector<double> a;
  for (const auto& [cycle, sums] : cycles) {
    const double det = sums.ss * sums.cc - sums.sc * sums.sc;
    if (sums.n < fit.steps || !(det > kRounding * sums.ss * sums.cc)) continue;
    a.push_back((sums.sz * sums.cc - sums.cz * sums.sc) / det);
    fit.b += (sums.cz * sums.ss - sums.sz * sums.sc) / det;
  }
  fit.cycles = a.size();
  if (a.size() < kMinCycles) return fit;
  const auto n = static_cast<double>(a.size());
  for (const double value : a) fit.a += value / n;
  fit.b /= n;
  double squares = 0;
  for (const double value : a) squares += (value - fit.a) * (value - fit.a);
  fit.error = std::sqrt(squares / (n * (n - 1)));
  double off = 0, size = 0;
  for (const auto& [phase, mean] : phases) {
    const double dz = mean.dz / static_cast<double>(mean.n), expected = fit.a * mean.s + fit.b * mean.c;
    off += (dz - expected) * (dz - expected);
    size += dz * dz;
  }
  fit.misfit = size > 0 ? std::sqrt(off / size) : 1;
  return fit;
}

/// Height, in amplitudes above the plate, of a body that flies since sin th = 1/Gamma. \pre Gamma > 1
double height_of_flight(double gamma, double th) {
  const double off = std::asin(1 / gamma), since = th - off;
  return std::sin(off) + std::cos(off) * since - since * since / (2 * gamma) - std::sin(th);
}

}  // namespace

std::optional<TimeOnPlate> time_on_plate(double gamma) {
  if (gamma <= 1) return TimeOnPlate{};
  const double off = std::asin(1 / gamma);
  constexpr double kStep = 1e-3;
  for (double th = off + 2 * kStep; th < off + kTurn; th += kStep)
    if (height_of_flight(gamma, th) < 0) return TimeOnPlate{th / kTurn - 1, off / kTurn};
  return std::nullopt;
}

std::optional<TimeOnPlate> time_at_rest(double gamma) {
  auto on = time_on_plate(gamma);
  if (on && gamma > 1) on->from += kImpactDuration;
  return on;
}

void BedSteps::append(const Frame& frame) {
  if (frame.phase >= 0 && before_.phase >= 0 && frame.step == before_.step + 1 &&
      frame.position.size() == before_.position.size()) {
    std::map<std::int64_t, std::size_t> lowest;  // of each column
    for (std::size_t i = 0; i < frame.position.size(); ++i) {
      if (!frame.present(i) || !before_.present(i)) continue;
      const Vec3 &r = before_.position[i], &next = frame.position[i];
      if (!std::isfinite(r.x()) || !std::isfinite(r.z()) || !std::isfinite(next.z())) continue;
      const auto column = static_cast<std::int64_t>(std::floor(r.x()));
      const auto [at, isnew] = lowest.try_emplace(column, i);
      if (!isnew && r.z() < before_.position[at->second].z()) at->second = i;
    }
    if (lowest.size() >= kMinBeads) {
      std::vector<double> dz, down;
      for (const auto& [column, i] : lowest) {
        dz.push_back(frame.position[i].z() - before_.position[i].z());
        down.push_back(-dz.back());
      }
      Step step{.cycle = before_.cycle, .phase = before_.phase};
      const double period = info_.drive->period();
      // The origin of time may be in another cycle than that of the cycle count.
      const double phase = static_cast<double>(before_.phase) / info_.phases_per_cycle;
      step.begin = phase + std::remainder(before_.time / period - phase, 1.0);
      step.end = step.begin + (frame.time - before_.time) / period;
      // The upper median alone would bias every step upwards; average it with the lower median.
      step.spread = robust_spread(dz, upper_median(std::vector<double>(dz)));
      step.dz = (upper_median(std::move(dz)) - upper_median(std::move(down))) / 2;
      steps_.push_back(step);
    }
  }
  before_ = frame;
}

namespace {

/// The amplitude at which the phases of a bed on its plate return that amplitude: the scan goes from
/// `smallest` to `largest` times the stated one, and a solution is where a(A)/A falls through 1. Of several,
/// the one closest to the stated amplitude.
std::optional<BedDrive> amplitude_of(const std::vector<BedSteps::Step>& steps, const Drive& drive,
                                     double smallest, double largest) {
  const double stated = drive.amplitude, per = drive.omega * drive.omega / drive.gravity;
  std::optional<BedDrive> found;
  double last = 0;
  for (double amplitude = smallest * stated; amplitude < largest * stated; amplitude *= kTrialRatio) {
    const auto rest = time_at_rest(amplitude * per);
    if (!rest) break;
    const Fit fit = fit_steps(steps, rest->from, rest->to);
    if (fit.cycles < kMinCycles || fit.steps < kMinSteps) break;  // larger A leaves fewer phases
    const double ratio = fit.a / amplitude;
    const bool through = last > 1 && ratio <= 1;
    last = ratio;
    if (!through || fit.misfit > kMaxMisfit || std::abs(fit.b) > kMaxPhaseError * fit.a) continue;
    const BedDrive here{.amplitude = fit.a,
                        .amplitude_error = fit.error,
                        .cycles = fit.cycles,
                        .from = rest->from,
                        .to = rest->to};
    if (!found || std::abs(std::log(here.amplitude / stated)) < std::abs(std::log(found->amplitude / stated)))
      found = here;
  }
  return found;
}

/// The steps of frames that are `shift` phases later than stated.
std::vector<BedSteps::Step> later(std::vector<BedSteps::Step> steps, int shift, int phases) {
  for (BedSteps::Step& step : steps) {
    const int phase = step.phase + shift;
    const double length = step.end - step.begin, rest = step.begin - static_cast<double>(step.phase) / phases;
    step.cycle += phase / phases;
    step.phase = phase % phases;
    step.begin = static_cast<double>(step.phase) / phases + rest;
    step.end = step.begin + length;
  }
  return steps;
}

/// The drive at the only shift of the phases at which the bed moves like the stated plate.
std::optional<BedDrive> at_another_phase(const BedSteps& bed, const Drive& drive, int phases) {
  constexpr double kMaxAmplitudeDifference = 0.1;  // fraction of the stated amplitude
  std::optional<BedDrive> found;
  for (int shift = 1; shift < phases; ++shift) {
    std::optional<BedDrive> here = amplitude_of(later(bed.steps(), shift, phases), drive,
                                                1 - kMaxAmplitudeDifference, 1 + kMaxAmplitudeDifference);
    if (!here) continue;
    if (found && shift - found->phase_shift > 1) return std::nullopt;
    const double off = std::abs(std::log(here->amplitude / drive.amplitude));
    if (found && off > std::abs(std::log(found->amplitude / drive.amplitude))) continue;
    found = here;
    found->phase_shift = shift;
  }
  if (found && 2 * found->phase_shift > phases) found->phase_shift -= phases;
  return found;
}

/// Acceleration of the bed at a phase, in g, upwards: mean over cycles and its standard error.
struct Acceleration {
  std::int32_t phase = -1;
  double mean = 0, error = 0;
};

/// Of the phases that are seen in enough cycles.
std::vector<Acceleration> accelerations(const std::vector<BedSteps::Step>& steps, const Drive& drive) {
  struct Sums {
    double n = 0, sum = 0, squares = 0;
  };
  std::map<std::int32_t, Sums> phases;
  for (std::size_t k = 1; k < steps.size(); ++k) {
    const BedSteps::Step &before = steps[k - 1], &now = steps[k];
    const double gap = static_cast<double>(now.cycle - before.cycle) + now.begin - before.end;
    if (std::abs(gap) > 1e-6) continue;  // a frame is missing in between
    const double period = drive.period(), first = (before.end - before.begin) * period,
                 second = (now.end - now.begin) * period;
    const double a = 2 * (now.dz / second - before.dz / first) / (first + second) / drive.gravity;
    Sums& sums = phases[now.phase];
    sums.n += 1, sums.sum += a, sums.squares += a * a;
  }
  std::vector<Acceleration> all;
  for (const auto& [phase, sums] : phases) {
    if (sums.n < kMinCycles) continue;
    const double mean = sums.sum / sums.n,
                 error = std::sqrt(std::max(0.0, sums.squares / sums.n - mean * mean) / (sums.n - 1));
    all.push_back({phase, mean, error});
  }
  return all;
}

constexpr double kMaxDeviation = 3;  // standard errors

/// The longest part of a cycle in which the bed is accelerated downwards by clearly more than `most` g.
double time_of_fall(const std::vector<Acceleration>& all, double most, int phases_per_cycle) {
  std::vector<bool> falls(static_cast<std::size_t>(phases_per_cycle), false);
  for (const Acceleration& a : all)
    if (a.phase < phases_per_cycle)
      falls[static_cast<std::size_t>(a.phase)] = a.mean + kMaxDeviation * a.error < -most;
  std::size_t longest = 0, now = 0;
  for (std::size_t k = 0; k < 2 * falls.size(); ++k) {  // the cycle is periodic
    now = falls[k % falls.size()] ? now + 1 : 0;
    longest = std::max(longest, std::min(now, falls.size()));
  }
  return static_cast<double>(longest) / phases_per_cycle;
}

/// Whether the columns of the bed move together, unlike the beads of a gas.
bool moves_as_one(const std::vector<BedSteps::Step>& steps) {
  constexpr double kMaxSpread = 0.3;  // of the steps
  double squares = 0, spreads = 0;
  for (const BedSteps::Step& step : steps) squares += step.dz * step.dz, spreads += step.spread * step.spread;
  return spreads < kMaxSpread * kMaxSpread * squares;
}

/// A sine of the plate's period through the steps of a bed, one step for each phase.
struct Sine {
  double a = 0, b = 0;  ///< a sin th + b cos th
  double misfit = 1;    ///< rms departure, relative to the steps
};

/// Of the means over the cycles, or nothing if a phase was not seen.
std::optional<Sine> sine_through(const std::vector<BedSteps::Step>& steps, int phases_per_cycle) {
  struct Mean {
    double s = 0, c = 0, dz = 0, n = 0;
  };
  std::map<std::int32_t, Mean> phases;
  for (const BedSteps::Step& step : steps) {
    Mean& mean = phases[step.phase];
    mean.s += std::sin(kTurn * step.end) - std::sin(kTurn * step.begin);
    mean.c += std::cos(kTurn * step.end) - std::cos(kTurn * step.begin);
    mean.dz += step.dz, mean.n += 1;
  }
  if (phases.size() < static_cast<std::size_t>(phases_per_cycle)) return std::nullopt;
  double ss = 0, sc = 0, cc = 0, sz = 0, cz = 0, zz = 0;
  for (const auto& [phase, mean] : phases) {
    const double s = mean.s / mean.n, c = mean.c / mean.n, dz = mean.dz / mean.n;
    ss += s * s, sc += s * c, cc += c * c, sz += s * dz, cz += c * dz, zz += dz * dz;
  }
  const double det = ss * cc - sc * sc;
  if (!(det > 0 && zz > 0)) return std::nullopt;
  Sine sine{.a = (sz * cc - cz * sc) / det, .b = (cz * ss - sz * sc) / det};
  sine.misfit = std::sqrt(std::max(0.0, zz - sine.a * sz - sine.b * cz) / zz);
  return sine;
}

/// The same of a body without rebound on the plate, seen at the same phases. \pre 1 < Gamma, flights within
/// a cycle
std::optional<Sine> sine_through_flight(std::vector<BedSteps::Step> steps, int phases_per_cycle,
                                        double gamma) {
  const TimeOnPlate on = time_on_plate(gamma).value_or(TimeOnPlate{});
  const auto height = [&](double cycles) {
    const double since = cycles - on.to - std::floor(cycles - on.to);  // the take-off
    return std::sin(kTurn * cycles) +
           (since < 1 + on.from - on.to ? height_of_flight(gamma, kTurn * (on.to + since)) : 0);
  };
  for (BedSteps::Step& step : steps) step.dz = height(step.end) - height(step.begin);
  return sine_through(steps, phases_per_cycle);
}

/// A bed that follows its plate over the whole cycle, although a plate of the stated strength throws it. The
/// departure from a sine is compared with that of a bed without rebound; errors of the centres only increase
/// it.
std::string rest_on_strong_plate(const std::vector<BedSteps::Step>& steps, const Drive& drive,
                                 int phases_per_cycle) {
  constexpr double kMargin = 1.1;    // ratio of Gamma: side walls, liquid, the error of the frequency
  constexpr double kLongFlight = 3;  // Gamma; above, a flight can outlast a cycle
  constexpr int kMinPhases = 8;      // per cycle; with fewer, a flight is between two frames
  constexpr double kMaxShare = 0.5;  // of the departure of a bed that is thrown
  constexpr double kMaxApart = 0.1;  // relative difference of the amplitudes of bed and plate
  const double gamma = std::min(drive.gamma() / kMargin, kLongFlight);
  if (gamma <= 1 || phases_per_cycle < kMinPhases) return {};
  const auto bed = sine_through(steps, phases_per_cycle);
  const auto thrown = sine_through_flight(steps, phases_per_cycle, gamma);
  if (!bed || !thrown || std::abs(bed->a / drive.amplitude - 1) > kMaxApart ||
      std::abs(bed->b) > kMaxPhaseError * bed->a || bed->misfit > kMaxShare * thrown->misfit)
    return {};
  return fmt::format(
      "the bed follows its plate over the whole cycle, with departures of {:.2g} % of its steps, but a plate "
      "with Gamma = {:.3g} throws it, with departures of {:.2g} % at least: the frequency, the frame rate or "
      "the scale is wrong, unless the beads stick to the plate",
      100 * bed->misfit, drive.gamma(), 100 * thrown->misfit);
}

/// The observation that contradicts any drive of this strength, as a clause; otherwise empty.
std::string contradiction_of(const std::vector<BedSteps::Step>& steps, const Drive& drive,
                             int phases_per_cycle) {
  constexpr double kMinMotion = 0.05;       // rms step of a moving bed, fraction of the plate's
  constexpr double kMaxAcceleration = 1.5;  // multiple of gravity, or of the acceleration of the plate
  double moved = 0, of_plate = 0;           // sums of squares
  for (const BedSteps::Step& step : steps) {
    const double plate = drive.amplitude * (std::sin(kTurn * step.end) - std::sin(kTurn * step.begin));
    moved += step.dz * step.dz;
    of_plate += plate * plate;
  }
  if (moved < kMinMotion * kMinMotion * of_plate)
    return fmt::format("the beads stand still in the frames, but the cell states a plate of A = {:.4g} sigma",
                       drive.amplitude);
  if (std::string why = rest_on_strong_plate(steps, drive, phases_per_cycle); !why.empty()) return why;
  const std::vector<Acceleration> all = accelerations(steps, drive);
  const auto fall =
      std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.mean < b.mean; });
  if (fall == all.end()) return {};
  if (const double most = kMaxAcceleration * std::max(1.0, drive.gamma());
      fall->mean < -most - kMaxDeviation * fall->error)
    return fmt::format(
        "the bed is accelerated downwards by {:.2g} +- {:.1g} g at phase {}, more than gravity and a plate "
        "with Gamma = {:.3g} can do: the picture is upside down, or the scale, the frame rate or the "
        "frequency is wrong",
        -fall->mean, fall->error, fall->phase, drive.gamma());
  // With fewer phases, the largest step of the velocity of a short flight contains its impact.
  constexpr int kMinPhases = 12;
  if (phases_per_cycle < kMinPhases || !moves_as_one(steps)) return {};
  constexpr double kFlies = 1.3;         // Gamma
  constexpr double kMinFall = 0.5;       // multiple of gravity: side walls and liquid retard a bed
  constexpr double kSustained = 2;       // multiple of gravity
  constexpr double kMinDuration = 0.12;  // of a cycle; after an impact the beads push each other for less
  if (drive.gamma() > kFlies && fall->mean - kMaxDeviation * fall->error > -kMinFall)
    return fmt::format(
        "the bed is accelerated downwards by {:.2g} +- {:.1g} g at most, but a plate with Gamma = {:.3g} "
        "throws it, and then it falls by 1 g: the frequency or the scale is wrong",
        -fall->mean, fall->error, drive.gamma());
  if (const double lasts = time_of_fall(all, kSustained, phases_per_cycle); lasts >= kMinDuration)
    return fmt::format(
        "the bed is accelerated downwards by more than {:g} g during {:.2g} of a cycle, by {:.2g} +- {:.1g} "
        "g at most, but only gravity pulls it down: the frequency, the frame rate or the scale is wrong",
        kSustained, lasts, -fall->mean, fall->error);
  return {};
}

/// The same of a bed that leaves a plate with Gamma < 1. \pre the phases of the frames are those of the plate
std::string flight_from_weak_plate(const std::vector<BedSteps::Step>& steps, const Drive& drive) {
  constexpr double kRests = 0.95;         // Gamma
  constexpr double kMinAmplitude = 0.03;  // sigma; smaller ones are lost in the errors of the centres
  constexpr double kMaxApart = 0.35;      // rms, of the steps of the plate; half a frame of delay gives 0.16
  if (drive.gamma() > kRests || drive.amplitude < kMinAmplitude) return {};
  struct Sums {
    double n = 0, apart = 0, plate = 0;
  };
  std::map<std::int32_t, Sums> phases;
  for (const BedSteps::Step& step : steps) {
    const double plate = drive.amplitude * (std::sin(kTurn * step.end) - std::sin(kTurn * step.begin));
    Sums& sums = phases[step.phase];
    sums.n += 1, sums.apart += step.dz - plate, sums.plate += plate;
  }
  double apart = 0, size = 0;
  for (const auto& [phase, sums] : phases) {
    if (sums.n < kMinCycles) continue;
    apart += sums.apart * sums.apart / (sums.n * sums.n), size += sums.plate * sums.plate / (sums.n * sums.n);
  }
  if (size == 0 || apart < kMaxApart * kMaxApart * size) return {};
  return fmt::format(
      "the bed leaves its plate, which no plate with Gamma = {:.3g} can make it do: the frequency or the "
      "scale is wrong",
      drive.gamma());
}

/// Why the bed cannot be compared with its drive; empty if it can.
std::string not_comparable(const BedSteps& bed, const TrajectoryInfo& info) {
  if (!info.drive->harmonics.empty() || info.drive->recorded || info.drive->ramp)
    return "the drive is not a sine";
  if (info.phases_per_cycle == 0) return "the frames have no fixed phases";
  if (bed.steps().empty())
    return fmt::format("fewer than {} columns of beads are seen in consecutive frames", kMinBeads);
  return {};
}

}  // namespace

std::string contradiction_of_bed(const BedSteps& bed, const TrajectoryInfo& info) {
  if (!not_comparable(bed, info).empty()) return {};
  std::string why = contradiction_of(bed.steps(), *info.drive, info.phases_per_cycle);
  return why.empty() ? flight_from_weak_plate(bed.steps(), *info.drive) : why;
}

BedDrive drive_of_bed(const BedSteps& bed, const TrajectoryInfo& info) {
  BedDrive none;
  const auto because = [&](std::string why) {
    none.not_comparable = std::move(why);
    return none;
  };
  if (std::string why = not_comparable(bed, info); !why.empty()) return because(std::move(why));
  if (std::string why = contradiction_of(bed.steps(), *info.drive, info.phases_per_cycle); !why.empty())
    return {.amplitude = 0, .contradiction = std::move(why)};
  if (const auto found = amplitude_of(bed.steps(), *info.drive, kMinTrial, kMaxTrial)) return *found;
  if (const auto found = at_another_phase(bed, *info.drive, info.phases_per_cycle)) return *found;
  return because("at no phase of the cycle do its lowest beads move like a plate");
}

}  // namespace twincell::calibration
