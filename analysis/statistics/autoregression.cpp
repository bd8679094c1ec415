#include "analysis/statistics/autoregression.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace twincell::analysis {
namespace {

/// Orders beyond 10 changed no coverage, not even of series that echo after 15 steps.
constexpr std::size_t kHighestOrder = 10;
/// Values per coefficient, at least.
constexpr std::size_t kValuesPerOrder = 8;

double sum_of_squares(const std::vector<double>& x) {
  return std::inner_product(x.begin(), x.end(), x.begin(), 0.0);
}

/// Burg's recursion. Receives the polynomial 1 - a_1 z - ... of each order with the variance that it leaves.
/// \param y series without its mean
template <class Receive>
void burg(const std::vector<double>& y, std::size_t highest, Receive receive) {
  std::vector<double> forward(y.begin() + 1, y.end()), backward(y.begin(), y.end() - 1), polynomial = {1};
  double left = sum_of_squares(y) / static_cast<double>(y.size());
  for (std::size_t order = 1; order <= highest; ++order) {
    const double product = std::inner_product(forward.begin(), forward.end(), backward.begin(), 0.0);
    const double squares = sum_of_squares(forward) + sum_of_squares(backward);
    const double reflection = squares > 0 ? -2 * product / squares : 0;
    polynomial.push_back(0);
    std::vector<double> reversed(polynomial.rbegin(), polynomial.rend());
    for (std::size_t k = 0; k < polynomial.size(); ++k) polynomial[k] += reflection * reversed[k];
    left *= std::max(0.0, 1 - reflection * reflection);
    receive(order, polynomial, left);
    const std::size_t n = forward.size();
    for (std::size_t i = 0; i < n; ++i) {
      const double f = forward[i], b = backward[i];
      forward[i] = f + reflection * b;
      backward[i] = b + reflection * f;
    }
    forward.erase(forward.begin());
    backward.pop_back();
  }
}

/// a_1 of a process of first order, corrected for the estimated mean; at least 0.
double first_order(const std::vector<double>& y) {
  const auto n = static_cast<double>(y.size());
  const double rho =
      std::inner_product(y.begin() + 1, y.end(), y.begin(), 0.0) / sum_of_squares(y) * n / (n - 1);
  return std::max(0.0, rho + (1 + 3 * rho) / n);
}

}  // namespace

double Autoregression::gain() const {
  return 1 - std::accumulate(coefficients.begin(), coefficients.end(), 0.0);
}

Autoregression fit_autoregression(const std::vector<double>& series) {
  const std::size_t n = series.size();
  const double mean = std::accumulate(series.begin(), series.end(), 0.0) / static_cast<double>(n);
  std::vector<double> y(n);
  std::transform(series.begin(), series.end(), y.begin(), [&](double x) { return x - mean; });
  const double variance = sum_of_squares(y) / static_cast<double>(n);

  std::vector<double> best = {1, 0};  // a series that no order explains has a first order near 0
  double least = 0, left = variance;
  const std::size_t highest = std::clamp<std::size_t>(n / kValuesPerOrder, 1, kHighestOrder);
  burg(y, highest, [&](std::size_t order, const std::vector<double>& polynomial, double variance_left) {
    const double relative = std::max(variance_left / variance, std::numeric_limits<double>::min());
    const double criterion = static_cast<double>(n) * std::log(relative) +
                             std::log(static_cast<double>(n)) * static_cast<double>(order);
    if (!(criterion < least)) return;
    least = criterion;
    best = polynomial;
    left = variance_left;
  });

  Autoregression fit;
  fit.unexplained = left / variance;
  const bool first = best.size() == 2;
  if (first) best[1] = -first_order(y);
  for (std::size_t k = 1; k < best.size(); ++k) fit.coefficients.push_back(-best[k]);
  for (std::size_t i = best.size() - 1; i < n; ++i) {
    double e = 0;
    for (std::size_t k = 0; k < best.size(); ++k) e += best[k] * y[i - k];
    fit.innovations.push_back(e);
  }
  const double gain = fit.gain();
  if (!(gain > 0))
    fit.correlation_time = std::numeric_limits<double>::infinity();
  else if (first)
    fit.correlation_time = (2 - gain) / (2 * gain);
  else
    fit.correlation_time = std::max(0.5, fit.unexplained / (2 * gain * gain));
  return fit;
}

}  // namespace twincell::analysis
