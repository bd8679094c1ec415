#include "calibration/drive/drive_fit.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "analysis/statistics/statistics.hpp"
#include "calibration/fit/outliers.hpp"
#include "core/constants.hpp"
#include "core/error.hpp"
#include "core/median.hpp"
#include "imaging/phase/dropped_frame_costs.hpp"
#include "imaging/phase/dropped_frames.hpp"
#include "imaging/stack/repeated_frames.hpp"

namespace twincell::calibration {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::size_t kSearched = 2000;       // samples of the periodogram
constexpr double kSuspiciousHarmonic = 0.01;  // largest p of a second harmonic that is reported

struct Sample {
  double t, z;
  std::size_t frame;
};

/// Fit minus height: with a second harmonic six parameters, without it four.
template <bool kSecond>
struct Motion {
  double t, z;
  template <class T>
  bool operator()(const T* p, T* residual) const {
    const T theta = p[3] * t + p[2];
    residual[0] = p[0] + p[1] * sin(theta) - z;
    if constexpr (kSecond) residual[0] += p[1] * (p[4] * sin(2.0 * theta) + p[5] * cos(2.0 * theta));
    return true;
  }
};

ceres::CostFunction* cost_of(const Sample& s, double middle, bool second) {
  if (second) return new ceres::AutoDiffCostFunction<Motion<true>, 1, 6>(new Motion<true>{s.t - middle, s.z});
  return new ceres::AutoDiffCostFunction<Motion<false>, 1, 4>(new Motion<false>{s.t - middle, s.z});
}

double residual_of(const Sample& s, double middle, bool second, const std::vector<double>& p) {
  double r = 0;
  if (second)
    Motion<true>{s.t - middle, s.z}(p.data(), &r);
  else
    Motion<false>{s.t - middle, s.z}(p.data(), &r);
  return r;
}

/// Heights with outliers clamped, because a periodogram has no robust loss function.
std::vector<Sample> clipped(std::vector<Sample> samples) {
  std::vector<double> z;
  for (const Sample& s : samples) z.push_back(s.z);
  std::sort(z.begin(), z.end());
  const double low = z[z.size() / 10], high = z[z.size() - 1 - z.size() / 10], reach = 0.75 * (high - low);
  const double middle = 0.5 * (low + high);
  for (Sample& s : samples) s.z = std::clamp(s.z, middle - reach, middle + reach);
  return samples;
}

/// Residual sum of squares of the best sine of frequency omega, and its coefficients `c`.
double left_by(const std::vector<Sample>& samples, double omega, Eigen::Vector3d& c) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double zz = 0;
  for (const Sample& s : samples) {
    const Eigen::Vector3d b(1, std::sin(omega * s.t), std::cos(omega * s.t));
    normal += b * b.transpose();
    right += s.z * b;
    zz += s.z * s.z;
  }
  c = normal.ldlt().solve(right);
  return zz - c.dot(right);
}

/// Frequency of the smallest residual in a periodogram of the first kSearched samples, rad per frame
/// interval.
double search_omega(const std::vector<Sample>& all) {
  const std::vector<Sample> samples = clipped(std::vector<Sample>(
      all.begin(), all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), kSearched))));
  const double length = samples.back().t - samples.front().t;
  const double step = 2 * kPi / (6 * length);  // a sixth of the width of a peak
  double best = 0, least = std::numeric_limits<double>::infinity();
  Eigen::Vector3d c;
  // Range: with less than one cycle in the samples a drift looks like a drive; above half a cycle per frame
  // the drive aliases to a lower frequency.
  for (double omega = 2 * kPi / length; omega <= kPi * 0.999; omega += step)
    if (const double left = left_by(samples, omega, c); left < least) least = left, best = omega;
  return best;
}

/// Parameters, with time counted from the middle of the samples.
struct Fitted {
  FitReport report;
  double middle = 0;
  bool second = false;
};

/// Robust start values by Cauchy's loss. The fit begins with the first samples and extends to all, four times
/// as many each round, so that the frequency stays within its minimum.
std::vector<double> robust_start(const std::vector<Sample>& all, double omega, double middle, bool second) {
  std::vector<double> p(second ? 6 : 4, 0.0);
  for (std::size_t n = std::min(all.size(), kSearched);; n = std::min(all.size(), 4 * n)) {
    const std::vector<Sample> part(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(n));
    Eigen::Vector3d c;
    const double now = p[3] > 0 ? p[3] : omega;
    std::vector<Sample> shifted = clipped(part);
    for (Sample& s : shifted) s.t -= middle;
    left_by(shifted, now, c);
    p[0] = c[0], p[1] = std::hypot(c[1], c[2]), p[2] = std::atan2(c[2], c[1]), p[3] = now;
    std::vector<double> r;
    r.reserve(part.size());
    for (const Sample& s : part) r.push_back(residual_of(s, middle, false, p));
    for (int round = 0; round < 3; ++round) {
      const double scale = std::max(robust_spread(r), 1e-9 * std::max(1.0, p[1]));
      ceres::Problem problem;
      for (const Sample& s : part)
        problem.AddResidualBlock(cost_of(s, middle, second), new ceres::CauchyLoss(scale), p.data());
      ceres::Solver::Options options;
      options.linear_solver_type = ceres::DENSE_QR;
      options.logging_type = ceres::SILENT;
      ceres::Solver::Summary summary;
      ceres::Solve(options, &problem, &summary);
      for (std::size_t i = 0; i < part.size(); ++i) r[i] = residual_of(part[i], middle, second, p);
    }
    if (n == all.size()) return p;
  }
}

/// Scatter of the residuals: noise of the heights, plus timing jitter where the plate moves fast.
struct Scatter {
  double still = 0, moving = 0;  // moving: at full speed
  [[nodiscard]] double at(double theta) const { return std::hypot(still, moving * std::cos(theta)); }
};

Scatter scatter_of(const std::vector<Sample>& all, const Fitted& f, const std::vector<double>& p,
                   const std::vector<double>& residuals) {
  // Spreads over the slow and the fast half of the cycle: <cos^2> is 0.1817 in the slow half, 0.8183 in the
  // fast one.
  constexpr double kCos2Slow = 0.1817, kCos2Fast = 0.8183;
  std::vector<double> slow, fast;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double c = std::cos(p[3] * (all[i].t - f.middle) + p[2]);
    (c * c < 0.5 ? slow : fast).push_back(residuals[i]);
  }
  const double floor = 1e-9 * std::max(1.0, std::abs(p[1]));
  if (slow.size() < 10 || fast.size() < 10) return {std::max(robust_spread(residuals), floor), 0};
  const double a = std::pow(robust_spread(slow), 2), b = std::pow(robust_spread(fast), 2);
  const double moving = (b - a) / (kCos2Fast - kCos2Slow), still = a - kCos2Slow * moving;
  if (moving <= 0 || still <= 0) return {std::max(robust_spread(residuals), floor), 0};
  return {std::max(std::sqrt(still), floor), std::sqrt(moving)};
}

/// Fit of all samples: robust start, then least squares with outliers rejected and weights from the scatter.
Fitted fit_motion(const std::vector<Sample>& all, double omega, bool second, std::vector<double>& residuals,
                  Scatter& scatter) {
  Fitted f;
  f.second = second;
  f.middle = 0.5 * (all.front().t + all.back().t);
  std::vector<double> p = robust_start(all, omega, f.middle, second);
  std::vector<std::string> names = {"z0", "A", "phi", "omega"};
  if (second) names.insert(names.end(), {"h_s", "h_c"});
  residuals.assign(all.size(), 0);
  for (int round = 0; round < 3; ++round) {
    for (std::size_t i = 0; i < all.size(); ++i) residuals[i] = residual_of(all[i], f.middle, second, p);
    scatter = scatter_of(all, f, p, residuals);
    const double usual = std::hypot(scatter.still, scatter.moving);
    ceres::Problem problem;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double s = scatter.at(p[3] * (all[i].t - f.middle) + p[2]);
      if (std::abs(residuals[i]) > kWorstSigma * s) continue;
      // The weights are relative; the residuals set the scale of the errors.
      problem.AddResidualBlock(
          cost_of(all[i], f.middle, second),
          scatter.moving > 0 ? new ceres::ScaledLoss(nullptr, std::pow(usual / s, 2), ceres::TAKE_OWNERSHIP)
                             : nullptr,
          p.data());
    }
    f.report = solve(problem, p.data(), names);
    p = f.report.values;
  }
  if (p[1] < 0) {
    p[1] = -p[1];
    p[2] += kPi;
  }
  for (std::size_t i = 0; i < all.size(); ++i) residuals[i] = residual_of(all[i], f.middle, second, p);
  f.report.values = p;
  return f;
}

/// Fit to one assignment of times to the frames, and the frames that do not follow it.
struct Attempt {
  Fitted fitted;
  std::vector<Sample> samples;
  std::vector<double> residuals;
  Scatter scatter;
  std::size_t off = 0, longest_run = 0;
  [[nodiscard]] bool follows(std::size_t i, double model_error = 0) const {
    const std::vector<double>& p = fitted.report.values;
    const double s = scatter.at(p[3] * (samples[i].t - fitted.middle) + p[2]);
    return std::abs(residuals[i]) <= kWorstSigma * std::hypot(s, model_error);
  }
};

Attempt attempt(std::vector<Sample> samples, double omega) {
  Attempt a;
  a.samples = std::move(samples);
  // Four or fewer phases per cycle do not determine a second harmonic.
  const bool second = omega < 2 * kPi / 4.5 && a.samples.size() >= 12;
  a.fitted = fit_motion(a.samples, omega, second, a.residuals, a.scatter);
  if (second && a.fitted.report.standard_errors.empty())
    a.fitted = fit_motion(a.samples, omega, false, a.residuals, a.scatter);
  std::size_t run = 0;
  for (std::size_t i = 0; i < a.residuals.size(); ++i) {
    const bool off = !a.follows(i);
    a.off += off ? 1 : 0;
    run = off ? run + 1 : 0;
    a.longest_run = std::max(a.longest_run, run);
  }
  return a;
}

std::vector<Sample> samples_of(const std::vector<double>& heights, const std::vector<double>& ticks) {
  std::vector<Sample> samples;
  for (std::size_t f = 0; f < heights.size(); ++f)
    if (std::isfinite(heights[f])) samples.push_back({ticks[f], heights[f], f});
  return samples;
}

/// Power of the residuals at the drive's third and higher harmonics, relative to white noise; at least 1.
/// Errors that recur every cycle are not noise: beads that hide the plate at the same phase of each cycle
/// cause them, and no number of cycles averages them away. \param harmonics set to the number of harmonics
/// used
double cyclic_factor(const Attempt& a, int& harmonics) {
  constexpr int kFirstHarmonic = 3, kLastHarmonic = 10;
  const std::vector<double>& p = a.fitted.report.values;
  const int last = std::min(kLastHarmonic, static_cast<int>(std::ceil(kPi / p[3] - 1e-6)) - 1);
  harmonics = std::max(0, last - kFirstHarmonic + 1);
  if (harmonics == 0) return 1;
  double power = 0, squares = 0;
  for (int m = kFirstHarmonic; m <= last; ++m) {
    double s = 0, c = 0;
    for (std::size_t i = 0; i < a.samples.size(); ++i) {
      if (!a.follows(i)) continue;
      const double theta = p[3] * (a.samples[i].t - a.fitted.middle) + p[2];
      s += a.residuals[i] * std::sin(m * theta);
      c += a.residuals[i] * std::cos(m * theta);
    }
    power += s * s + c * c;
  }
  for (std::size_t i = 0; i < a.samples.size(); ++i)
    if (a.follows(i)) squares += a.residuals[i] * a.residuals[i];
  return squares > 0 ? std::max(1.0, power / (harmonics * squares)) : 1;
}

void add_jitter(DriveFit& lock, const Attempt& a) {
  // E r^2 = s_z^2 + (A omega cos theta)^2 s_t^2: a straight line whose slope is the variance of the exposure
  // times.
  const double v = lock.amplitude * lock.omega;
  std::vector<double> x, y;
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    if (lock.frames[a.samples[i].frame].lock != FrameLock::locked) continue;
    const double c = std::cos(2 * kPi * lock.frames[a.samples[i].frame].cycles);
    x.push_back(v * v * c * c);
    y.push_back(a.residuals[i] * a.residuals[i]);
  }
  const auto n = static_cast<double>(x.size());
  double mx = 0, my = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) mx += x[i] / n, my += y[i] / n;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mx) * (x[i] - mx);
    xy += (x[i] - mx) * (y[i] - my);
  }
  if (!(xx > 0) || n < 10) return;
  const double variance = xy / xx;
  double e = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double r = y[i] - my - variance * (x[i] - mx);
    e += (x[i] - mx) * (x[i] - mx) * r * r;
  }
  const double error = std::sqrt(e) / xx;
  lock.jitter_limit = std::sqrt(std::max(0.0, variance) + 1.645 * error);
  if (variance > 2 * error) {
    lock.jitter = std::sqrt(variance);
    lock.jitter_error = error / (2 * *lock.jitter);
  }
}

void add_phases(DriveFit& lock, std::size_t n_frames) {
  lock.period = 2 * kPi / lock.omega;
  lock.period_error = lock.period * lock.omega_error / lock.omega;
  const double n = std::round(lock.period),
               drift = std::abs(1 / lock.period - 1 / n) * n * static_cast<double>(n_frames);
  const double fraction = lock.phi / (2 * kPi);
  if (n >= 2 && drift < 0.25) {
    lock.frames_per_cycle = static_cast<int>(n);
    // Evaluate the phase at the middle of the stack, where its error is smallest.
    const double half = 0.5 * static_cast<double>(n_frames - 1);
    const double at = fraction * n + half * (n / lock.period - 1);
    const double whole = std::round(at);
    lock.first_phase = static_cast<int>(
        ((static_cast<long>(whole) % lock.frames_per_cycle) + lock.frames_per_cycle) % lock.frames_per_cycle);
    lock.phase_offset = at - whole;
  } else {
    lock.notes.push_back(fmt::format(
        "the period of {:.5g} frames is not a whole number: phases drift by {:.2g} frames over the "
        "stack. calibrate plate --phases LIST.csv writes them for track --phase-lock LIST.csv",
        lock.period, drift));
  }
}

/// The accepted attempt, with the time of each frame in frame intervals from which it was made.
struct Timed {
  Attempt attempt;
  std::vector<double> ticks;
};

double followed_share(const Attempt& a) {
  return 1 - static_cast<double>(a.off) / static_cast<double>(a.samples.size());
}

/// If frames are missing, the fit scatters, but no single frame counts as out of lock. \param share of A
bool scatters(const Attempt& a, double share) {
  return a.scatter.at(0) > share * a.fitted.report.values[1];
}

/// Residuals of missing frames persist from frame to frame; those of jitter do not.
bool residuals_persist(const Attempt& a) {
  constexpr double kMinCorrelation = 0.5;  // of consecutive residuals
  double own = 0, next = 0;
  for (std::size_t i = 0; i < a.residuals.size(); ++i) {
    own += a.residuals[i] * a.residuals[i];
    if (i > 0) next += a.residuals[i] * a.residuals[i - 1];
  }
  return next > kMinCorrelation * own;
}

/// Fits with the frames as they are, one interval apart.
Timed first_attempt(const std::vector<double>& heights, int frames_per_cycle) {
  constexpr std::size_t kMinFrames = 8;
  Timed out;
  for (std::size_t f = 0; f < heights.size(); ++f) out.ticks.push_back(static_cast<double>(f));
  std::vector<Sample> samples = samples_of(heights, out.ticks);
  if (samples.size() < kMinFrames)
    throw InputError(
        {}, fmt::format("the plate is seen in {} of {} frames; at least {} are needed for amplitude, period "
                        "and phase.",
                        samples.size(), heights.size(), kMinFrames));
  const double omega = frames_per_cycle > 0 ? 2 * kPi / frames_per_cycle : search_omega(samples);
  out.attempt = attempt(std::move(samples), omega);
  return out;
}

/// Whether frames are lost or doubled in nearly every cycle, at the same phase or in more than one place: a
/// cycle of another length then passes for the real one, as where the plate is not seen at its lowest. One
/// gap is one place, however long.
bool slips_in_each_cycle(const imaging::SineSlips& slips, int frames_per_cycle) {
  constexpr double kMinPerCycle = 0.7, kSeveralPerCycle = 1.5;  // places per cycle
  constexpr double kMinCoherence = 0.95;  // length of the mean of exp(i phase) over the places
  std::complex<double> sum = 0;
  double places = 0;
  for (std::size_t i = 1; i < slips.ticks.size(); ++i)
    if (slips.ticks[i] - slips.ticks[i - 1] != 1) {
      sum += std::polar(1.0, 2 * kPi * static_cast<double>(slips.ticks[i]) / frames_per_cycle);
      ++places;
    }
  const double cycles = static_cast<double>(slips.ticks.back() - slips.ticks.front()) / frames_per_cycle;
  if (places < kMinPerCycle * cycles) return false;
  return places >= kSeveralPerCycle * cycles || std::abs(sum) > kMinCoherence * places;
}

/// A fit with the frames that it takes for missing or doubled.
struct Mended {
  Timed timed;
  std::int64_t dropped = 0, doubled = 0;
  double slip_cost = 0;  ///< negative log-odds of these
};

double cost_of_slips(const std::vector<std::int64_t>& ticks) {
  double cost = 0;
  for (std::size_t f = 1; f < ticks.size(); ++f)
    if (const std::int64_t by = ticks[f] - ticks[f - 1]; by != 1)
      cost += imaging::kSlipCost +
              imaging::kFurtherDropCost * static_cast<double>(std::max<std::int64_t>(by - 2, 0));
  return cost;
}

/// Negative log-likelihood of the heights where they scatter by `scatter`.
double unlikelihood(const Mended& m, double scatter) {
  double cost = m.slip_cost;
  for (const double r : m.timed.attempt.residuals)
    cost += std::min(0.5 * (r / scatter) * (r / scatter), imaging::kMaxFrameCost);
  return cost;
}

/// Repairs dropped and doubled frames: for each number of frames per cycle, finds the best path of phases and
/// fits again. The likeliest of these fits and the one without repair is kept, with the scatter of the
/// quietest one for all: a wrong number of frames per cycle follows the heights as well, by a slip per cycle.
void repair_frames(const std::vector<double>& heights, int frames_per_cycle, Timed& now, DriveFit& lock) {
  const double period = 2 * kPi / now.attempt.fitted.report.values[3];
  std::vector<Mended> all = {{.timed = std::move(now)}};
  for (const int n : imaging::frames_per_cycle_to_try(frames_per_cycle, period)) {
    const std::optional<imaging::SineSlips> slips = imaging::fit_sine_with_slips(heights, n);
    if (!slips || slips->dropped + slips->doubled == 0) continue;
    if (frames_per_cycle == 0 && slips_in_each_cycle(*slips, n)) continue;
    std::vector<double> mended(slips->ticks.begin(), slips->ticks.end());
    Attempt b = attempt(samples_of(heights, mended), 2 * kPi / n);
    all.push_back({.timed = {std::move(b), std::move(mended)},
                   .dropped = slips->dropped,
                   .doubled = slips->doubled,
                   .slip_cost = cost_of_slips(slips->ticks)});
  }
  double scatter = std::numeric_limits<double>::infinity();
  for (const Mended& m : all)
    scatter = std::min(scatter, std::max(m.timed.attempt.scatter.at(0),
                                         imaging::kMinScatter * m.timed.attempt.fitted.report.values[1]));
  Mended& best = *std::min_element(all.begin(), all.end(), [&](const Mended& a, const Mended& b) {
    return unlikelihood(a, scatter) < unlikelihood(b, scatter);
  });
  now = std::move(best.timed);
  lock.dropped = best.dropped;
  lock.doubled = best.doubled;
  constexpr double kMaxScatter = 0.05;  // fraction of A
  if (scatters(now.attempt, kMaxScatter))
    lock.notes.push_back(fmt::format(
        "the heights scatter by {:.2g} of A about a sine: frames may be missing, or the drive "
        "changes{}",
        now.attempt.scatter.at(0) / now.attempt.fitted.report.values[1],
        frames_per_cycle > 0 ? ""
                             : "; calibrate plate takes --frames-per-cycle, which shows missing frames"));
}

/// Parameters with their errors, the phase for the first frame.
/// \param angle model error of the phase and of a harmonic, rad
void add_parameters(DriveFit& lock, const Timed& timed, double model_error, double angle) {
  const FitReport& report = timed.attempt.fitted.report;
  const double cyclic = std::sqrt(lock.cyclic_factor);
  const double t0 = timed.ticks.front() - timed.attempt.fitted.middle;
  lock.phi = std::remainder(report.values[2] + lock.omega * t0, 2 * kPi);
  lock.z0_error = std::hypot(cyclic * report.standard_error("z0"), model_error);
  lock.amplitude_error = std::hypot(cyclic * report.standard_error("A"), model_error);
  // Over few cycles a recurring error also looks like a drift of the phase: eps sin(omega t) regressed on A t
  // cos(omega t) over a time T gives at most 6 eps/(A omega T^2).
  const double turned = lock.omega * (timed.ticks.back() - timed.ticks.front());
  lock.omega_error = std::hypot(report.standard_error("omega"), lock.omega * angle * 6 / (turned * turned));
  if (report.covariance.size() > 0)
    lock.phi_error = std::sqrt(angle * angle + lock.cyclic_factor * report.covariance(2, 2) +
                               t0 * t0 * report.covariance(3, 3) + 2 * t0 * report.covariance(2, 3));
}

/// \param stated frames per cycle at which the fit began; 0: none
void require_motion(const DriveFit& lock, const Attempt& a, const std::vector<double>& heights, int stated) {
  const auto moves = [](double amplitude, double error, double scatter) {
    return amplitude > 5 * error && scatter < amplitude;
  };
  if (moves(lock.amplitude, lock.amplitude_error, a.scatter.at(0))) return;
  // A plate that moves with another period is off a sine of the stated one.
  if (stated > 0) {
    const Attempt free = first_attempt(heights, 0).attempt;
    const FitReport& report = free.fitted.report;
    const double period = 2 * kPi / report.values[3];
    if (report.standard_errors.size() > 0 &&
        moves(report.values[1], report.standard_error("A"), free.scatter.at(0)))
      throw InputError(
          {.file = {}, .key = "plate"},
          fmt::format(
              "moves by {:.3g} about its mean height with a period of {:.4g} frames, but {} frames per "
              "cycle are stated; correct camera.frames_per_cycle or --frames-per-cycle{}.",
              report.values[1], period, stated,
              std::abs(period - std::round(period)) * static_cast<double>(heights.size()) > 0.5 * period
                  ? ", or state none, as this period is not a whole number"
                  : ""));
  }
  throw InputError(
      {.file = {}, .key = "plate"},
      fmt::format("does not move by more than the scatter of its heights: amplitude {:.3g}, error {:.2g}, "
                  "scatter {:.2g}.",
                  lock.amplitude, lock.amplitude_error, a.scatter.at(0)));
}

/// Second harmonic, and the probability of one as large under a pure sine, from Fisher's F distribution.
/// \param harmonics number of harmonics from which the factor of recurring errors was estimated
void add_second_harmonic(DriveFit& lock, const Attempt& a, int harmonics, double angle) {
  const FitReport& report = a.fitted.report;
  if (!a.fitted.second || report.covariance.size() == 0) {
    lock.notes.emplace_back("too few phases per cycle to determine a second harmonic");
    return;
  }
  const Eigen::Vector2d h(report.values[4], report.values[5]);
  const Eigen::Matrix2d c =
      lock.cyclic_factor * report.covariance.block<2, 2>(4, 4) + angle * angle * Eigen::Matrix2d::Identity();
  lock.second_harmonic = h.norm();
  lock.second_harmonic_error = std::sqrt(c.trace() / 2);
  const double turn = std::atan2(h.y(), h.x()) / (2 * kPi);
  lock.second_harmonic_phase = turn - std::floor(turn);
  const double freedom =
      lock.cyclic_factor > 1 ? std::min(2.0 * harmonics, report.n_residuals - 6.0) : report.n_residuals - 6.0;
  const double f = h.dot(c.ldlt().solve(h)) / 2;
  if (freedom > 0)
    lock.p_sinusoidal = boost::math::cdf(boost::math::complement(boost::math::fisher_f(2, freedom), f));
  if (lock.p_sinusoidal && *lock.p_sinusoidal < kSuspiciousHarmonic)
    lock.notes.push_back(
        fmt::format("the drive is not a pure sine: second harmonic {:.2g} +- {:.1g} of A (p = {:.1g})",
                    *lock.second_harmonic, *lock.second_harmonic_error, *lock.p_sinusoidal));
}

/// Finds the stretches out of lock, and says how many frames do not follow the fit.
void add_stretches(DriveFit& lock) {
  constexpr double kMaxShareOffFit = 0.03;  // of the frames
  std::vector<double> misses;
  for (const LockedFrame& frame : lock.frames)
    misses.push_back(frame.lock == FrameLock::unseen ? kNaN : frame.lock == FrameLock::locked ? 0 : 2);
  lock.out_of_lock_stretches = imaging::stretches_out_of_lock(misses, 2 * kPi / lock.omega);
  const std::size_t n = lock.frames.size(), without = imaging::frames_in(lock.out_of_lock_stretches);
  std::size_t single = 0;
  for (std::size_t f = 0; f < n; ++f)
    single += lock.frames[f].lock == FrameLock::out_of_lock && lock.has_phase(f) ? 1 : 0;
  if (without > 0)
    lock.notes.push_back(
        fmt::format("the plate does not follow the drive in {} of {} frames ({}), as before the shaker "
                    "starts or after it stops: they have no phase, and track leaves them out",
                    without, n, imaging::in_words(lock.out_of_lock_stretches)));
  if (static_cast<double>(single) > kMaxShareOffFit * static_cast<double>(n))
    lock.notes.push_back(fmt::format(
        "the plate is off the fit in {} {} of {} frames: its edge is misread there, or the drive is not "
        "steady",
        single, without > 0 ? "further" : "single", n));
}

/// Phase and lock of every frame, and the rms residual of those that are locked.
void add_frames(DriveFit& lock, const Timed& timed, double model_error) {
  const Attempt& a = timed.attempt;
  const std::vector<double>& ticks = timed.ticks;
  lock.frames.resize(ticks.size());
  for (std::size_t f = 0; f < ticks.size(); ++f) {
    lock.frames[f].tick = ticks[f];
    lock.frames[f].cycles = (lock.phi + lock.omega * (ticks[f] - ticks.front())) / (2 * kPi);
    lock.frames[f].residual = kNaN;
  }
  double squares = 0;
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    LockedFrame& frame = lock.frames[a.samples[i].frame];
    frame.residual = -a.residuals[i];  // the cost function has the opposite sign
    frame.lock = a.follows(i, 2 * model_error) ? FrameLock::locked : FrameLock::out_of_lock;
    if (frame.lock == FrameLock::locked)
      squares += a.residuals[i] * a.residuals[i], ++lock.locked;
    else
      ++lock.out_of_lock;
  }
  lock.unseen = static_cast<std::int64_t>(ticks.size() - a.samples.size());
  lock.rms = std::sqrt(squares / static_cast<double>(std::max<std::int64_t>(1, lock.locked)));
}

}  // namespace

bool DriveFit::has_phase(std::size_t frame) const {
  return std::none_of(out_of_lock_stretches.begin(), out_of_lock_stretches.end(),
                      [&](const auto& s) { return s.first <= frame && frame <= s.last; });
}

namespace {

/// fit_drive() without the frames that are repeated, and without the stretches out of lock.
DriveFit fit_each(const std::vector<double>& heights, const DriveFitOptions& options) {
  constexpr double kMinFollowedShare = 0.97;  // of the frames, by a fit without missing frames
  // Consecutive frames that suggest missing ones: off the fit they may cost more than a slip.
  constexpr std::size_t kMinRunOffFit = 2;
  static_assert(kMinRunOffFit * imaging::kMaxFrameCost > imaging::kSlipCost);
  DriveFit lock;
  Timed timed = first_attempt(heights, options.frames_per_cycle);
  const Attempt& a = timed.attempt;
  constexpr double kMinPersistentScatter = 0.01;  // fraction of A
  if (options.mend &&
      (options.frames_per_cycle > 0 || followed_share(a) < kMinFollowedShare ||
       a.longest_run >= kMinRunOffFit || (scatters(a, kMinPersistentScatter) && residuals_persist(a))))
    repair_frames(heights, options.frames_per_cycle, timed, lock);

  const FitReport& report = a.fitted.report;
  lock.fit = report;
  lock.z0 = report.values[0];
  lock.amplitude = report.values[1];
  lock.omega = report.values[3];
  // Errors include recurring residuals and the model error.
  int harmonics = 0;
  lock.cyclic_factor = cyclic_factor(a, harmonics);
  const double angle = options.model_error / lock.amplitude;
  add_parameters(lock, timed, options.model_error, angle);
  require_motion(lock, a, heights, options.frames_per_cycle);
  add_second_harmonic(lock, a, harmonics, angle);
  add_frames(lock, timed, options.model_error);
  add_phases(lock, static_cast<std::size_t>(std::lround(timed.ticks.back() - timed.ticks.front())) + 1);
  // The offset refers to the middle of the stack, so it uses the error of the phase there.
  if (lock.frames_per_cycle > 0)
    lock.phase_offset_error =
        std::hypot(angle, std::sqrt(lock.cyclic_factor) * report.standard_error("phi")) *
        lock.frames_per_cycle / (2 * kPi);
  add_jitter(lock, a);
  return lock;
}

/// Gives repeated frames the phases of the frames before them.
void add_repeats(DriveFit& lock, const std::vector<std::uint8_t>& repeats) {
  std::vector<LockedFrame> each = std::move(lock.frames);
  lock.frames.clear();
  for (std::size_t f = 0, next = 0; f < repeats.size(); ++f) {
    lock.frames.push_back(repeats[f] != 0 ? lock.frames.back() : each[next++]);
    lock.doubled += repeats[f];
  }
  lock.notes.insert(lock.notes.begin(),
                    imaging::repeats_in_words(repeats) + "; here each instant counts once");
}

}  // namespace

DriveFit fit_drive(const std::vector<double>& heights, const DriveFitOptions& options) {
  if (options.repeats.size() != heights.size()) {
    DriveFit lock = fit_each(heights, options);
    add_stretches(lock);
    return lock;
  }
  std::vector<double> each;
  for (std::size_t f = 0; f < heights.size(); ++f)
    if (options.repeats[f] == 0) each.push_back(heights[f]);
  DriveFit lock = fit_each(each, options);
  add_repeats(lock, options.repeats);
  add_stretches(lock);
  return lock;
}

}  // namespace twincell::calibration
