#pragma once
/// \file
/// The line of tracers from cycle to cycle: how far it spreads, and whether it keeps spreading.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/statistics/statistics.hpp"
#include "core/choice.hpp"

namespace twincell::analysis {

/// Heights of the tracers at the beginnings of cycles, sigma.
struct TracerLine {
  std::size_t n_tracers = 0;
  std::vector<std::int64_t> cycle = {};  ///< [n] numbers of the cycles, ascending
  std::vector<double> height = {};       ///< [n x n_tracers], NaN where a tracer is missing

  [[nodiscard]] std::size_t n() const { return cycle.size(); }
  [[nodiscard]] double at(std::size_t j, std::size_t tracer) const { return height[j * n_tracers + tracer]; }
};

/// An instant counts if at least this share of the tracers is present.
inline constexpr double kEnoughTracers = 0.8;

/// s_j^2 of row j: variance of the heights about their mean (Fortini & Huang 2015, eq. B1), over the tracers
/// `picked` (repeated entries count repeatedly). NaN with fewer than 2 heights, or with fewer than 80 % of
/// them.
double spread_squared(const TracerLine& line, std::size_t j, const std::vector<std::size_t>& picked);

/// For each tracer, its squared height about the line's mean, averaged over its cycles. s_c^2 is the mean of
/// these.
std::vector<double> mean_squares(const TracerLine& line);

/// Growth rate d s_j^2/dj, sigma^2 per cycle.
struct Growth {
  double rate = 0;                        ///< NaN with fewer than 2 rows that have a value
  std::optional<Interval> interval = {};  ///< over tracers; absent with fewer than 3
};

/// Growth over rows first .. last - 1 by least squares. Rows without a value are left out. s_j^2 is a mean
/// over tracers, and so is its slope. The interval is therefore that of a mean over tracers (mean_interval in
/// statistics.hpp), which is valid for smooth and for abrupt motion of the line.
Growth growth(const TracerLine& line, std::size_t first, std::size_t last);

/// Motion of a line of tracers over a run.
enum class Drift { undetermined, still, annealed, drifting, mixing };
/// All drifts with their words.
inline constexpr std::array kDrifts = {
    Choice<Drift>{Drift::undetermined, "undetermined", "the measurement does not decide"},
    Choice<Drift>{Drift::still, "still", "the line does not move"},
    Choice<Drift>{Drift::annealed, "annealed",
                  "the line moved at first and came to rest: initial packing rearranged, no convection"},
    Choice<Drift>{Drift::drifting, "drifting", "the tracers move, and s_j^2 still grows"},
    Choice<Drift>{Drift::mixing, "mixing",
                  "the tracers move, and s_j^2 no longer grows: it has reached the limit set by the bed"}};
/// The word of a drift.
std::string drift_name(Drift drift);

/// The verdict on the drift, with its reason.
struct DriftVerdict {
  Drift drift = Drift::undetermined;
  std::string reason = {};
  Growth late = {};  ///< growth over the second half
};

/// Compares the relative motion of the tracers in the two halves of the run: the rms over tracers of their
/// net change of height about the mean change of the line. With m the larger of sigma/30 and three times the
/// noise of such a change:
///
/// - still: both halves below m
/// - annealed: second half below m or below a fifth of the first
/// - drifting: otherwise, if the interval of d s_j^2/dj over the second half is above 0
/// - mixing: otherwise
///
/// Undetermined with fewer than 8 cycles or fewer than 2 tracers.
/// \param noise standard uncertainty of one height, sigma; 0 if unknown
DriftVerdict judge_drift(const TracerLine& line, double noise);

}  // namespace twincell::analysis
