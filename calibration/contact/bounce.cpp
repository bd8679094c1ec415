#include "calibration/contact/bounce.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "calibration/fit/outliers.hpp"
#include "calibration/fit/scattered_mean.hpp"
#include "core/error.hpp"
#include "core/median.hpp"
#include "core/plural.hpp"

namespace twincell::calibration {
namespace {

constexpr std::size_t kMinSamples = 6;  // of a flight

struct Flight {
  double begin = 0, end = 0;
  [[nodiscard]] double middle() const { return 0.5 * (begin + end); }
};

/// (1 - exp(-x))/x and (x - 1 + exp(-x))/x^2 by their series, which are also valid at 0; accurate to 1e-9 for
/// |x| < 1.
template <class T>
void drag_factors(const T& x, T& one, T& two) {
  one = two = T(0.0);
  T term = T(1.0);
  for (int k = 0; k < 12; ++k) {
    one += term / (k + 1.0);
    two += term / ((k + 1.0) * (k + 2.0));
    term *= -x / (k + 1.0);
  }
}

template <class T>
T height_of(const T& z, const T& v, const T& g, const T& d, double t) {
  T one, two;
  drag_factors(T(d * t), one, two);
  return z + v * t * one - g * (t * t) * two;
}

double velocity_of(double v, double g, double d, double t) {
  double one = 0, two = 0;
  drag_factors(d * t, one, two);
  return v * (1 - d * t * one) - g * t * one;
}

/// Indices of gravity, drag and the flights' heights and velocities in the parameter vector; -1: not fitted.
struct Layout {
  int gravity = -1, drag = -1, first = 0;
  double held_gravity = 0;
  [[nodiscard]] int z(std::size_t flight) const { return first + 2 * static_cast<int>(flight); }
  [[nodiscard]] int v(std::size_t flight) const { return z(flight) + 1; }
};

struct InFlight {
  double t, height, scale;
  std::size_t flight;
  Layout layout;
  template <class T>
  bool operator()(T const* const* parameters, T* residual) const {
    const T* p = parameters[0];
    const T g = layout.gravity < 0 ? T(layout.held_gravity) : p[layout.gravity];
    const T d = layout.drag < 0 ? T(0.0) : p[layout.drag];
    residual[0] = (height_of(p[layout.z(flight)], p[layout.v(flight)], g, d, t) - height) / scale;
    return true;
  }
};

/// Fit of z = c0 + c1 t - c2 t^2/2, t from `middle`, by least absolute residuals (iteratively reweighted),
/// and the median absolute residual.
struct Parabola {
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  double median_residual = 0;
};
Parabola least_absolute(const std::vector<const BounceSample*>& in, double middle) {
  Parabola out;
  std::vector<double> r(in.size(), 1);
  for (int k = 0; k < 20; ++k) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < in.size(); ++i) {
      const double t = in[i]->time - middle, w = 1 / std::max(1e-9, r[i]);
      const Eigen::Vector3d b(1, t, -0.5 * t * t);
      normal += w * b * b.transpose();
      right += w * in[i]->height * b;
    }
    out.c = normal.ldlt().solve(right);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const double t = in[i]->time - middle;
      r[i] = std::abs(out.c[0] + out.c[1] * t - 0.5 * out.c[2] * t * t - in[i]->height);
    }
  }
  out.median_residual = upper_median(r);
  return out;
}

std::vector<const BounceSample*> between(const std::vector<BounceSample>& s, double begin, double end) {
  std::vector<const BounceSample*> in;
  for (const BounceSample& q : s)
    if (q.time > begin && q.time < end) in.push_back(&q);
  return in;
}

/// Largest less smallest height.
double span_of(const std::vector<BounceSample>& s) {
  const auto [low, high] = std::minmax_element(
      s.begin(), s.end(), [](const auto& a, const auto& b) { return a.height < b.height; });
  return high->height - low->height;
}

/// Noise of the film from the residuals of all intervals, of which the lower third is free of impacts.
/// Simulated heights scatter by rounding only, which differs between the two halves of a flight: hence the
/// lower limit.
double noise_of(std::vector<double> residuals, const std::vector<BounceSample>& s) {
  constexpr double kMinNoise = 1e-5;  // fraction of the span of the heights
  std::sort(residuals.begin(), residuals.end());
  return std::max(residuals[residuals.size() / 3], kMinNoise * span_of(s));
}

/// Robust standard deviation of residuals, at least 1e-12.
double scale_of(std::vector<double> r) {
  return std::max(robust_spread(std::move(r)), 1e-12);
}

/// Scatter of neighbouring heights about a smooth curve, from third differences: impacts are too few to show.
double scatter_of(const std::vector<BounceSample>& s) {
  // Error of a third difference of heights with independent errors of 1: sqrt(1 + 9 + 9 + 1).
  constexpr double kThirdDifferenceError = 4.4721359549995796;
  std::vector<double> third;
  for (std::size_t i = 0; i + 3 < s.size(); ++i)
    third.push_back(s[i + 3].height - 3 * s[i + 2].height + 3 * s[i + 1].height - s[i].height);
  return scale_of(std::move(third)) / kThirdDifferenceError;
}

/// Times at which the height above the plate, after a median filter against single outliers, turns from
/// falling to rising.
std::vector<double> turning_points(const std::vector<BounceSample>& s, const PlateMotionAt& plate) {
  constexpr std::size_t kFilterReach = 3;  // samples on either side
  const std::size_t n = s.size();
  std::vector<double> h(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<double> near;
    for (std::size_t k = i >= kFilterReach ? i - kFilterReach : 0; k <= std::min(n - 1, i + kFilterReach);
         ++k)
      near.push_back(s[k].height - (plate ? plate(s[k].time).height : 0));
    h[i] = upper_median(near);
  }
  std::vector<double> sorted = h;
  std::sort(sorted.begin(), sorted.end());
  const double least_rise = 0.01 * (sorted[n - 1 - n / 50] - sorted[n / 50]);
  std::vector<double> times;
  std::size_t low = 0;
  double high = h[0];
  bool falling = false;
  for (std::size_t i = 1; i < n; ++i) {
    if (!falling) {
      high = std::max(high, h[i]);
      if (h[i] < high - least_rise) falling = true, low = i;
    } else {
      if (h[i] < h[low]) low = i;
      if (h[i] > h[low] + least_rise) {
        times.push_back(s[low].time);
        falling = false;
        high = h[i];
      }
    }
  }
  return times;
}

/// Turning points that are impacts: one parabola does not describe both sides.
std::vector<double> rough_impacts(const std::vector<BounceSample>& s, const PlateMotionAt& plate, double dt) {
  std::vector<double> edges = {s.front().time - dt};
  const std::vector<double> turns = turning_points(s, plate);
  edges.insert(edges.end(), turns.begin(), turns.end());
  edges.push_back(s.back().time + dt);
  const auto residual = [&](double begin, double end) {
    const auto in = between(s, begin, end);
    return in.size() < 4 ? 0.0 : least_absolute(in, 0.5 * (begin + end)).median_residual;
  };
  std::vector<double> own;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i)
    if (between(s, edges[i], edges[i + 1]).size() >= kMinSamples)
      own.push_back(residual(edges[i], edges[i + 1]));
  if (own.empty()) return {};
  const double noise = noise_of(std::move(own), s);
  for (std::size_t i = 1; i + 1 < edges.size();) {
    if (residual(edges[i - 1], edges[i + 1]) <= 1.6 * noise) {
      edges.erase(edges.begin() + static_cast<std::ptrdiff_t>(i));
      if (i > 1) --i;
    } else {
      ++i;
    }
  }
  return {edges.begin() + 1, edges.end() - 1};
}

/// The flights and the parameters that are fitted to them.
struct State {
  Layout layout;
  std::vector<Flight> flights;
  std::vector<double> p;
  std::vector<std::string> names;

  double& z(std::size_t flight) { return p[static_cast<std::size_t>(layout.z(flight))]; }
  double& v(std::size_t flight) { return p[static_cast<std::size_t>(layout.v(flight))]; }
  [[nodiscard]] double z(std::size_t flight) const { return p[static_cast<std::size_t>(layout.z(flight))]; }
  [[nodiscard]] double v(std::size_t flight) const { return p[static_cast<std::size_t>(layout.v(flight))]; }
  [[nodiscard]] double gravity() const {
    return layout.gravity < 0 ? layout.held_gravity : p[static_cast<std::size_t>(layout.gravity)];
  }
  [[nodiscard]] double drag() const { return layout.drag < 0 ? 0 : p[static_cast<std::size_t>(layout.drag)]; }
};

/// Time near `guess` at which flights i and i + 1 cross.
double crossing(const State& s, std::size_t i, double guess) {
  const double g = s.gravity(), d = s.drag();
  const auto at = [&](std::size_t f, double t) {
    const double since = t - s.flights[f].middle();
    return std::pair{height_of(s.z(f), s.v(f), g, d, since), velocity_of(s.v(f), g, d, since)};
  };
  double t = guess;
  for (int k = 0; k < 20; ++k) {
    const auto [za, va] = at(i, t);
    const auto [zb, vb] = at(i + 1, t);
    if (!(vb > va)) break;
    const double step = (zb - za) / (vb - va);
    t -= step;
    if (std::abs(step) < 1e-12) break;
  }
  return t;
}

/// The impact at the crossing of flights i and i + 1; without its error.
BounceImpact impact_at(const State& s, std::size_t i, const PlateMotionAt& plate) {
  const double t = crossing(s, i, s.flights[i].end);
  const double g = s.gravity(), d = s.drag();
  const double before = velocity_of(s.v(i), g, d, t - s.flights[i].middle());
  const double after = velocity_of(s.v(i + 1), g, d, t - s.flights[i + 1].middle());
  const double of_plate = plate ? plate(t).velocity : 0;
  BounceImpact impact;
  impact.time = t;
  impact.speed = of_plate - before;
  impact.restitution = (after - of_plate) / (of_plate - before);
  return impact;
}

/// Samples in the order of time, without those that are not numbers.
std::vector<BounceSample> sorted_samples(std::vector<BounceSample> samples) {
  std::erase_if(samples,
                [](const BounceSample& s) { return !std::isfinite(s.time) || !std::isfinite(s.height); });
  std::sort(samples.begin(), samples.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  return samples;
}

/// The fit of a series of bounces. The steps are in the order of their use.
class SeriesFit {
 public:
  /// \throws InputError if the samples show fewer than two flights
  SeriesFit(std::vector<BounceSample> samples, const BounceOptions& options)
      : options_(options), samples_(sorted_samples(std::move(samples))) {
    if (samples_.size() < 2 * kMinSamples) throw too_few(0);
    dt_ = (samples_.back().time - samples_.front().time) / static_cast<double>(samples_.size() - 1);
    split_into_flights();
    keep_free_flights();
    choose_parameters();
  }

  /// Rounds: the first uses Cauchy's loss from parabolas; later ones move the ends of the flights to their
  /// crossings and reject outliers.
  void fit() {
    constexpr int kRounds = 3;
    start_from_parabolas();
    fit_robustly();
    for (int round = 0; round < kRounds; ++round) {
      for (std::size_t f = 0; f + 1 < s_.flights.size(); ++f) move_end_to_crossing(f);
      fit_without_outliers();
    }
  }
  /// \throws InputError if the flights do not determine the parameters
  [[nodiscard]] BounceFit result() const;

 private:
  struct Placed {
    const BounceSample* sample;
    std::size_t flight;
  };

  [[nodiscard]] InputError too_few(std::size_t flights) const;
  void split_into_flights();
  void keep_free_flights();
  void choose_parameters();
  void start_from_parabolas();
  void move_end_to_crossing(std::size_t flight);
  void set_ends(std::size_t flight, double begin, double end);
  [[nodiscard]] std::vector<Placed> placed() const;
  [[nodiscard]] std::vector<double> residuals(const std::vector<Placed>& in) const;
  void add_residual(ceres::Problem& problem, const Placed& q, ceres::LossFunction* loss);
  void fit_robustly();
  void fit_without_outliers();
  void add_impacts(BounceFit& out) const;
  static void require_physical(const BounceFit& fit);
  void add_mean(BounceFit& out, const Eigen::MatrixXd& covariance) const;
  [[nodiscard]] Eigen::MatrixXd slopes_of_restitution() const;
  [[nodiscard]] bool is_in(const BounceSample& q, double begin, double end) const {
    return q.time > begin + 0.5 * dt_ && q.time < end - 0.5 * dt_;
  }

  const BounceOptions& options_;
  std::vector<BounceSample> samples_;
  double dt_ = 0;  // mean interval of the samples
  State s_;
  FitReport report_;
  std::size_t used_ = 0, outliers_ = 0;  // samples in the last round
};

InputError SeriesFit::too_few(std::size_t flights) const {
  return {{.file = {}, .key = "bounces"},
          fmt::format("{} show {} of at least {} samples; two consecutive flights are needed.",
                      plural(samples_.size(), "sample"), plural(flights, "free flight"), kMinSamples)};
}

// Splits the series at the impacts. The first flight that is too short, as when the bouncing dies out, ends
// the series; short flights at the beginning are skipped.
void SeriesFit::split_into_flights() {
  const std::vector<double> impacts = rough_impacts(samples_, options_.plate, dt_);
  std::vector<double> edges = {samples_.front().time - dt_};
  edges.insert(edges.end(), impacts.begin(), impacts.end());
  edges.push_back(samples_.back().time + dt_);
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const auto count =
        static_cast<std::size_t>(std::count_if(samples_.begin(), samples_.end(), [&](const BounceSample& q) {
          return is_in(q, edges[i], edges[i + 1]);
        }));
    if (count >= kMinSamples)
      s_.flights.push_back({edges[i], edges[i + 1]});
    else if (!s_.flights.empty())
      break;
  }
  if (s_.flights.size() < 2) throw too_few(s_.flights.size());
}

// A bead that is held, or has come to rest, does not fly: its heights do not curve as those of the flights
// do. Such parts at the beginning are skipped, the first one after a flight ends the series.
void SeriesFit::keep_free_flights() {
  constexpr double kMaxGravityDifference = 0.3;  // of a free flight, fraction of gravity
  constexpr double kMaxHeightDifference = 5;     // the same as a difference of heights, in units of the noise
  std::vector<double> curvatures, residuals;
  for (const Flight& f : s_.flights) {
    const Parabola parabola = least_absolute(between(samples_, f.begin, f.end), f.middle());
    curvatures.push_back(parabola.c[2]);
    residuals.push_back(parabola.median_residual);
  }
  const double seen = upper_median(curvatures), gravity = options_.gravity.value_or(seen);
  if (!(seen > 0))
    throw InputError({.file = {}, .key = "bounces"},
                     "no free flights are seen, because most of the flights do not curve downwards; heights "
                     "must count upwards.");
  const double noise = noise_of(std::move(residuals), samples_);
  const auto is_free = [&](std::size_t f) {
    const double off = std::abs(curvatures[f] - gravity), lasts = s_.flights[f].end - s_.flights[f].begin;
    return off < kMaxGravityDifference * gravity || off * lasts * lasts / 16 < kMaxHeightDifference * noise;
  };
  std::vector<Flight> kept;
  for (std::size_t f = 0; f < s_.flights.size(); ++f) {
    if (is_free(f))
      kept.push_back(s_.flights[f]);
    else if (!kept.empty())
      break;
  }
  if (kept.empty() && options_.gravity)
    throw InputError(
        {.file = {}, .key = "--gravity"},
        fmt::format("is {:g}, but the flights curve as under a gravity of {:.3g}; state it in the "
                    "units of the heights and times.",
                    gravity, seen));
  s_.flights = std::move(kept);
  if (s_.flights.size() < 2) throw too_few(s_.flights.size());
}

// Gravity and drag unless fixed, then height and velocity of each flight.
void SeriesFit::choose_parameters() {
  const auto add = [&](const char* name) {
    s_.names.emplace_back(name);
    return static_cast<int>(s_.names.size()) - 1;
  };
  s_.layout.held_gravity = options_.gravity.value_or(0);
  if (!options_.gravity) s_.layout.gravity = add("gravity");
  if (options_.drag) s_.layout.drag = add("drag");
  s_.layout.first = static_cast<int>(s_.names.size());
  for (std::size_t f = 0; f < s_.flights.size(); ++f) {
    s_.names.push_back(fmt::format("z_{}", f + 1));
    s_.names.push_back(fmt::format("v_{}", f + 1));
  }
}

// Start values: a parabola through each flight, gravity from the curvature of the longest one.
void SeriesFit::start_from_parabolas() {
  s_.p.assign(s_.names.size(), 0);
  double longest = 0;
  for (std::size_t f = 0; f < s_.flights.size(); ++f) {
    const Flight& flight = s_.flights[f];
    const Eigen::Vector3d c = least_absolute(between(samples_, flight.begin, flight.end), flight.middle()).c;
    s_.z(f) = c[0];
    s_.v(f) = c[1];
    if (flight.end - flight.begin > longest && s_.layout.gravity >= 0) {
      longest = flight.end - flight.begin;
      s_.p[static_cast<std::size_t>(s_.layout.gravity)] = c[2];
    }
  }
}

// Moves the end of a flight, and the begin of the next, to their crossing.
void SeriesFit::move_end_to_crossing(std::size_t f) {
  const double before_middle = s_.flights[f].middle(), after_middle = s_.flights[f + 1].middle();
  const double t = crossing(s_, f, s_.flights[f].end);
  if (!(t > before_middle && t < after_middle)) return;
  set_ends(f, s_.flights[f].begin, t);
  set_ends(f + 1, t, s_.flights[f + 1].end);
}

// Height and velocity refer to the middle of the flight: propagates them to the new middle.
void SeriesFit::set_ends(std::size_t f, double begin, double end) {
  const double shift = 0.5 * (begin + end) - s_.flights[f].middle();
  const double g = s_.gravity();
  s_.z(f) += s_.v(f) * shift - 0.5 * g * shift * shift;
  s_.v(f) -= g * shift;
  s_.flights[f] = {begin, end};
}

// The samples in flights; those within half an interval of an impact are left out.
std::vector<SeriesFit::Placed> SeriesFit::placed() const {
  std::vector<Placed> in;
  for (const BounceSample& q : samples_)
    for (std::size_t f = 0; f < s_.flights.size(); ++f)
      if (is_in(q, s_.flights[f].begin, s_.flights[f].end)) in.push_back({&q, f});
  return in;
}

std::vector<double> SeriesFit::residuals(const std::vector<Placed>& in) const {
  std::vector<double> r;
  const double* values = s_.p.data();
  for (const auto& [q, f] : in) {
    double x = 0;
    InFlight{q->time - s_.flights[f].middle(), q->height, 1, f, s_.layout}(&values, &x);
    r.push_back(x);
  }
  return r;
}

void SeriesFit::add_residual(ceres::Problem& problem, const Placed& q, ceres::LossFunction* loss) {
  auto* cost = new ceres::DynamicAutoDiffCostFunction<InFlight, 8>(
      new InFlight{q.sample->time - s_.flights[q.flight].middle(), q.sample->height, 1, q.flight, s_.layout});
  cost->AddParameterBlock(static_cast<int>(s_.p.size()));
  cost->SetNumResiduals(1);
  problem.AddResidualBlock(cost, loss, s_.p.data());
}

void SeriesFit::fit_robustly() {
  const std::vector<Placed> in = placed();
  const double scale = scale_of(residuals(in));
  ceres::Problem problem;
  for (const Placed& q : in) add_residual(problem, q, new ceres::CauchyLoss(scale));
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
}

void SeriesFit::fit_without_outliers() {
  const std::vector<Placed> in = placed();
  const std::vector<double> r = residuals(in);
  const double scale = scale_of(r);
  ceres::Problem problem;
  used_ = outliers_ = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (std::abs(r[i]) > kWorstSigma * scale) {
      ++outliers_;
      continue;
    }
    ++used_;
    add_residual(problem, in[i], nullptr);
  }
  report_ = solve(problem, s_.p.data(), s_.names);
  s_.p = report_.values;
}

BounceFit SeriesFit::result() const {
  BounceFit out;
  out.samples = used_;
  out.outliers = outliers_;
  out.fit = report_;
  out.flights = s_.flights.size();
  out.rms = report_.rms();
  const auto error_of = [&](int place) {
    return place < 0 || report_.standard_errors.empty()
               ? 0.0
               : report_.standard_errors[static_cast<std::size_t>(place)];
  };
  out.gravity = s_.gravity();
  out.gravity_error = error_of(s_.layout.gravity);
  out.drag = s_.drag();
  out.drag_error = error_of(s_.layout.drag);
  if (report_.covariance.size() == 0)
    throw InputError({.file = {}, .key = "bounces"},
                     fmt::format("the flights do not determine restitution: {}.", report_.why_not));
  add_impacts(out);
  require_physical(out);
  constexpr double kMaxRmsOfScatter = 10;  // rms residual, as a multiple of the scatter
  constexpr double kMaxRmsOfSpan = 0.01;   // rms residual, as a fraction of the span of the heights
  const double scatter = scatter_of(samples_), span = span_of(samples_);
  if (out.rms > kMaxRmsOfScatter * scatter && out.rms > kMaxRmsOfSpan * span)
    throw InputError(
        {.file = {}, .key = "bounces"},
        fmt::format("the heights are not free flights between impacts: they lie {:.2g} from the best "
                    "fit, but scatter by only {:.2g}.",
                    out.rms, scatter));
  return out;
}

// A result that no bouncing bead can have comes from heights of something else, and measures nothing.
void SeriesFit::require_physical(const BounceFit& fit) {
  constexpr double kMaxExcess = 3;   // of e_n above 1 or below 0, standard errors
  constexpr double kMaxError = 0.3;  // of e_n
  const auto fail = [](const std::string& what) { throw InputError({.file = {}, .key = "bounces"}, what); };
  if (!(fit.gravity > 0))
    fail(fmt::format("the heights are not those of a bouncing bead: the best gravity is {:.3g}.",
                     fit.gravity));
  for (const BounceImpact& i : fit.impacts)
    if (!(i.speed > 0))
      fail(
          fmt::format("the heights are not those of a bouncing bead: at the impact at t = {:.4g} it would "
                      "leave the plate before it.",
                      i.time));
  if (!(fit.restitution_error <= kMaxError))
    fail(fmt::format("the flights do not determine restitution: e_n = {:.3g} +- {:.2g}.", fit.restitution,
                     fit.restitution_error));
  if (fit.restitution > 1 + kMaxExcess * fit.restitution_error)
    fail(fmt::format(
        "e_n = {:.6g} +- {:.2g} is above 1, so the bead gains energy at its impacts; if the plate "
        "vibrates, give --drive-amplitude and --drive-omega.",
        fit.restitution, fit.restitution_error));
  if (fit.restitution < -kMaxExcess * fit.restitution_error)
    fail(fmt::format("e_n = {:.3g} +- {:.2g} is negative, so the heights are not those of a bouncing bead.",
                     fit.restitution, fit.restitution_error));
}

// Derivatives of each impact's restitution with respect to all parameters, by central differences.
Eigen::MatrixXd SeriesFit::slopes_of_restitution() const {
  const auto n = static_cast<Eigen::Index>(s_.p.size());
  const std::size_t n_impacts = s_.flights.size() - 1;
  Eigen::MatrixXd slopes(static_cast<Eigen::Index>(n_impacts), n);
  for (std::size_t i = 0; i < n_impacts; ++i)
    for (Eigen::Index k = 0; k < n; ++k) {
      State moved = s_;
      const double step = 0.01 * std::sqrt(report_.covariance(k, k));
      moved.p[static_cast<std::size_t>(k)] += step;
      const double up = impact_at(moved, i, options_.plate).restitution;
      moved.p[static_cast<std::size_t>(k)] -= 2 * step;
      const double down = impact_at(moved, i, options_.plate).restitution;
      slopes(static_cast<Eigen::Index>(i), k) = (up - down) / (2 * step);
    }
  return slopes;
}

void SeriesFit::add_impacts(BounceFit& out) const {
  for (std::size_t i = 0; i + 1 < s_.flights.size(); ++i)
    out.impacts.push_back(impact_at(s_, i, options_.plate));
  const Eigen::MatrixXd slopes = slopes_of_restitution();
  const Eigen::MatrixXd covariance = slopes * report_.covariance * slopes.transpose();
  for (std::size_t i = 0; i < out.impacts.size(); ++i)
    out.impacts[i].error = std::sqrt(covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)));
  add_mean(out, covariance);
}

// If e_n differs from impact to impact by clearly more than its errors, it scatters by itself
// (scattered_mean.hpp). Otherwise the film's noise alone weights the impacts.
void SeriesFit::add_mean(BounceFit& out, const Eigen::MatrixXd& covariance) const {
  const auto n = static_cast<Eigen::Index>(out.impacts.size());
  Eigen::VectorXd e(n);
  for (Eigen::Index i = 0; i < n; ++i) e[i] = out.impacts[static_cast<std::size_t>(i)].restitution;
  const double freedom = static_cast<double>(n) - 1;
  WeightedMean mean = weighted_mean(e, covariance);
  const double chi2 = mean.chi2;
  // Of chi^2 above its mean, in its standard deviations: for few impacts it fluctuates.
  constexpr double kMinExcessOfChi2 = 3;
  const bool scatters = freedom > 0 && chi2 > freedom + kMinExcessOfChi2 * std::sqrt(2 * freedom);
  if (scatters) {
    constexpr int kHalvings = 60;
    const auto scattered = [&](double variance) {
      return weighted_mean(e, covariance + variance * Eigen::MatrixXd::Identity(n, n));
    };
    const double most = (e.array() - e.mean()).square().sum() + covariance.trace();
    mean = scattered(find_scatter([&](double variance) { return scattered(variance).chi2; }, freedom,
                                  {0, most, kHalvings, false})
                         .upper);
  }
  out.restitution = mean.mean;
  out.restitution_error = mean.error;
  constexpr double kMinNegativeDrag = 5;  // standard errors
  if (out.drag_error > 0 && out.drag < -kMinNegativeDrag * out.drag_error)
    out.notes.push_back(
        fmt::format("the drag is negative, {:.3g} +- {:.1g}: air does not push a bead; check times, "
                    "heights and the stated gravity",
                    out.drag, out.drag_error));
  if (scatters)
    out.notes.push_back(
        fmt::format("the impacts differ by more than the film's noise (chi^2 = {:.3g} of {:g}): e_n depends "
                    "on the impact, or the bead spins; the error contains this scatter",
                    chi2, freedom));
}

}  // namespace

BounceFit fit_bounces(std::vector<BounceSample> samples, const BounceOptions& options) {
  SeriesFit fit(std::move(samples), options);
  fit.fit();
  return fit.result();
}

}  // namespace twincell::calibration
