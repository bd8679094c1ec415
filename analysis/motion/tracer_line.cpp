#include "analysis/motion/tracer_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/motion/bed_phase.hpp"
#include "core/constants.hpp"
#include "core/plural.hpp"

namespace twincell::analysis {
namespace {

constexpr std::size_t kMinCycles = 8;
constexpr double kCameToRest =
    0.2;  ///< motion of the second half relative to the first, below which it is annealed

std::vector<std::size_t> everyone(const TracerLine& line) {
  std::vector<std::size_t> all(line.n_tracers);
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

std::vector<double> spreads(const TracerLine& line, std::size_t first, std::size_t last,
                            const std::vector<std::size_t>& picked) {
  std::vector<double> series;
  for (std::size_t j = first; j < last; ++j) {
    const double s = spread_squared(line, j, picked);
    if (std::isfinite(s)) series.push_back(s);
  }
  return series;
}

/// Squared height of one tracer about the line's mean, for each row that contains the tracer.
std::vector<double> squares_about_line(const TracerLine& line, std::size_t first, std::size_t last,
                                       std::size_t tracer) {
  std::vector<double> series;
  for (std::size_t j = first; j < last; ++j) {
    double sum = 0;
    std::size_t n = 0;
    for (std::size_t t = 0; t < line.n_tracers; ++t)
      if (std::isfinite(line.at(j, t))) {
        sum += line.at(j, t);
        ++n;
      }
    const double off = line.at(j, tracer) - sum / static_cast<double>(n);
    if (std::isfinite(off)) series.push_back(off * off);
  }
  return series;
}

/// Least-squares slope per entry; NaN for fewer than 2 entries.
double slope_of(const std::vector<double>& series) {
  const auto n = static_cast<double>(series.size());
  double xx = 0, xy = 0;
  for (std::size_t j = 0; j < series.size(); ++j) {
    const double x = static_cast<double>(j) - (n - 1) / 2;
    xx += x * x;
    xy += x * series[j];
  }
  return series.size() < 2 ? kNaN : xy / xx;
}

/// rms over tracers of the net change of height between two rows, about the mean change.
double moved(const TracerLine& line, std::size_t from, std::size_t to) {
  std::vector<double> change;
  for (std::size_t t = 0; t < line.n_tracers; ++t) {
    const double d = line.at(to, t) - line.at(from, t);
    if (std::isfinite(d)) change.push_back(d);
  }
  if (change.size() < 2) return kNaN;
  const double mean = std::accumulate(change.begin(), change.end(), 0.0) / static_cast<double>(change.size());
  double squares = 0;
  for (const double d : change) squares += (d - mean) * (d - mean);
  return std::sqrt(squares / static_cast<double>(change.size()));
}

}  // namespace

double spread_squared(const TracerLine& line, std::size_t j, const std::vector<std::size_t>& picked) {
  double sum = 0;
  std::size_t n = 0;
  for (const std::size_t t : picked)
    if (std::isfinite(line.at(j, t))) {
      sum += line.at(j, t);
      ++n;
    }
  if (n < 2 || static_cast<double>(n) < kEnoughTracers * static_cast<double>(picked.size())) return kNaN;
  const double mean = sum / static_cast<double>(n);
  double squares = 0;
  for (const std::size_t t : picked)
    if (std::isfinite(line.at(j, t))) squares += (line.at(j, t) - mean) * (line.at(j, t) - mean);
  return squares / static_cast<double>(n);
}

std::vector<double> mean_squares(const TracerLine& line) {
  std::vector<double> means;
  for (std::size_t t = 0; t < line.n_tracers; ++t) {
    const std::vector<double> own = squares_about_line(line, 0, line.n(), t);
    if (!own.empty())
      means.push_back(std::accumulate(own.begin(), own.end(), 0.0) / static_cast<double>(own.size()));
  }
  return means;
}

Growth growth(const TracerLine& line, std::size_t first, std::size_t last) {
  Growth result{.rate = slope_of(spreads(line, first, last, everyone(line)))};
  if (!std::isfinite(result.rate)) return result;
  std::vector<double> slopes;
  for (std::size_t t = 0; t < line.n_tracers; ++t) {
    const std::vector<double> own = squares_about_line(line, first, last, t);
    if (own.size() > 1) slopes.push_back(slope_of(own));
  }
  result.interval = mean_interval(slopes, "tracers");
  return result;
}

std::string drift_name(Drift drift) {
  return std::string(row_of(kDrifts, drift).word);
}

DriftVerdict judge_drift(const TracerLine& line, double noise) {
  DriftVerdict verdict;
  if (line.n() < kMinCycles || line.n_tracers < 2) {
    verdict.reason = fmt::format("{} and {}; at least {} and 2 are needed", plural(line.n(), "cycle"),
                                 plural(line.n_tracers, "tracer"), kMinCycles);
    return verdict;
  }
  const std::size_t middle = line.n() / 2, end = line.n() - 1;
  const double early = moved(line, 0, middle), late = moved(line, middle, end);
  if (!std::isfinite(early) || !std::isfinite(late)) {
    verdict.reason = "too few tracers are seen at the beginning, the middle and the end of the run";
    return verdict;
  }
  verdict.late = growth(line, middle, line.n());
  const double least = std::max(kHalfPixelOfPaper1, 3 * std::sqrt(2.0) * noise);
  const bool grows = verdict.late.interval && verdict.late.interval->low > 0;
  std::string because;
  if (early < least && late < least) {
    verdict.drift = Drift::still;
    because = fmt::format("less than {:.3g} sigma in both", least);
  } else if (late < std::max(least, kCameToRest * early)) {
    verdict.drift = Drift::annealed;
    because = late < least ? fmt::format("the second half moved less than {:.3g} sigma", least)
                           : fmt::format("the second half moved less than {:g} of the first", kCameToRest);
  } else if (grows) {
    verdict.drift = Drift::drifting;
    because = "s_j^2 grows over the second half";
  } else {
    verdict.drift = Drift::mixing;
    because = "s_j^2 does not grow over the second half";
  }
  verdict.reason = fmt::format(
      "tracers moved {:.3g} sigma relative to each other in cycles {} to {} and {:.3g} sigma in {} to {}; {}",
      early, line.cycle.front(), line.cycle[middle], late, line.cycle[middle], line.cycle[end], because);
  return verdict;
}

}  // namespace twincell::analysis
