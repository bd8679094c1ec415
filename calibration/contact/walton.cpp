#include "calibration/contact/walton.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/fit/curve_fit.hpp"
#include "calibration/fit/outliers.hpp"
#include "calibration/fit/scattered_mean.hpp"
#include "core/constants.hpp"
#include "core/error.hpp"
#include "core/median.hpp"

namespace twincell::calibration {
namespace {

struct Branches {
  double psi_1, psi_2, reach, error;  // reach: (1 + e)(1 + 1/K)
  template <class T>
  bool operator()(const T* p, T* residual) const {
    const T stick = -p[1] * psi_1, slide = psi_1 - p[0] * reach;
    residual[0] = ((stick > slide ? stick : slide) - psi_2) / error;
    return true;
  }
};

struct Point {
  double psi_1, psi_2, error;
};

FitReport solve_branches(const std::vector<Point>& points, double reach, double mu, double beta,
                         bool weighted) {
  double p[2] = {mu, beta};
  ceres::Problem problem;
  for (const Point& q : points)
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Branches, 1, 2>(new Branches{q.psi_1, q.psi_2, reach, q.error}),
        nullptr, p);
  return solve(problem, p, {"mu", "beta_0"}, weighted ? Residuals::weighted : Residuals::unweighted);
}

/// Sum of Cauchy's losses: outliers do not determine the start values.
double loss_of(const std::vector<Point>& points, double reach, double mu, double beta, double scale) {
  double sum = 0;
  for (const Point& q : points) {
    const double p[2] = {mu, beta};
    double r = 0;
    Branches{q.psi_1, q.psi_2, reach, scale}(p, &r);
    sum += std::log1p(r * r);
  }
  return sum;
}

/// Whether the impacts that slide have no common Psi_1 - Psi_2, as Walton's branch has, in words; empty: they
/// have one. The steeper half of them is far from the transition to sticking. Outliers of the fit count: they
/// may be the impacts of another law.
std::string not_one_branch(const std::vector<Point>& points, double mu, double beta, double reach) {
  constexpr std::size_t kMinImpacts = 10;
  constexpr double kMaxSlope = 0.04, kClearly = 5;  // of Psi_1 - Psi_2 with Psi_1; standard errors
  std::vector<Point> slides;
  for (const Point& q : points)
    if (-beta * q.psi_1 < q.psi_1 - mu * reach) slides.push_back(q);
  std::sort(slides.begin(), slides.end(), [](const Point& a, const Point& b) { return a.psi_1 < b.psi_1; });
  slides.erase(slides.begin(), slides.begin() + static_cast<std::ptrdiff_t>(slides.size() / 2));
  if (slides.size() < kMinImpacts) return {};
  const auto n = static_cast<double>(slides.size());
  double mean_psi = 0, mean_lost = 0, squares = 0, products = 0;
  for (const Point& q : slides) mean_psi += q.psi_1 / n, mean_lost += (q.psi_1 - q.psi_2) / n;
  for (const Point& q : slides) {
    squares += (q.psi_1 - mean_psi) * (q.psi_1 - mean_psi);
    products += (q.psi_1 - mean_psi) * (q.psi_1 - q.psi_2 - mean_lost);
  }
  if (!(squares > 0)) return {};
  const double slope = products / squares;
  std::vector<double> rest;
  for (const Point& q : slides) rest.push_back(q.psi_1 - q.psi_2 - mean_lost - slope * (q.psi_1 - mean_psi));
  const double error = robust_spread(std::move(rest)) / std::sqrt(squares);
  if (slope < kMaxSlope || slope < kClearly * error) return {};
  return fmt::format(
      "mu is undetermined: of impacts that slide Psi_1 - Psi_2 is one number in Walton's representation, but "
      "here it grows by {:.2g} +- {:.1g} of Psi_1: most do not slide throughout",
      slope, error);
}

void fit_tangential(const std::vector<Impact>& impacts, double shape, WaltonFit& out) {
  std::vector<Point> points;
  bool weighted = true;
  for (const Impact& i : impacts)
    if (std::isfinite(i.psi_1) && std::isfinite(i.psi_2)) {
      points.push_back({i.psi_1, i.psi_2, i.psi_error});
      weighted = weighted && i.psi_error > 0;
    }
  if (points.size() < 4) {
    out.notes.emplace_back("mu and beta_0 are undetermined: fewer than 4 impacts with known spins");
    return;
  }
  if (!weighted)
    for (Point& p : points) p.error = 1;
  const double reach = (1 + out.restitution) * (1 + 1 / shape);
  double best = std::numeric_limits<double>::infinity(), mu = 0.1, beta = 0;
  for (double m = 0; m <= 1.5; m += 0.025)
    for (double b = -1; b <= 1; b += 0.05)
      if (const double loss = loss_of(points, reach, m, b, weighted ? 1 : 0.05); loss < best)
        best = loss, mu = m, beta = b;
  std::vector<Point> kept = points;
  for (int round = 0; round < 3; ++round) {
    out.tangential = solve_branches(kept, reach, mu, beta, weighted);
    mu = out.tangential.values[0];
    beta = out.tangential.values[1];
    std::vector<double> r;
    for (const Point& q : points) {
      double value = 0;
      Branches{q.psi_1, q.psi_2, reach, q.error}(out.tangential.values.data(), &value);
      r.push_back(value);
    }
    const double width = kWorstSigma * std::max(robust_spread(r), 1e-12);
    kept.clear();
    for (std::size_t i = 0; i < points.size(); ++i)
      if (std::abs(r[i]) <= width) kept.push_back(points[i]);
    if (kept.size() < 4) break;
  }
  out.has_tangential = true;
  // mu is a fitted coefficient divided by (1 + e_n), so the error of e_n adds to its error.
  if (!out.tangential.standard_errors.empty()) {
    const double share = mu / (1 + out.restitution) * out.restitution_error;
    out.tangential.covariance(0, 0) += share * share;
    out.tangential.standard_errors[0] = std::sqrt(out.tangential.covariance(0, 0));
  }
  for (const Point& q : kept) (-beta * q.psi_1 >= q.psi_1 - mu * reach ? out.sticking : out.sliding) += 1;
  if (std::string why = not_one_branch(points, mu, beta, reach); !why.empty()) {
    out.tangential.undetermined.emplace_back("mu");
    out.notes.push_back(std::move(why));
  }
  // Scatter alone can place two or three impacts on a branch.
  constexpr std::size_t kMinImpacts = 4;
  const auto leave_open = [&](const char* name, const char* branch, std::size_t n) {
    if (n >= kMinImpacts) return;
    auto& open = out.tangential.undetermined;
    if (std::find(open.begin(), open.end(), name) == open.end()) open.emplace_back(name);
    out.notes.push_back(fmt::format("{} is undetermined: {} of {} impacts {}", name, n, kept.size(), branch));
  };
  leave_open("mu", "slide", out.sliding);
  leave_open("beta_0", "stick", out.sticking);
}

}  // namespace

WaltonFit fit_walton(const std::vector<Impact>& impacts, double shape) {
  require_range({.file = {}, .key = "K"}, shape, 0, {}, true);
  WaltonFit out;
  std::vector<Impact> finite;
  for (const Impact& i : impacts)
    if (std::isfinite(i.restitution) && i.speed > 0) finite.push_back(i);
  if (finite.size() < 3)
    throw InputError(
        {.file = {}, .key = "impacts"},
        fmt::format("{} impacts cannot determine a restitution and its error; 3 are needed.", finite.size()));
  // Outliers: more than four robust standard deviations from the median, plus the impact's own excess error.
  std::vector<double> e;
  for (const Impact& i : finite) e.push_back(i.restitution);
  const double middle = upper_median(e),
               width = std::max(robust_spread(e, middle), 1e-12 * std::abs(middle) + 1e-15);
  const bool known =
      std::all_of(finite.begin(), finite.end(), [](const Impact& i) { return i.restitution_error > 0; });
  std::vector<Impact> kept;
  double typical = 0;
  if (known) {
    std::vector<double> errors;
    for (const Impact& i : finite) errors.push_back(i.restitution_error);
    typical = upper_median(errors);
  }
  for (const Impact& i : finite) {
    const double own = known ? std::hypot(width, std::max(0.0, i.restitution_error - typical)) : width;
    if (std::abs(i.restitution - middle) <= kWorstSigma * own)
      kept.push_back(i);
    else
      ++out.outliers;
  }
  out.impacts = kept.size();
  const auto n = static_cast<double>(kept.size());
  // Mean of e_n with scatter (scattered_mean.hpp). Impacts without errors have no weight but that of their
  // scatter, which may be of any size: s^2 is searched over decades, from nearly 0.
  std::vector<double> restitutions, variances;
  for (const Impact& i : kept) {
    restitutions.push_back(i.restitution);
    variances.push_back(known ? i.restitution_error * i.restitution_error : 0);
  }
  constexpr double kNoScatter = 1e-30;
  constexpr int kHalvings = 200;
  const auto scattered = [&](double s2) { return weighted_mean(restitutions, variances, s2); };
  const double s2 = known && scattered(kNoScatter).chi2 <= n - 1
                        ? kNoScatter
                        : find_scatter([&](double s) { return scattered(s).chi2; }, n - 1,
                                       {kNoScatter, 16 * width * width + 1e-20, kHalvings, true})
                              .last;
  const WeightedMean mean = scattered(s2);
  out.restitution = mean.mean;
  out.restitution_error = mean.error;
  out.scatter = std::sqrt(s2);

  // Dependence of e_n on speed.
  std::vector<DataPoint> points;
  for (const Impact& i : kept)
    points.push_back(
        {std::log(i.speed), i.restitution, known ? std::hypot(i.restitution_error, out.scatter) : 0, 0});
  out.slope = out.slope_error = kNaN;
  try {
    const CurveFit line = fit_curve(law_named("line"), points);
    if (!line.fit.standard_errors.empty()) {
      out.slope = line.fit.values[1];
      out.slope_error = line.fit.standard_errors[1];
      if (std::abs(out.slope) > 3 * out.slope_error)
        out.notes.push_back(fmt::format(
            "e_n changes with speed: {:.3g} +- {:.1g} per e-fold; one number for all speeds is an average",
            out.slope, out.slope_error));
    }
  } catch (const InputError&) {
    // All speeds are equal, so the slope is undefined.
  }
  fit_tangential(kept, shape, out);
  return out;
}

}  // namespace twincell::calibration
