#include "calibration/contact/bounce.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/median.hpp"

namespace twincell {
namespace {

constexpr std::size_t kFewestSamples = 6;  // of a flight
constexpr double kWorstSigma = 4;          // outliers lie beyond it

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

double median_of(std::vector<double> v) {
  return upper_median(std::move(v));
}

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
  out.median_residual = median_of(r);
  return out;
}

std::vector<const BounceSample*> between(const std::vector<BounceSample>& s, double begin, double end) {
  std::vector<const BounceSample*> in;
  for (const BounceSample& q : s)
    if (q.time > begin && q.time < end) in.push_back(&q);
  return in;
}

/// Times at which the height above the plate, after a median filter against single outliers, turns from
/// falling to rising.
std::vector<double> turning_points(const std::vector<BounceSample>& s, const PlateMotionAt& plate) {
  constexpr std::size_t kSide = 3;
  const std::size_t n = s.size();
  std::vector<double> h(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<double> near;
    for (std::size_t k = i >= kSide ? i - kSide : 0; k <= std::min(n - 1, i + kSide); ++k)
      near.push_back(s[k].height - (plate ? plate(s[k].time).height : 0));
    h[i] = median_of(near);
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
  // The lower third of the residuals of all intervals gives the noise of the film.
  std::vector<double> own;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i)
    if (between(s, edges[i], edges[i + 1]).size() >= kFewestSamples)
      own.push_back(residual(edges[i], edges[i + 1]));
  if (own.empty()) return {};
  std::sort(own.begin(), own.end());
  // Simulated heights scatter by rounding only, which differs between the two halves of a flight: set a lower
  // limit.
  constexpr double kFinest = 1e-5;
  const auto [low, high] = std::minmax_element(
      s.begin(), s.end(), [](const auto& a, const auto& b) { return a.height < b.height; });
  const double noise = std::max(own[own.size() / 3], kFinest * (high->height - low->height));
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

struct State {
  Layout layout;
  std::vector<Flight> flights;
  std::vector<double> p;
  std::vector<std::string> names;
};

/// Time near `guess` at which flights i and i + 1 cross.
double crossing(const State& s, std::size_t i, double guess) {
  const double g =
      s.layout.gravity < 0 ? s.layout.held_gravity : s.p[static_cast<std::size_t>(s.layout.gravity)];
  const double d = s.layout.drag < 0 ? 0 : s.p[static_cast<std::size_t>(s.layout.drag)];
  const auto at = [&](std::size_t f, double t) {
    return std::pair{
        height_of(s.p[static_cast<std::size_t>(s.layout.z(f))], s.p[static_cast<std::size_t>(s.layout.v(f))],
                  g, d, t - s.flights[f].middle()),
        velocity_of(s.p[static_cast<std::size_t>(s.layout.v(f))], g, d, t - s.flights[f].middle())};
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

/// Restitution at the crossing of flights i and i + 1, with its time and impact speed if pointers are given.
double restitution_at(const State& s, std::size_t i, double guess, const PlateMotionAt& plate, double* time,
                      double* speed) {
  const double t = crossing(s, i, guess);
  const double g =
      s.layout.gravity < 0 ? s.layout.held_gravity : s.p[static_cast<std::size_t>(s.layout.gravity)];
  const double d = s.layout.drag < 0 ? 0 : s.p[static_cast<std::size_t>(s.layout.drag)];
  const double before =
      velocity_of(s.p[static_cast<std::size_t>(s.layout.v(i))], g, d, t - s.flights[i].middle());
  const double after =
      velocity_of(s.p[static_cast<std::size_t>(s.layout.v(i + 1))], g, d, t - s.flights[i + 1].middle());
  const double of_plate = plate ? plate(t).velocity : 0;
  if (time) *time = t;
  if (speed) *speed = of_plate - before;
  return (after - of_plate) / (of_plate - before);
}

}  // namespace

BounceFit fit_bounces(std::vector<BounceSample> samples, const BounceOptions& options) {
  std::erase_if(samples,
                [](const BounceSample& s) { return !std::isfinite(s.time) || !std::isfinite(s.height); });
  std::sort(samples.begin(), samples.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  const auto too_few = [&](std::size_t flights) -> InputError {
    return {
        {.file = {}, .key = "bounces"},
        fmt::format("{} samples show {} flights of at least {} samples; two consecutive flights are needed.",
                    samples.size(), flights, kFewestSamples)};
  };
  if (samples.size() < 2 * kFewestSamples) throw too_few(0);
  const double dt = (samples.back().time - samples.front().time) / static_cast<double>(samples.size() - 1);

  // Split the series into flights at the impacts.
  State s;
  std::vector<double> impacts = rough_impacts(samples, options.plate, dt);
  std::vector<double> edges = {samples.front().time - dt};
  edges.insert(edges.end(), impacts.begin(), impacts.end());
  edges.push_back(samples.back().time + dt);
  // The first flight that is too short, as when the bouncing dies out, ends the series; short flights at the
  // beginning are skipped.
  const auto count = [&](double a, double b) {
    return static_cast<std::size_t>(std::count_if(samples.begin(), samples.end(), [&](const BounceSample& q) {
      return q.time > a + 0.5 * dt && q.time < b - 0.5 * dt;
    }));
  };
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    if (count(edges[i], edges[i + 1]) >= kFewestSamples)
      s.flights.push_back({edges[i], edges[i + 1]});
    else if (!s.flights.empty())
      break;
  }
  if (s.flights.size() < 2) throw too_few(s.flights.size());

  // Parameters: gravity and drag unless fixed, then height and velocity of each flight.
  BounceFit out;
  s.layout.held_gravity = options.gravity.value_or(0);
  if (!options.gravity) s.layout.gravity = static_cast<int>(s.names.size()), s.names.emplace_back("gravity");
  if (options.drag) s.layout.drag = static_cast<int>(s.names.size()), s.names.emplace_back("drag");
  s.layout.first = static_cast<int>(s.names.size());
  for (std::size_t f = 0; f < s.flights.size(); ++f) {
    s.names.push_back(fmt::format("z_{}", f + 1));
    s.names.push_back(fmt::format("v_{}", f + 1));
  }

  // Rounds: the first uses Cauchy's loss from parabolas; later ones move the ends of the flights to their
  // crossings and reject outliers.
  double scale = 0;
  FitReport report;
  for (int round = 0; round < 4; ++round) {
    // Start values: a parabola through each flight, gravity from the curvature of the longest one.
    if (round == 0) {
      s.p.assign(s.names.size(), 0);
      double longest = 0;
      for (std::size_t f = 0; f < s.flights.size(); ++f) {
        const Eigen::Vector3d c =
            least_absolute(between(samples, s.flights[f].begin, s.flights[f].end), s.flights[f].middle()).c;
        s.p[static_cast<std::size_t>(s.layout.z(f))] = c[0];
        s.p[static_cast<std::size_t>(s.layout.v(f))] = c[1];
        if (s.flights[f].end - s.flights[f].begin > longest && s.layout.gravity >= 0) {
          longest = s.flights[f].end - s.flights[f].begin;
          s.p[static_cast<std::size_t>(s.layout.gravity)] = c[2];
        }
      }
    } else {
      // Move the end of each flight to its crossing with the next one.
      for (std::size_t f = 0; f + 1 < s.flights.size(); ++f) {
        const double before_middle = s.flights[f].middle(), after_middle = s.flights[f + 1].middle();
        const double t = crossing(s, f, s.flights[f].end);
        if (!(t > before_middle && t < after_middle)) continue;
        // Height and velocity refer to the middle of the flight: propagate them to the new middle.
        const auto move = [&](std::size_t k, double begin, double end) {
          const double shift = 0.5 * (begin + end) - s.flights[k].middle();
          const double g =
              s.layout.gravity < 0 ? s.layout.held_gravity : s.p[static_cast<std::size_t>(s.layout.gravity)];
          double& z = s.p[static_cast<std::size_t>(s.layout.z(k))];
          double& v = s.p[static_cast<std::size_t>(s.layout.v(k))];
          z += v * shift - 0.5 * g * shift * shift;
          v -= g * shift;
          s.flights[k] = {begin, end};
        };
        move(f, s.flights[f].begin, t);
        move(f + 1, t, s.flights[f + 1].end);
      }
    }
    std::vector<std::pair<const BounceSample*, std::size_t>> in;
    for (const BounceSample& q : samples)
      for (std::size_t f = 0; f < s.flights.size(); ++f)
        if (q.time > s.flights[f].begin + 0.5 * dt && q.time < s.flights[f].end - 0.5 * dt)
          in.emplace_back(&q, f);
    const auto residuals = [&] {
      std::vector<double> r;
      const double* values = s.p.data();
      for (const auto& [q, f] : in) {
        double x = 0;
        InFlight{q->time - s.flights[f].middle(), q->height, 1, f, s.layout}(&values, &x);
        r.push_back(x);
      }
      return r;
    };
    const auto add = [&](ceres::Problem& problem, const BounceSample& q, std::size_t f,
                         ceres::LossFunction* loss) {
      auto* cost = new ceres::DynamicAutoDiffCostFunction<InFlight, 8>(
          new InFlight{q.time - s.flights[f].middle(), q.height, 1, f, s.layout});
      cost->AddParameterBlock(static_cast<int>(s.p.size()));
      cost->SetNumResiduals(1);
      problem.AddResidualBlock(cost, loss, s.p.data());
    };
    std::vector<double> r = residuals();
    for (double& x : r) x = std::abs(x);
    scale = std::max(1.4826 * median_of(r), 1e-12);
    if (round == 0) {
      ceres::Problem problem;
      for (const auto& [q, f] : in) add(problem, *q, f, new ceres::CauchyLoss(scale));
      ceres::Solver::Options solver;
      solver.linear_solver_type = ceres::DENSE_QR;
      solver.logging_type = ceres::SILENT;
      ceres::Solver::Summary summary;
      ceres::Solve(solver, &problem, &summary);
      continue;
    }
    r = residuals();
    std::vector<double> sizes;
    for (const double x : r) sizes.push_back(std::abs(x));
    scale = std::max(1.4826 * median_of(sizes), 1e-12);
    ceres::Problem problem;
    out.samples = out.outliers = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
      if (std::abs(r[i]) > kWorstSigma * scale) {
        ++out.outliers;
        continue;
      }
      ++out.samples;
      add(problem, *in[i].first, in[i].second, nullptr);
    }
    report = solve(problem, s.p.data(), s.names);
    s.p = report.values;
  }
  out.fit = report;
  out.flights = s.flights.size();
  out.rms = report.rms();
  const auto error_of = [&](int place) {
    return place < 0 || report.standard_errors.empty()
               ? 0.0
               : report.standard_errors[static_cast<std::size_t>(place)];
  };
  out.gravity =
      s.layout.gravity < 0 ? s.layout.held_gravity : s.p[static_cast<std::size_t>(s.layout.gravity)];
  out.gravity_error = error_of(s.layout.gravity);
  out.drag = s.layout.drag < 0 ? 0 : s.p[static_cast<std::size_t>(s.layout.drag)];
  out.drag_error = error_of(s.layout.drag);
  if (report.covariance.size() == 0)
    throw InputError({.file = {}, .key = "bounces"},
                     fmt::format("the flights do not determine restitution: {}.", report.why_not));

  // Restitution of each impact and its derivatives with respect to all parameters, by central differences.
  const auto n = static_cast<Eigen::Index>(s.p.size());
  const std::size_t n_impacts = s.flights.size() - 1;
  Eigen::MatrixXd slopes(static_cast<Eigen::Index>(n_impacts), n);
  Eigen::VectorXd e(static_cast<Eigen::Index>(n_impacts));
  for (std::size_t i = 0; i < n_impacts; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    BounceImpact impact;
    impact.restitution = restitution_at(s, i, s.flights[i].end, options.plate, &impact.time, &impact.speed);
    e[row] = impact.restitution;
    for (Eigen::Index k = 0; k < n; ++k) {
      State moved = s;
      const double step = 0.01 * std::sqrt(report.covariance(k, k));
      moved.p[static_cast<std::size_t>(k)] += step;
      const double up = restitution_at(moved, i, s.flights[i].end, options.plate, nullptr, nullptr);
      moved.p[static_cast<std::size_t>(k)] -= 2 * step;
      const double down = restitution_at(moved, i, s.flights[i].end, options.plate, nullptr, nullptr);
      slopes(row, k) = (up - down) / (2 * step);
    }
    out.impacts.push_back(impact);
  }
  Eigen::MatrixXd c = slopes * report.covariance * slopes.transpose();
  for (std::size_t i = 0; i < n_impacts; ++i)
    out.impacts[i].error = std::sqrt(c(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)));
  // Best linear unbiased mean. If the impacts differ by more than their errors, its error is scaled up.
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(n_impacts));
  const Eigen::VectorXd w = c.ldlt().solve(one);
  out.restitution = w.dot(e) / w.dot(one);
  const Eigen::VectorXd left = e - out.restitution * one;
  const double chi2 = left.dot(c.ldlt().solve(left));
  const double freedom = static_cast<double>(n_impacts) - 1;
  const double excess = freedom > 0 ? chi2 / freedom : 1;
  // Scale only beyond three standard deviations of chi^2, which itself fluctuates for few impacts.
  const bool grown = freedom > 0 && chi2 > freedom + 3 * std::sqrt(2 * freedom);
  out.restitution_error = std::sqrt((grown ? excess : 1) / w.dot(one));
  if (grown)
    out.notes.push_back(
        fmt::format("the impacts differ by more than the film's noise (chi^2 = {:.3g} of {:g}): e_n depends "
                    "on the impact, or the "
                    "bead spins; the error is scaled up accordingly",
                    chi2, freedom));
  return out;
}

}  // namespace twincell
