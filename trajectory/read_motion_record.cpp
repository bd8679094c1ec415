#include "trajectory/read_motion_record.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <system_error>
#include <utility>

#include "core/plural.hpp"
#include "core/sha256.hpp"
#include "core/table.hpp"

namespace twincell {

namespace {

constexpr std::uintmax_t kLargestFile = std::uintmax_t{256} << 20;
constexpr std::size_t kMinRows = 8;
constexpr double kMinPerCycle = 8, kMinCycles = 2;
/// Largest departure of a time from equal steps, in steps. Loggers round times to a few digits.
constexpr double kJitter = 0.1;

/// A column that a record may have: values in `unit` SI units, or in reduced units if `of` is absent.
struct Column {
  const char* name;
  int derivative;
  double unit;
  std::optional<double> (*of)(const Scale&);  ///< laboratory value of the reduced unit
  const char* needs;                          ///< keys of the scale
};

std::optional<double> length(const Scale& s) {
  return s.sigma_m;
}
std::optional<double> duration(const Scale& s) {
  return s.t0_s();
}
std::optional<double> speed(const Scale& s) {
  return s.v0_m_s();
}
std::optional<double> gravity(const Scale& s) {
  return s.gravity_m_s2;
}

constexpr const char* kBoth = "scale.sigma_mm and scale.gravity_m_s2";
constexpr Column kTimes[] = {
    {"time_s", 0, 1, duration, kBoth}, {"time_ms", 0, 1e-3, duration, kBoth}, {"time_t0", 0, 1, nullptr, ""}};
constexpr Column kMotions[] = {{"position_mm", 0, 1e-3, length, "scale.sigma_mm"},
                               {"position_m", 0, 1, length, "scale.sigma_mm"},
                               {"position_sigma", 0, 1, nullptr, ""},
                               {"velocity_mm_s", 1, 1e-3, speed, kBoth},
                               {"velocity_m_s", 1, 1, speed, kBoth},
                               {"velocity_v0", 1, 1, nullptr, ""},
                               {"acceleration_m_s2", 2, 1, gravity, "scale.gravity_m_s2"},
                               {"acceleration_g", 2, 1, nullptr, ""}};

struct Found {
  const Column* column;
  std::vector<double> values;  ///< reduced
};

/// The one column of the table that is among `known`. \throws InputError if there is none or more than one
template <std::size_t N>
Found find(const Table& table, const Column (&known)[N], const char* what, const Scale& scale,
           const Where& where) {
  std::vector<std::string> names, present;
  const Column* column = nullptr;
  for (const Column& c : known) {
    names.emplace_back(c.name);
    if (std::ranges::find(table.names, c.name) == table.names.end()) continue;
    present.emplace_back(c.name);
    column = &c;
  }
  if (present.size() != 1)
    throw InputError({.file = table.file, .key = {}},
                     present.empty()
                         ? fmt::format("has no column of {}: one of {} is needed, the columns are {}.", what,
                                       fmt::join(names, ", "), fmt::join(table.names, ", "))
                         : fmt::format("has {} columns of {}, {}; keep one.", present.size(), what,
                                       fmt::join(present, ", ")));
  const std::optional<double> one = column->of == nullptr ? 1.0 : column->of(scale);
  if (!one)
    throw ConfigError(where, fmt::format("the column {} of {} needs {} to be converted.", column->name,
                                         table.file, column->needs));
  Found found{column, table.column(column->name)};
  for (std::size_t i = 0; i < found.values.size(); ++i) {
    if (std::isnan(found.values[i]))
      throw InputError({.file = table.file, .key = column->name},
                       fmt::format("row {} has no number.", i + 1));
    found.values[i] *= column->unit / *one;
  }
  return found;
}

/// The step of times that ascend in equal steps. \throws InputError for other times
double step_of(const std::vector<double>& t, const Where& where) {
  const std::size_t n = t.size();
  std::vector<double> steps;
  for (std::size_t i = 1; i < n; ++i) {
    steps.push_back(t[i] - t[i - 1]);
    if (!(steps.back() > 0))
      throw InputError(where, fmt::format("row {} is not later than the row before it.", i + 1));
  }
  const double step = (t[n - 1] - t[0]) / static_cast<double>(n - 1);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::vector<double> sorted = steps;
  std::nth_element(sorted.begin(), sorted.begin() + (middle - steps.begin()), sorted.end());
  const double usual = sorted[steps.size() / 2];
  const auto longest = std::ranges::max_element(steps);
  if (*longest > 1.5 * usual)
    throw InputError(where,
                     fmt::format("rows are missing: row {} follows {:.3g} usual steps after row {}.",
                                 longest - steps.begin() + 2, *longest / usual, longest - steps.begin() + 1));
  for (std::size_t i = 0; i < n; ++i)
    if (const double off = std::abs(t[i] - t[0] - static_cast<double>(i) * step) / step; !(off <= kJitter))
      throw InputError(where,
                       fmt::format("row {} departs by {:.2g} steps from equal steps, the bound is {:g}; "
                                   "resample the record.",
                                   i + 1, off, kJitter));
  return step;
}

/// Slopes of the cubic spline through values at unit steps, with continuous third derivatives at the second
/// and at the last but one value.
std::vector<double> spline_slopes(const std::vector<double>& y) {
  const std::size_t n = y.size();
  std::vector<double> upper(n), slope(n);
  upper[0] = 2;
  slope[0] = (-5 * y[0] + 4 * y[1] + y[2]) / 2;
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double pivot = 4 - upper[i - 1];
    upper[i] = 1 / pivot;
    slope[i] = (3 * (y[i + 1] - y[i - 1]) - slope[i - 1]) / pivot;
  }
  slope[n - 1] = ((5 * y[n - 1] - 4 * y[n - 2] - y[n - 3]) / 2 - 2 * slope[n - 2]) / (1 - 2 * upper[n - 2]);
  for (std::size_t i = n - 1; i-- > 0;) slope[i] -= upper[i] * slope[i + 1];
  return slope;
}

/// The same of values that repeat, which are continued on both sides: the slope at a value depends on the
/// k-th value beside it as 0.27^k.
std::vector<double> periodic_slopes(const std::vector<double>& y) {
  constexpr std::size_t kSamplesBeside = 40;
  const std::size_t n = y.size();
  std::vector<double> longer(n + 2 * kSamplesBeside);
  for (std::size_t i = 0; i < longer.size(); ++i)
    longer[i] = y[(i + n * kSamplesBeside - kSamplesBeside) % n];
  const std::vector<double> slopes = spline_slopes(longer);
  return {slopes.begin() + kSamplesBeside, slopes.end() - kSamplesBeside};
}

/// Samples of the motion that starts at height 0 (and, of accelerations, at rest), with the values as they
/// are.
std::vector<MotionSample> integrated(const std::vector<double>& y, const std::vector<double>& slopes,
                                     int derivative, double h) {
  std::vector<MotionSample> samples(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    MotionSample& s = samples[i];
    // Differences to a neighbour; the spline's curvature is the same from both sides.
    const bool last = i + 1 == y.size();
    const std::size_t k = last ? i - 1 : i;
    const double rise = y[k + 1] - y[k];
    const double bend =
        last ? -6 * rise + 2 * slopes[k] + 4 * slopes[i] : 6 * rise - 4 * slopes[i] - 2 * slopes[k + 1];
    if (derivative == 0) s = {y[i], slopes[i] / h, bend / (h * h)};
    if (derivative == 1) s = {0, y[i], slopes[i] / h};
    if (derivative == 2) s = {0, 0, y[i]};
    if (derivative == 0 || i == 0) continue;
    // Integrals of the cubic polynomial over the step before.
    const MotionSample& before = samples[i - 1];
    const double mean = (y[i - 1] + y[i]) / 2 + (slopes[i - 1] - slopes[i]) / 12;
    if (derivative == 1) s.z = before.z + h * mean;
    if (derivative == 1) continue;
    s.v = before.v + h * mean;
    s.z = before.z + h * before.v +
          h * h * ((7 * y[i - 1] + 3 * y[i]) / 20 + (3 * slopes[i - 1] - 2 * slopes[i]) / 60);
  }
  return samples;
}

double mean_of(const std::vector<double>& y) {
  double sum = 0;
  for (const double value : y) sum += value;
  return sum / static_cast<double>(y.size());
}

/// c cos(omega t) + s sin(omega t)
struct Component {
  double c = 0, s = 0;
};

/// Fits a polynomial and a sine to the displacements and subtracts the polynomial.
Component remove_trend(std::vector<MotionSample>& samples, int degree, double h, double omega) {
  const auto n = static_cast<double>(samples.size());
  const double half = (n - 1) * h / 2;
  constexpr int kMaxTerms = 5;  // cosine, sine and a parabola
  const auto terms = [&](double i) {
    const double t = i * h, s = t / half - 1;
    Eigen::Matrix<double, kMaxTerms, 1> row = Eigen::Matrix<double, kMaxTerms, 1>::Zero();
    row[0] = std::cos(omega * t), row[1] = std::sin(omega * t);
    for (int k = 0; k <= degree; ++k) row[2 + k] = std::pow(s, k);
    return row;
  };
  Eigen::Matrix<double, kMaxTerms, kMaxTerms> normal = Eigen::Matrix<double, kMaxTerms, kMaxTerms>::Zero();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto row = terms(static_cast<double>(i));
    normal += row * row.transpose();
  }
  for (int k = 3 + degree; k < kMaxTerms; ++k) normal(k, k) = 1;
  const Eigen::LDLT<Eigen::Matrix<double, kMaxTerms, kMaxTerms>> solver(normal);
  Component sine;
  // The second round removes what rounding left of a large trend in the first.
  for (int round = 0; round < 2; ++round) {
    Eigen::Matrix<double, kMaxTerms, 1> right = Eigen::Matrix<double, kMaxTerms, 1>::Zero();
    for (std::size_t i = 0; i < samples.size(); ++i) right += samples[i].z * terms(static_cast<double>(i));
    const Eigen::Matrix<double, kMaxTerms, 1> p = solver.solve(right);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double s = static_cast<double>(i) * h / half - 1;
      samples[i].z -= p[2] + s * (p[3] + s * p[4]);
      samples[i].v -= (p[3] + 2 * s * p[4]) / half;
      samples[i].a -= 2 * p[4] / (half * half);
    }
    sine = {p[0], p[1]};
  }
  return sine;
}

/// Closes the motion of a repeated record, whose sample after the last is given too and removed, and shifts
/// its mean to 0.
Component close(std::vector<MotionSample>& samples, double h, double omega) {
  const double drift = samples.back().z - samples.front().z;
  samples.pop_back();
  const auto n = static_cast<double>(samples.size());
  double mean = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].z -= drift * static_cast<double>(i) / n;
    samples[i].v -= drift / (n * h);
    mean += samples[i].z / n;
  }
  Component sine;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].z -= mean;
    const double angle = omega * h * static_cast<double>(i);
    sine.c += 2 / n * samples[i].z * std::cos(angle);
    sine.s += 2 / n * samples[i].z * std::sin(angle);
  }
  return sine;
}

/// Solves (1 + lambda D'D) y = x, D the second differences, for one lambda and several x.
class Whittaker {
 public:
  Whittaker(std::size_t n, double lambda) {
    constexpr int kTerms = 3;
    constexpr double kSecond[kTerms] = {1, -2, 1};
    std::vector<Eigen::Triplet<double>> entries;
    const int size = static_cast<int>(n);
    entries.reserve(n + n * (kTerms * (kTerms + 1) / 2));
    for (int i = 0; i < size; ++i) entries.emplace_back(i, i, 1);
    for (int k = 0; k + kTerms <= size; ++k)
      for (int i = 0; i < kTerms; ++i)
        for (int j = 0; j <= i; ++j) entries.emplace_back(k + i, k + j, lambda * kSecond[i] * kSecond[j]);
    Eigen::SparseMatrix<double> matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    solver_.compute(matrix);
  }
  [[nodiscard]] Eigen::VectorXd operator()(const Eigen::VectorXd& x) const { return solver_.solve(x); }

 private:
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> solver_;
};

void require_closed(const MotionRecord& record) {
  constexpr double kLargestJump = 3;
  const std::vector<double>& y = record.values;
  double usual = 0;
  for (std::size_t i = 1; i < y.size(); ++i) usual = std::max(usual, std::abs(y[i] - y[i - 1]));
  if (const double jump = std::abs(y.front() - y.back()); jump > kLargestJump * usual)
    throw InputError(
        {.file = record.file, .key = {}},
        fmt::format("cannot be repeated: from the last value to the first it jumps by {:.3g}, elsewhere by "
                    "{:.3g} at most (reduced units).",
                    jump, usual));
}

}  // namespace

MotionRecord read_motion_record(const std::filesystem::path& path, const Scale& scale, const Where& where) {
  std::error_code ec;
  if (const auto size = std::filesystem::file_size(path, ec); !ec && size > kLargestFile)
    throw InputError({.file = path.string(), .key = {}},
                     fmt::format("is {} MB large, the bound is {} MB.", size >> 20, kLargestFile >> 20));
  const Table table = read_table(path);
  if (table.n_rows() < kMinRows || table.n_rows() > kMaxSamples)
    throw InputError({.file = table.file, .key = {}},
                     fmt::format("has {}; a recorded motion has at least {} and at most {}.",
                                 plural(table.n_rows(), "row"), kMinRows, kMaxSamples));
  const Found time = find(table, kTimes, "times", scale, where);
  Found motion = find(table, kMotions, "the motion", scale, where);
  return {.file = table.file,
          .sha256 = sha256_of(path),
          .column = motion.column->name,
          .derivative = motion.column->derivative,
          .interval = step_of(time.values, {.file = table.file, .key = time.column->name}),
          .values = std::move(motion.values)};
}

MotionRecord smoothed(MotionRecord record, double cutoff, bool repeats) {
  const std::size_t n = record.values.size();
  const double at_cutoff = 2 * std::sin(std::numbers::pi * cutoff * record.interval);
  // Beyond its ends a repeated record is continued by ten periods of the cutoff, of which the filter forgets
  // nearly all.
  constexpr double kForgotten = 10;
  const std::size_t beside =
      repeats ? static_cast<std::size_t>(std::ceil(kForgotten / (cutoff * record.interval))) : 0;
  const std::size_t offset = (n - beside % n) % n;
  Eigen::VectorXd x(static_cast<Eigen::Index>(n + 2 * beside));
  for (std::size_t i = 0; i < n + 2 * beside; ++i)
    x[static_cast<Eigen::Index>(i)] = record.values[(i + offset) % n];
  const Whittaker filter(n + 2 * beside, 1 / std::pow(at_cutoff, 4));
  Eigen::VectorXd y = filter(x);
  y += filter(x - y);
  for (std::size_t i = 0; i < n; ++i) record.values[i] = y[static_cast<Eigen::Index>(i + beside)];
  return record;
}

FittedMotion fit_motion(const MotionRecord& record, double omega, int cycles) {
  const double h = record.interval, period = 2 * std::numbers::pi / omega;
  const auto refuse = [&](const std::string& complaint) {
    throw InputError({.file = record.file, .key = {}}, complaint);
  };
  if (const double lasts = static_cast<double>(record.values.size() - 1) * h / period;
      cycles == 0 && !(lasts >= kMinCycles))
    refuse(fmt::format("lasts {:.3g} cycles of the drive; at least {:g} are needed, or drive.repeat = true.",
                       lasts, kMinCycles));
  if (!(period / h >= kMinPerCycle))
    refuse(fmt::format("has {:.3g} samples in a cycle of the drive; at least {:g} are needed.", period / h,
                       kMinPerCycle));
  if (cycles > 0) require_closed(record);

  std::vector<double> y = record.values;
  const double offset = mean_of(y);
  for (double& value : y) value -= offset;
  std::vector<double> slopes = cycles > 0 ? periodic_slopes(y) : spline_slopes(y);
  if (cycles > 0) y.push_back(y.front()), slopes.push_back(slopes.front());
  std::vector<MotionSample> samples = integrated(y, slopes, record.derivative, h);
  const Component sine =
      cycles > 0 ? close(samples, h, omega) : remove_trend(samples, record.derivative, h, omega);
  for (const MotionSample& s : samples)
    if (!(std::abs(s.z) <= kLargestStroke) || !std::isfinite(s.v) || !std::isfinite(s.a))
      refuse(
          fmt::format("moves the plate by {:.3g} sigma, the bound is {:g}.", std::abs(s.z), kLargestStroke));

  // A cycle begins where the sine passes 0 upwards. A record that begins there, but for rounding, loses no
  // cycle.
  constexpr double kRounding = 0.01;  // of an interval
  double turns = -std::atan2(sine.c, sine.s) / (2 * std::numbers::pi);
  turns -= std::floor(turns);
  if ((1 - turns) * period < kRounding * h) turns -= 1;
  RecordInfo info{.interval = h,
                  .start = turns * period,
                  .cycles = cycles,
                  .file = std::filesystem::path(record.file).filename().string(),
                  .sha256 = record.sha256};
  return {RecordedMotion(std::move(samples), std::move(info)), std::hypot(sine.c, sine.s)};
}

}  // namespace twincell
