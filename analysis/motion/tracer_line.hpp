#pragma once
/// \file
/// The line of tracers from cycle to cycle: how far it spreads, whether it goes on spreading.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/statistics/statistics.hpp"

namespace twincell {

/// Heights of the tracers at the beginnings of cycles, sigma.
struct TracerLine {
  std::size_t n_tracers = 0;
  std::vector<std::int64_t> cycle = {};  ///< [n] numbers of the cycles, rising
  std::vector<double> height = {};       ///< [n x n_tracers], NaN where a tracer was not seen

  [[nodiscard]] std::size_t n() const { return cycle.size(); }
  [[nodiscard]] double at(std::size_t j, std::size_t tracer) const { return height[j * n_tracers + tracer]; }
};

/// A moment counts if at least this share of the tracers is there.
inline constexpr double kEnoughTracers = 0.8;

/// s_j^2 of row j: variance of the heights about their mean (Fortini & Huang 2015, eq. B1), over the tracers
/// `picked` (repeats count). NaN with fewer than 2 heights, or fewer than 80 % of them.
double spread_squared(const TracerLine& line, std::size_t j, const std::vector<std::size_t>& picked);

/// Each tracer's squared height about the line's mean, averaged over its cycles: s_c^2 is the mean of these.
std::vector<double> mean_squares(const TracerLine& line);

/// d s_j^2/dj, sigma^2 a cycle.
struct Growth {
  double rate = 0;                        ///< NaN for fewer than 2 rows with a value
  std::optional<Interval> interval = {};  ///< over tracers; absent for fewer than 3
};

/// Growth over rows first .. last - 1 by least squares, rows without a value left out. s_j^2 is a mean over
/// tracers, and so is its slope: the interval is that of a mean over tracers (mean_interval in
/// statistics.hpp), which holds however smoothly or abruptly the line moves.
Growth growth(const TracerLine& line, std::size_t first, std::size_t last);

/// What a line of tracers does over a run.
enum class Drift {
  undetermined,
  still,     ///< it does not move
  annealed,  ///< it moved at first and came to rest: rearrangement of the first packing, not convection
  drifting,  ///< tracers move, and s_j^2 still grows
  mixing,    ///< tracers move, s_j^2 does not grow any more: it has reached what the bed allows
};
/// "undetermined", "still", "annealed", "drifting", "mixing".
std::string drift_name(Drift drift);

/// A word and why.
struct DriftVerdict {
  Drift drift = Drift::undetermined;
  std::string reason = {};
  Growth late = {};  ///< growth over the second half
};

/// Compares the two halves of the run by how far the tracers moved against each other (rms of their net
/// change of height about the line's own). With m the larger of sigma/30 and three times the noise of such a
/// difference:
///   still     both halves below m
///   annealed  second half below m or below a fifth of the first
///   drifting  else, if the interval of d s_j^2/dj over the second half lies above 0
///   mixing    else
/// \param noise standard uncertainty of one height, sigma; 0 if there is none
/// Undetermined for fewer than 8 cycles or 2 tracers.
DriftVerdict judge_drift(const TracerLine& line, double noise);

}  // namespace twincell
