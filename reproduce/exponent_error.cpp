#include "reproduce/exponent_error.hpp"

#include <cassert>
#include <cmath>
#include <numeric>

namespace twincell::reproduce {

Estimate exponent_with_error(const calibration::CurveFit& fit, const std::vector<double>& x,
                             const std::vector<Estimate>& y) {
  assert(x.size() == y.size());
  Estimate alpha{.value = fit.fit.value("alpha"), .low = {}, .high = {}};
  if (!fit.intervals[1]) return alpha;
  alpha.low = fit.intervals[1]->low, alpha.high = fit.intervals[1]->high;

  std::vector<double> l;
  for (const double at : x) l.push_back(std::log(at));
  const double mean = std::accumulate(l.begin(), l.end(), 0.0) / static_cast<double>(l.size());
  double spread = 0, variance = 0;  // sum of (l - mean)^2; that of alpha times spread^2
  for (std::size_t k = 0; k < l.size(); ++k) {
    spread += (l[k] - mean) * (l[k] - mean);
    if (!y[k].low || !y[k].high || !(*y[k].low > 0)) continue;
    const double sigma = std::log(*y[k].high / *y[k].low) / 4;
    variance += std::pow((l[k] - mean) * sigma, 2);
  }
  const double half = 2 * std::sqrt(variance) / spread;
  alpha.low = std::min(*alpha.low, alpha.value - half);
  alpha.high = std::max(*alpha.high, alpha.value + half);
  return alpha;
}

}  // namespace twincell::reproduce
