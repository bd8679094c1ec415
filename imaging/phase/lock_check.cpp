#include "imaging/phase/lock_check.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/constants.hpp"
#include "core/error.hpp"
#include "core/median.hpp"
#include "imaging/phase/dropped_frame_costs.hpp"
#include "imaging/phase/plate_phases.hpp"

namespace twincell::imaging {

namespace {

constexpr double kMaxSlips = 0.1;  // of the frames
constexpr const char* kCure =
    "use --phase-lock found, or a list of the phases (calibrate plate --phases LIST.csv, then --phase-lock "
    "LIST.csv), or correct the frames per cycle";

[[noreturn]] void refuse(const PhaseTable& table, const std::string& why) {
  throw ConfigError(Where{.file = {}, .key = "frames_per_cycle"},
                    fmt::format("is {}, but {}; {}.", table.frames_per_cycle, why, kCure));
}

/// Accepts ticks in which frames are missing or doubled, unless they are too many. \param source "the plate"
/// \param out_of_lock frames whose ticks are not used
void accept(PhaseTable& table, std::span<const std::int64_t> ticks, std::span<const FrameStretch> out_of_lock,
            const std::string& source) {
  set_phases(table, ticks);
  leave_out(table, out_of_lock);
  const auto slips = static_cast<std::size_t>(std::count_if(
      table.frames.begin(), table.frames.end(), [](const FramePhase& f) { return f.interval != 1; }));
  const auto first = std::find_if(table.frames.begin(), table.frames.end(),
                                  [](const FramePhase& f) { return f.interval != 1; }) -
                     table.frames.begin();
  if (static_cast<double>(slips) > kMaxSlips * static_cast<double>(ticks.size()))
    refuse(table, fmt::format("by {} {} of {} frames do not follow the frame before them, the first at frame "
                              "{}",
                              source, slips, ticks.size(), first));
  if (slips == 0) return;
  table.warning = fmt::format(
      "by {}, not every frame follows the frame before it: {}; the phases of all later "
      "frames are corrected (--trust-stated-drive keeps the stated lock)",
      source, slips_in_words(table.frames));
}

/// \returns whether the plate could tell; `why_not` if it could not
bool by_plate(PhaseTable& table, const PhaseLock& lock, std::span<const double> plate, std::string& why_not) {
  constexpr double kMaxPhaseDifference = 0.6;  // frames
  const PlateReading reading = read_plate(plate, table.frames_per_cycle);
  if (reading.other)
    refuse(table,
           fmt::format("the plate in the frames repeats itself after {:.4g} frames, so that the phases "
                       "drift by {:.2g} frames over the film",
                       reading.other->period,
                       std::abs(table.frames_per_cycle / reading.other->period - 1) *
                           static_cast<double>(plate.size())));
  if (!reading.changes.empty()) {
    // The bed, which changes with the plate, cannot tell lost frames from the change.
    table.warning = fmt::format(
        "the plate {}, so that the film shows more than one strength of the drive; track the parts one by "
        "one (--frames A:B); the phases are those that are stated",
        reading.changes);
    return true;
  }
  if (!reading.slips) {
    why_not = reading.why_not;
    return false;
  }
  const SineSlips& fit = *reading.slips;
  table.checked_by = "the plate";
  if (fit.dropped + fit.doubled > 0) accept(table, fit.ticks, reading.out_of_lock, "the plate in the frames");
  const auto add_warning = [&](const std::string& said) {
    table.warning += (table.warning.empty() ? "" : "; ") + said;
  };
  if (!reading.out_of_lock.empty()) {
    if (table.frames.empty()) {
      set_phases(table, fit.ticks);
      leave_out(table, reading.out_of_lock);
    }
    add_warning(out_of_lock_in_words(table));
  }
  constexpr double kMaxMisreadShare = 0.03;  // of the frames
  if (reading.far_off > 0 ||
      static_cast<double>(reading.misread) > kMaxMisreadShare * static_cast<double>(plate.size()))
    add_warning(fmt::format(
        "the plate is off its sine in {} of {} frames{}: its edge is misread there, a frame is not "
        "where it belongs, or the drive is not steady (calibrate plate names these frames)",
        reading.misread, plate.size(), reading.out_of_lock.empty() ? "" : " that are kept"));
  // Phase of the first frame.
  const double cycle = table.frames_per_cycle;
  const double off = std::remainder(fit.phase * cycle - table.first_phase - lock.offset, cycle);
  if (std::abs(off) > kMaxPhaseDifference) {
    const long shown =
        ((std::lround(fit.phase * cycle - lock.offset) % table.frames_per_cycle) + table.frames_per_cycle) %
        table.frames_per_cycle;
    constexpr double kMaxWarnedDifference = 0.75;  // frames; a larger one is an error
    if (std::abs(off) > kMaxWarnedDifference)
      throw ConfigError(
          Where{.file = {}, .key = "first_phase"},
          fmt::format("is {}, but the plate in the frames shows the first frame at phase {} of {}; "
                      "correct it (camera.first_phase, --first-phase), or keep it with "
                      "--trust-stated-drive.",
                      table.first_phase, shown, table.frames_per_cycle));
    add_warning(
        fmt::format("the plate shows the first frame at phase {} of {}, but the stated first phase is {} "
                    "(--first-phase)",
                    shown, table.frames_per_cycle, table.first_phase));
  }
  return true;
}

bool by_times(PhaseTable& table, std::span<const double> times, std::string& why_not) {
  constexpr double kMaxRounding = 0.25;  // of a step to whole frames, frames
  if (times.size() < 3) {
    why_not += " and the stack has no time stamps";
    return false;
  }
  std::vector<double> steps;
  for (std::size_t f = 1; f < times.size(); ++f) steps.push_back(times[f] - times[f - 1]);
  const double usual = upper_median(steps);
  std::vector<std::int64_t> ticks = {0};
  bool slips = false;
  for (const double step : steps) {
    const double by = usual > 0 ? step / usual : -1;
    if (!(by > -kMaxRounding) || std::abs(by - std::round(by)) > kMaxRounding || by > 1e9) {
      why_not += " and the time stamps are irregular";
      return false;
    }
    slips = slips || std::llround(by) != 1;
    ticks.push_back(ticks.back() + std::llround(by));
  }
  table.checked_by = "the time stamps";
  if (slips) accept(table, ticks, {}, "the time stamps of the camera");
  return true;
}

}  // namespace

std::string slips_in_words(std::span<const FramePhase> frames) {
  constexpr int kMaxNamed = 8;
  std::string dropped, doubled;
  int named = 0;
  for (std::size_t f = 1; f < frames.size(); ++f) {
    const double by = frames[f].interval;
    if (by == 1) continue;
    if (++named > kMaxNamed) break;
    if (by > 1)
      dropped += fmt::format("{}{:.0f} before frame {}", dropped.empty() ? "" : ", ", by - 1, f);
    else
      doubled += fmt::format("{}{}", doubled.empty() ? "" : ", ", f);
  }
  std::string text;
  if (!dropped.empty()) text = "missing: " + dropped;
  if (!doubled.empty()) text += (text.empty() ? "" : "; ") + ("taken twice: frame " + doubled);
  return named > kMaxNamed ? text + ", ..." : text;
}

PhaseTable check_lock(const PhaseLock& lock, const LockEvidence& evidence) {
  PhaseTable table = fixed_phases(lock);
  std::string why_not;
  if (by_plate(table, lock, evidence.plate_px, why_not) || by_times(table, evidence.times_s, why_not))
    return table;
  table.not_checked = why_not;
  return table;
}

namespace {

constexpr int kTerms = 5;  // 1, sin, cos, and of the second harmonic

/// Heights of the plate fitted by the first two harmonics of the phases of the frames.
struct Harmonics {
  double sine = 0, cosine = 0;  ///< of the first
  double left = 0, all = 0;     ///< sums of squares about the fit and about the mean
};

Harmonics fit_harmonics(const std::vector<double>& cycles, const std::vector<double>& seen) {
  const auto n = static_cast<Eigen::Index>(seen.size());
  Eigen::MatrixXd terms(n, kTerms);
  Eigen::VectorXd heights(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double c = cycles[static_cast<std::size_t>(k)], turn = kTurn * (c - std::floor(c));
    terms.row(k) << 1, std::sin(turn), std::cos(turn), std::sin(2 * turn), std::cos(2 * turn);
    heights[k] = seen[static_cast<std::size_t>(k)];
  }
  const Eigen::VectorXd fit = terms.completeOrthogonalDecomposition().solve(heights);
  return {fit[1], fit[2], (heights - terms * fit).squaredNorm(),
          (heights.array() - heights.mean()).square().sum()};
}

/// Whether the plate is so much closer to a sine with its own phases that these are not those of the list
/// with slips that happen to fit. \param slips of the plate's own phases
bool fits_better(const Harmonics& own, const Harmonics& listed, std::size_t frames, std::ptrdiff_t slips) {
  const double n = static_cast<double>(frames),
               floor = n * std::pow(kMinScatter * std::hypot(own.sine, own.cosine), 2);
  return n / 2 * std::log(std::max(listed.left, floor) / std::max(own.left, floor)) >
         kSlipCost * static_cast<double>(slips + 1);
}

}  // namespace

void check_list_by_plate(PhaseTable& table, std::span<const double> plate_px, bool sine) {
  constexpr double kMinExplainedShare = 0.5;     // of the variance of the heights
  constexpr double kMaxPhaseDifference = 0.75;   // frames
  constexpr double kMaxPeriodDifference = 0.01;  // relative
  if (!table.locked()) return;
  const std::optional<PhaseTable> alone = phases_from_plate(plate_px, 0);
  if (!alone) return;
  std::vector<double> listed, own, heights;  // cycles, px
  for (std::size_t f = 0; f < plate_px.size(); ++f) {
    const auto by_list = table.cycles_at(static_cast<std::int64_t>(f)),
               by_plate = alone->cycles_at(static_cast<std::int64_t>(f));
    if (!by_list || !by_plate || !std::isfinite(plate_px[f])) continue;
    listed.push_back(*by_list), own.push_back(*by_plate), heights.push_back(plate_px[f]);
  }
  if (heights.size() < 3 * kTerms) return;
  const Harmonics fit = fit_harmonics(listed, heights);
  const auto refuse_list = [](const std::string& why) {
    throw ConfigError(
        Where{.file = {}, .key = "--phase-lock"},
        fmt::format("{}; correct the list or the frequency of the drive (--drive-hz), or keep them with "
                    "--trust-stated-drive.",
                    why));
  };
  if (fit.left > (1 - kMinExplainedShare) * fit.all) {
    const double of_list = table.period_frames.value_or(table.frames_per_cycle),
                 of_plate = alone->period_frames.value_or(alone->frames_per_cycle);
    if (std::abs(of_list - of_plate) > kMaxPeriodDifference * of_plate)
      refuse_list(fmt::format(
          "by the list there are {:.4g} frames per cycle, but the plate in the frames repeats itself "
          "after {:.4g} frames",
          of_list, of_plate));
    return;
  }
  const double ahead = std::atan2(fit.cosine, fit.sine) / kTurn;  // cycles
  if (sine && std::abs(ahead) * table.frames_per_cycle > kMaxPhaseDifference)
    refuse_list(
        fmt::format("the plate in the frames is {:.3g} of a cycle {} than the phases of the list state",
                    std::abs(ahead), ahead > 0 ? "later in its cycle" : "earlier in its cycle"));
  const Harmonics of_plate = fit_harmonics(own, heights);
  const double own_ahead = std::atan2(of_plate.cosine, of_plate.sine) / kTurn;
  double farthest = 0;  // frames
  for (std::size_t k = 0; k < heights.size(); ++k)
    farthest = std::max(farthest, alone->frames_per_cycle *
                                      std::abs(std::remainder(listed[k] + ahead - own[k] - own_ahead, 1.0)));
  const auto slips = std::count_if(alone->frames.begin(), alone->frames.end(),
                                   [](const FramePhase& f) { return std::lround(f.interval) != 1; });
  if (farthest > kMaxPhaseDifference && fits_better(of_plate, fit, heights.size(), slips)) {
    const std::string lost = slips > 0 ? " (" + slips_in_words(alone->frames) + ")" : "";
    refuse_list(
        fmt::format("the phases of the list are up to {:.2g} frames from those of the plate in the frames{}, "
                    "which follows its own phases to {:.2g} px and those of the list to {:.2g} px",
                    farthest, lost, std::sqrt(of_plate.left / static_cast<double>(heights.size())),
                    std::sqrt(fit.left / static_cast<double>(heights.size()))));
  }
  table.checked_by = "the plate";
}

void check_lock_by_bed(PhaseTable& table, const BedMotion& motion) {
  constexpr double kMaxJitter = 1.0 / 3;         // of the bed's cycles, frames
  constexpr double kMaxJitterAfterSlips = 0.15;  // frames
  constexpr double kMinRise = 0.02;              // of the bed, bead diameters
  constexpr std::size_t kMinCycles = 3;
  const auto cannot = [&](const std::string& why) { table.not_checked += ", and " + why; };
  const auto n = static_cast<std::size_t>(table.frames_per_cycle);
  if (motion.heights.size() < kMinCycles * n)
    return cannot(fmt::format("{} frames are less than three cycles of the bed", motion.heights.size()));
  const auto [low, high] = std::minmax_element(motion.heights.begin(), motion.heights.end());
  if (!(*high - *low > kMinRise)) return cannot("the bed is at rest");
  PhaseTable found;
  try {
    found = estimate_phases(motion, {.frames_per_cycle = table.frames_per_cycle, .gamma = {}});
  } catch (const InputError&) {
    return cannot("the bed's motion does not repeat itself after so many frames");
  }
  if (!(found.jitter.value_or(1) < kMaxJitter))
    return cannot(fmt::format("the bed's cycles differ by up to {:.2g} frames", found.jitter.value_or(1)));
  const bool slips = found.dropped + found.doubled > 0;
  // Cycles that differ look like slips that come and go. After true slips the cycles agree closely.
  if (slips && !(found.jitter.value_or(1) < kMaxJitterAfterSlips))
    return cannot("the bed's cycles differ as if frames were missing (compare --phase-lock found)");
  table.checked_by = "the bed";
  table.not_checked.clear();
  if (!slips) return;
  std::vector<std::int64_t> ticks = {0};
  for (std::size_t f = 1; f < found.frames.size(); ++f)
    ticks.push_back(ticks.back() + std::llround(found.frames[f].interval));
  accept(table, ticks, {}, "the motion of the bed");
}

}  // namespace twincell::imaging
